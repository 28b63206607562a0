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

"""Optics that all noise models share: range, focal length, slope and nearest pixel."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import exact_kernel


class DepthRange(NamedTuple):
    """The nearest and the farthest distance that a sensor measures, metres."""

    nearest: float
    farthest: float


def focal_length(width: int, field_of_view: float) -> float:
    """Return the focal length, pixels, for `width` pixels and a field of view in degrees."""
    return 0.5 * width / math.tan(math.radians(0.5 * field_of_view))


@exact_kernel
def nearest_pixel(position: float, count: int) -> int:
    """Return the nearest pixel to a position on an axis of `count` pixels."""
    return min(max(int(np.floor(position + 0.5)), 0), count - 1)


@exact_kernel
def slope(depth: NDArray[np.float32], row: int, column: int, focal: float) -> float:
    """Return the tangent of the angle between a surface's normal and the camera's axis.

    Along each axis, it uses the smaller of the two one-sided differences of depth. So depth edges
    beside the surface and empty neighbours do not count.

    Args:
        depth: metres, 0 in empty pixels, shape (H, W).
        row: of a pixel that is not empty.
        column: of that pixel.
        focal: focal length, pixels.
    """
    down = least_change(depth, row, column, 1, 0)
    right = least_change(depth, row, column, 0, 1)
    return math.sqrt(down * down + right * right) * focal / float(depth[row, column])


@exact_kernel
def least_change(
    depth: NDArray[np.float32], row: int, column: int, down: int, right: int
) -> float:
    """Return the smaller difference of depth to the previous and the next pixel, metres."""
    height, width = depth.shape
    least = math.inf
    for sign in (-1, 1):
        at_row, at_column = row + sign * down, column + sign * right
        if 0 <= at_row < height and 0 <= at_column < width and depth[at_row, at_column] > 0:
            least = min(least, abs(float(depth[at_row, at_column]) - float(depth[row, column])))
    return 0.0 if least == math.inf else least
