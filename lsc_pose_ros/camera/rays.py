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

"""The rays of all pixels of an image: a table that is computed once for each camera."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.lens import distort
from lsc_pose_ros.camera.projection import directions_of
from lsc_pose_ros.data_types.camera import Intrinsics

# A pixel is reached if the ray that was found for it comes back to it, in pixels.
_LARGEST_ERROR = 0.1

# Tables are kept for so many cameras; one of 640 x 480 pixels has 3.7 MB.
_CAMERAS = 8


class ImageRays(NamedTuple):
    """The directions of the rays of an image's pixels, with a margin of one pixel on each side.

    The element [1 + row, 1 + column] belongs to a pixel. The margin serves windows, whose border
    can be outside of the image.

    Attributes:
        right: X / Z of each ray, shape (H + 2, W + 2).
        down: Y / Z of each ray, shape (H + 2, W + 2).
        area: the area of a pixel at a depth of one metre, facing the camera, square metres, shape
            (H + 2, W + 2). At depth z it is z^2 times as large.
    """

    right: NDArray[np.float32]
    down: NDArray[np.float32]
    area: NDArray[np.float32]


@lru_cache(maxsize=_CAMERAS)
def image_rays(camera: Intrinsics, height: int, width: int) -> ImageRays:
    """Return the rays of an image.

    Args:
        camera: the intrinsics.
        height: number of rows.
        width: number of columns.
    """
    rays = ImageRays(*(np.empty((height + 2, width + 2), np.float32) for _ in range(3)))
    columns, rows = np.arange(-1, width + 1)[None, :], np.arange(-1, height + 1)[:, None]
    if camera.lens is None:
        # Without a table of directions, which takes longer: a moving crop is a new camera.
        rays.right[:] = (columns - camera.cx) / camera.fx
        rays.down[:] = (rows - camera.cy) / camera.fy
        rays.area[:] = 1 / (camera.fx * camera.fy)
    else:
        directions = directions_of(columns, rows, camera)
        rays.right[:], rays.down[:] = directions[..., 0], directions[..., 1]
        # The area of the parallelogram between the rays of the neighbours.
        by_row, by_column = np.gradient(directions, axis=0), np.gradient(directions, axis=1)
        rays.area[:] = by_column[..., 0] * by_row[..., 1] - by_column[..., 1] * by_row[..., 0]
    for table in rays:
        table.flags.writeable = False  # the cache returns it again
    return rays


@lru_cache(maxsize=_CAMERAS)
def pixels_outside_field(camera: Intrinsics, height: int, width: int) -> NDArray[np.bool_] | None:
    """Return which pixels no ray reaches through the lens, shape (H, W); None if there are none.

    Far outside of the area that a calibration covers, a distortion model can fold back: then
    these pixels have no direction, and their depth must not be used. Arguments as `image_rays`.
    """
    if camera.lens is None:
        return None
    columns, rows = np.meshgrid(np.arange(width), np.arange(height))
    right, down, _ = image_rays(camera, height, width)
    directions = np.stack([right[1:-1, 1:-1], down[1:-1, 1:-1]], axis=-1).astype(np.float64)
    pixels = distort(directions, camera.lens) * (camera.fx, camera.fy) + (camera.cx, camera.cy)
    error = np.abs(pixels - np.stack([columns, rows], axis=-1)).max(axis=-1)
    outside = ~(error <= _LARGEST_ERROR)
    return outside if outside.any() else None
