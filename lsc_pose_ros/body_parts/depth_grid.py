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


"""A depth image reduced to a coarse grid, on which body parts are classified.

Classification at each pixel would be slow and is not needed: a body at 4 m is 30 cells wide and
80 high in an image of 320 x 240 pixels. All images are reduced to about the same number of cells,
so that the time does not depend on the size of the image.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.numerics.jit import kernel

GRID_WIDTH = 160
"""The grid has about this many columns."""

FARTHEST = np.float32(60.0)
"""Depth beyond this is unknown, metres: infinity, and the FLT_MAX of some drivers."""


class DepthGrid(NamedTuple):
    """A coarse depth image.

    Cell (i, j) shows the pixel (i step + step // 2, j step + step // 2), or one near it.

    Attributes:
        depth: metres, 0 if unknown, shape (h, w), float32.
        step: number of pixels per cell and axis.
        focal_lengths: fx and fy in cells.
    """

    depth: NDArray[np.float32]
    step: int
    focal_lengths: tuple[float, float]


def depth_grid(depth: NDArray[np.float32], camera: Intrinsics) -> DepthGrid:
    """Return the coarse grid of a depth image.

    Args:
        depth: metres, 0 or not finite if unknown, shape (H, W).
        camera: the intrinsics.
    """
    step = grid_step(depth.shape[1])
    return DepthGrid(
        reduce_depth(depth, step), step, (float(camera.fx) / step, float(camera.fy) / step)
    )


def grid_step(width: int) -> int:
    """Return the number of pixels per cell for an image of `width` columns."""
    return max(1, round(width / GRID_WIDTH))


@kernel
def reduce_depth(depth: NDArray[np.float32], step: int) -> NDArray[np.float32]:
    """Return the depth of each cell, shape (H // step, W // step), 0 if unknown.

    It is the depth of the cell's middle pixel, or else of the first pixel of the cell that has
    one. No mean is taken: at an edge it would be a depth at which there is nothing.

    Args:
        depth: metres, 0 or not finite if unknown, shape (H, W).
        step: number of pixels per cell and axis.
    """
    height, width = depth.shape[0] // step, depth.shape[1] // step
    reduced = np.zeros((height, width), np.float32)
    middle = step // 2
    for i in range(height):
        for j in range(width):
            value = depth[i * step + middle, j * step + middle]
            if not 0 < value < FARTHEST:
                value = _first_known(depth, i * step, j * step, step)
            reduced[i, j] = value
    return reduced


@kernel
def _first_known(depth: NDArray[np.float32], top: int, left: int, step: int) -> np.float32:
    for row in range(top, top + step):
        for column in range(left, left + step):
            value: np.float32 = depth[row, column]
            if 0 < value < FARTHEST:
                return value
    return np.float32(0)
