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

"""Projection and back-projection between points and pixels.

Points are in the optical frame of REP-103: x right, y down, z forward.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.lens import distort, undistort
from lsc_pose_ros.data_types.camera import Intrinsics


def back_project(
    columns: NDArray[np.number],
    rows: NDArray[np.number],
    depth: NDArray[np.floating],
    camera: Intrinsics,
) -> NDArray[np.float32]:
    """Return the points, shape (..., 3), of the pixels (columns, rows) at `depth`; metres."""
    if camera.lens is None:
        x = (columns - camera.cx) * depth / camera.fx
        y = (rows - camera.cy) * depth / camera.fy
        return np.stack([x, y, depth], axis=-1).astype(np.float32)
    directions = directions_of(columns, rows, camera)
    x, y = directions[..., 0] * depth, directions[..., 1] * depth
    return np.stack([x, y, depth], axis=-1).astype(np.float32)


def directions_of(
    columns: NDArray[np.number], rows: NDArray[np.number], camera: Intrinsics
) -> NDArray[np.float64]:
    """Return the directions (X / Z, Y / Z) of the rays of pixels, shape (..., 2)."""
    x, y = (columns - camera.cx) / camera.fx, (rows - camera.cy) / camera.fy
    directions = np.stack(np.broadcast_arrays(x, y), axis=-1).astype(np.float64)
    return directions if camera.lens is None else undistort(directions, camera.lens)


def project(points: NDArray[np.floating], camera: Intrinsics) -> NDArray[np.float32]:
    """Return the pixels (column, row), shape (..., 2), of `points`, shape (..., 3) in metres.

    A point at or behind the camera (z <= 0), or outside of the field of its lens, gives NaN.
    """
    z = np.where(points[..., 2] > 0, points[..., 2], np.nan)
    if camera.lens is None:
        column = camera.cx + camera.fx * points[..., 0] / z
        row = camera.cy + camera.fy * points[..., 1] / z
        return np.stack([column, row], axis=-1).astype(np.float32)
    directions = distort(points[..., :2].astype(np.float64) / z[..., None], camera.lens)
    pixels = directions * (camera.fx, camera.fy) + (camera.cx, camera.cy)
    return pixels.astype(np.float32)
