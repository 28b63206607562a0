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

"""The part of an image that a panel shows: a box around the bodies."""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.frame import Frame

_MARGIN = 0.07
_LEAST_MARGIN = 4.0


class Box(NamedTuple):
    """A rectangle in an image, pixels; whole numbers are the centres of pixels."""

    left: float
    top: float
    right: float
    bottom: float


def box_around(frame: Frame, body: int | None = None, aspect: float = 0.8) -> Box:
    """Return the box around the bodies of `frame` and their true joints.

    Args:
        frame: the image.
        body: the number of the only body to include; None for all.
        aspect: the box's width, divided by its height.

    The box extends beyond the image only where joints do, or where the image is too small for it.
    Without a body it is the whole image.
    """
    labels = frame.labels
    rows, columns = np.nonzero(labels >= 0 if body is None else labels == body)
    if len(rows) == 0:
        height, width = labels.shape
        return Box(-0.5, -0.5, width - 0.5, height - 0.5)
    joints = _true_pixels(frame, body)
    x = np.concatenate([columns, joints[:, 0]])
    y = np.concatenate([rows, joints[:, 1]])
    shown = Box(float(x.min()), float(y.min()), float(x.max()), float(y.max()))
    return _inside(_fit(shown, aspect), shown, labels.shape)


def look_at(axes: Axes, box: Box) -> None:
    """Set the limits of `axes` to `box`, with square pixels."""
    axes.set_xlim(box.left, box.right)
    axes.set_ylim(box.bottom, box.top)
    axes.set_aspect('equal')


def _fit(box: Box, aspect: float) -> Box:
    """Return `box` with a margin and enlarged to `aspect`."""
    width, height = box.right - box.left, box.bottom - box.top
    margin = max(_LEAST_MARGIN, _MARGIN * max(width, height))
    width, height = width + 2 * margin, height + 2 * margin
    width, height = max(width, aspect * height), max(height, width / aspect)
    column, row = (box.left + box.right) / 2, (box.top + box.bottom) / 2
    return Box(column - width / 2, row - height / 2, column + width / 2, row + height / 2)


def _inside(box: Box, shown: Box, size: tuple[int, ...]) -> Box:
    """Return `box` moved into the image of `size` (H, W), as far as it keeps what is `shown`."""
    height, width = size
    left, right = _moved(box.left, box.right, (shown.left, shown.right), width - 0.5)
    top, bottom = _moved(box.top, box.bottom, (shown.top, shown.bottom), height - 0.5)
    return Box(left, top, right, bottom)


def _moved(
    first: float, last: float, shown: tuple[float, float], end: float
) -> tuple[float, float]:
    """Return a range moved into that from -0.5 to `end`, unless it or what is shown exceeds it."""
    if last - first > end + 0.5 or shown[0] < -0.5 or shown[1] > end:
        return first, last
    step = max(-0.5 - first, 0.0) - max(last - end, 0.0)
    return first + step, last + step


def _true_pixels(frame: Frame, body: int | None) -> NDArray[np.float32]:
    """Return the pixels of the true joints that are labelled, shape (n, 2)."""
    if frame.ground_truth is None:
        return np.zeros((0, 2), np.float32)
    wanted = frame.ground_truth.bodies == body if body is not None else slice(None)
    pixels = project(frame.ground_truth.positions[wanted], frame.camera).reshape(-1, 2)
    return pixels[np.isfinite(pixels).all(axis=1)]
