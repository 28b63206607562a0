# Copyright 2026 lsc_pose_ros contributors
# SPDX-License-Identifier: Apache-2.0
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Converts depth images and masks of cameras and other programs into depth and labels."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.errors import InputError

METRES_PER_MILLIMETRE = np.float32(0.001)

LARGEST_BODY = int(np.iinfo(np.uint16).max)
"""The largest number of a body; skeletons store the numbers as UINT16."""


def metres_from_millimetres(millimetres: NDArray[np.generic]) -> NDArray[np.float32]:
    """Return a depth image in metres, shape (H, W), 0 for pixels without depth.

    Args:
        millimetres: integers or floats, shape (H, W). 0, NaN, infinity and negative values mean
            that the sensor measured nothing (REP-118).

    Raises:
        InputError: `millimetres` is not an array of integers or floats of that shape.
    """
    _check_image('millimetres', millimetres, 'uif', 'integers or floats')
    metres = millimetres.astype(np.float32) * METRES_PER_MILLIMETRE
    return metres if millimetres.dtype.kind == 'u' else without_invalid(metres)


def without_invalid(metres: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return `metres` after NaN, infinity and negative values were set to 0, in place."""
    metres[~(np.isfinite(metres) & (metres > 0))] = 0
    return metres


class DepthRange(NamedTuple):
    """The depths that a camera can measure, metres; others are no measurement.

    Some drivers send the largest float for pixels without depth.
    """

    minimum: float = 0.1
    maximum: float = 20.0


def keep_in_range(metres: NDArray[np.float32], limits: DepthRange) -> NDArray[np.float32]:
    """Return `metres` after values outside of `limits` were set to 0, in place."""
    metres[~((metres >= limits.minimum) & (metres <= limits.maximum))] = 0
    return metres


def labels_from_mask(mask: NDArray[np.generic], background: int = 0) -> NDArray[np.int32]:
    """Return a mask as labels, shape (H, W): the value of each pixel, NO_BODY for `background`.

    Args:
        mask: integers or booleans, shape (H, W). Each value but `background` is the number of a
            body, from 0 to 65535; True is body 1.
        background: the value of pixels that show no body (255 in the body index map of Azure
            Kinect).

    Raises:
        InputError: `mask` is not such an array.
    """
    _check_image('mask', mask, 'uib', 'integers or booleans')
    empty = mask == background
    _check_numbers(mask, empty)
    labels = mask.astype(np.int32)
    np.copyto(labels, np.int32(NO_BODY), where=empty)
    return labels


def _check_image(name: str, image: NDArray[np.generic], kinds: str, what: str) -> None:
    if not isinstance(image, np.ndarray):
        msg = f'{name} is of type {type(image).__name__}, but must be a numpy array'
        raise InputError(msg)
    if image.ndim != 2 or image.dtype.kind not in kinds:
        msg = (
            f'{name} is of type {image.dtype} and shape {image.shape}, but must hold {what} '
            'and have the shape (H, W)'
        )
        raise InputError(msg)


def _check_numbers(mask: NDArray[Any], empty: NDArray[np.bool_]) -> None:
    if mask.dtype.kind != 'i' and mask.dtype.itemsize <= np.dtype(np.uint16).itemsize:
        return
    wrong = ~empty & ((mask < 0) | (mask > LARGEST_BODY))
    if wrong.any():
        msg = (
            f'the mask holds the body number {int(mask[wrong][0])}; numbers must lie between 0 '
            f'and {LARGEST_BODY} (is the value of the background, mask_background, right?)'
        )
        raise InputError(msg)
