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

"""The body in which a walk goes: its depth image, cut out and coarse, and the pinhole camera."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.body_parts.depth_grid import reduce_depth
from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.image_arguments import ImageArguments
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.silhouette.silhouette import cut_out

IMAGE_WIDTH = 320
"""A wider image is reduced to about this many columns."""


class GridCamera(NamedTuple):
    """A pinhole camera whose unit is the cell of a grid.

    The point (x, y, z) is in row int(fy y / z + cy) and column int(fx x / z + cx).
    """

    fx: float
    fy: float
    cx: float
    cy: float


class BodyGrid(NamedTuple):
    """The depth of one body alone.

    Attributes:
        depth: metres, 0 beside the body, shape (h, w).
        camera: the camera.
    """

    depth: NDArray[np.float32]
    camera: GridCamera


def body_grid(images: ImageArguments, body: int) -> BodyGrid | None:
    """Return the grid of a body, or None if no pixel of it has a depth.

    Args:
        images: depth, labels and a camera without a lens.
        body: the number of the body.
    """
    window = cut_out(images.depth, images.labels, body)
    if window is None:
        return None
    fx, fy, cx, cy = images.camera[:4]
    step = max(1, round(images.depth.shape[1] / IMAGE_WIDTH))
    camera = GridCamera(
        fx / step,
        fy / step,
        (cx - window.column + 0.5) / step,
        (cy - window.row + 0.5) / step,
    )
    return BodyGrid(reduce_depth(window.depth, step), camera)


def pinhole_images(images: ImageArguments) -> ImageArguments:
    """Return the images as a camera without a lens sees them; the same if it has none.

    Each pixel is that of the distorted image which is nearest to its ray.
    """
    camera = images.camera
    if camera.lens is None:
        return images
    height, width = images.depth.shape
    rows, columns = np.mgrid[:height, :width]
    x, y = (columns - camera.cx) / camera.fx, (rows - camera.cy) / camera.fy
    pixels = np.rint(project(np.stack([x, y, np.ones_like(x)], axis=-1), camera))
    seen = (pixels >= 0).all(axis=-1) & (pixels < (width, height)).all(axis=-1)
    column, row = pixels[seen].astype(np.int64).T
    depth, labels = np.zeros_like(images.depth), np.full_like(images.labels, NO_BODY)
    depth[seen], labels[seen] = images.depth[row, column], images.labels[row, column]
    return ImageArguments(depth, labels, Intrinsics(*camera[:4]))


@kernel
def body_centre(grid: BodyGrid) -> NDArray[np.float32]:
    """Return the mean of all points of a body, metres, shape (3,)."""
    depth, camera = grid.depth, grid.camera
    total = np.zeros(3)
    count = 0
    for i in range(depth.shape[0]):
        for j in range(depth.shape[1]):
            z = depth[i, j]
            if z > 0:
                total[0] += (j + 0.5 - camera.cx) * z / camera.fx
                total[1] += (i + 0.5 - camera.cy) * z / camera.fy
                total[2] += z
                count += 1
    return (total / count).astype(np.float32)
