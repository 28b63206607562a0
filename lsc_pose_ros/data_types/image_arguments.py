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

"""Checks the arguments of the public interface: depth image, labels and intrinsics.

Only types and shapes are looked at, which takes a few microseconds. A wrong type is a wrong unit
or a wrong background most of the time, so the messages name the function that converts it.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import (
    LARGEST_PIXEL_LENGTH,
    LEAST_FOCAL_LENGTH,
    MOST_COEFFICIENTS,
    Intrinsics,
    Lens,
    is_possible,
)
from lsc_pose_ros.errors import InputError

MOST_PIXELS = 2**21
"""An image with more pixels is thinned out: no depth camera measures so many independently."""

_DEPTH_TYPE = np.dtype(np.float32)
_LABEL_TYPE = np.dtype(np.int32)


class ImageArguments(NamedTuple):
    """A depth image, its labels and its camera, as the kernels need them.

    Attributes:
        depth: metres, 0 if the sensor measured nothing, shape (H, W), contiguous.
        labels: the body number of each pixel, NO_BODY for none, shape (H, W), contiguous.
        camera: the intrinsics.
    """

    depth: NDArray[np.float32]
    labels: NDArray[np.int32]
    camera: Intrinsics


def check_images(
    depth: NDArray[np.floating], labels: NDArray[np.signedinteger], camera: Intrinsics
) -> ImageArguments:
    """Return the arguments as the kernels need them, unchanged if they are so already.

    Args:
        depth: metres, floats of any size, shape (H, W).
        labels: the body number of each pixel, NO_BODY for none, signed integers, shape (H, W).
        camera: the intrinsics.

    Raises:
        InputError: an argument has another type or shape, or the intrinsics are not those of a
            camera.
    """
    _check_array('depth', depth)
    if depth.dtype.kind != 'f':
        msg = (
            f'depth is of type {depth.dtype}, but must hold metres as float32; convert '
            'millimetres with lsc_pose_ros.metres_from_millimetres(depth)'
        )
        raise InputError(msg)
    _check_array('labels', labels)
    if labels.dtype.kind != 'i':
        msg = (
            f'labels is of type {labels.dtype}, but must be int32 with NO_BODY (-1) for pixels '
            'without a body; convert a mask with '
            'lsc_pose_ros.labels_from_mask(mask, background=0)'
        )
        raise InputError(msg)
    if labels.shape != depth.shape:
        msg = f'labels has the shape {labels.shape}, but depth has {depth.shape}'
        raise InputError(msg)
    return ImageArguments(
        depth if _is_plain(depth, _DEPTH_TYPE) else np.array(depth, _DEPTH_TYPE, order='C'),
        labels if _is_plain(labels, _LABEL_TYPE) else np.array(labels, _LABEL_TYPE, order='C'),
        _check_camera(camera),
    )


def thin_out(images: ImageArguments) -> ImageArguments:
    """Return the images with every n-th pixel of every n-th row: with MOST_PIXELS at most.

    Images without more pixels are returned as they are.

    Args:
        images: of any size.
    """
    height, width = images.depth.shape
    step = 1
    while -(-height // step) * -(-width // step) > MOST_PIXELS:
        step += 1
    if step == 1:
        return images
    fx, fy, cx, cy = (each / step for each in images.camera[:4])
    return ImageArguments(
        np.ascontiguousarray(images.depth[::step, ::step]),
        np.ascontiguousarray(images.labels[::step, ::step]),
        Intrinsics(fx, fy, cx, cy, images.camera.lens),
    )


def _is_plain(image: NDArray[np.generic], kind: np.dtype[np.generic]) -> bool:
    """Return whether an image is as the kernels need it; each other layout compiles them again."""
    return type(image) is np.ndarray and image.dtype == kind and image.flags.carray


def _check_array(name: str, image: object) -> None:
    if not isinstance(image, np.ndarray) or isinstance(image, np.ma.MaskedArray):
        msg = f'{name} is of type {type(image).__name__}, but must be a numpy array'
        raise InputError(msg)
    if image.ndim != 2:
        msg = f'{name} has the shape {image.shape}, but must have the shape (H, W)'
        raise InputError(msg)


def _check_camera(camera: Intrinsics) -> Intrinsics:
    if not isinstance(camera, Intrinsics):
        msg = (
            f'camera is of type {type(camera).__name__}, but must be lsc_pose_ros.Intrinsics; '
            'make one with Intrinsics(fx, fy, cx, cy), or with Intrinsics.from_matrix(K) from a '
            '3 x 3 matrix or the field k of a CameraInfo'
        )
        raise InputError(msg)
    try:
        fx, fy, cx, cy = map(float, camera[:4])
    except (TypeError, ValueError):
        fx = fy = cx = cy = math.nan
    if not (0 < fx < math.inf and 0 < fy < math.inf and math.isfinite(cx + cy)):
        msg = f'{camera} has no positive focal lengths or no finite principal point, in pixels'
        raise InputError(msg)
    if not is_possible(fx, fy, cx, cy):
        msg = (
            f'{camera} is no possible camera: focal lengths must be from {LEAST_FOCAL_LENGTH:g} '
            f'to {LARGEST_PIXEL_LENGTH:g} pixels, the principal point within '
            f'{LARGEST_PIXEL_LENGTH:g} pixels'
        )
        raise InputError(msg)
    lens = None if camera.lens is None else _check_lens(camera.lens)
    return Intrinsics(fx, fy, cx, cy, lens)


def _check_lens(lens: Lens) -> Lens:
    """Return `lens` with a tuple of coefficients, by which it can be cached."""
    known = ', '.join(MOST_COEFFICIENTS)
    if not isinstance(lens, Lens) or lens.model not in MOST_COEFFICIENTS:
        msg = f'the lens of the camera must be a Lens of one of the models {known}, not {lens!r}'
        raise InputError(msg)
    coefficients = tuple(map(float, lens.coefficients))
    most = MOST_COEFFICIENTS[lens.model]
    if len(coefficients) > most or not all(map(math.isfinite, coefficients)):
        msg = f'{lens} must have at most {most} coefficients, all of them finite'
        raise InputError(msg)
    return Lens(lens.model, coefficients)
