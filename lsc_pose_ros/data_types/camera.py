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

"""The pinhole camera: projection and back-projection.

Points are in the optical frame of REP-103: x right, y down, z forward.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Intrinsics(NamedTuple):
    """Focal lengths and principal point of a pinhole camera (K of CameraInfo).

    Attributes:
        fx: horizontal focal length, pixels.
        fy: vertical focal length, pixels.
        cx: column of the principal point, pixels.
        cy: row of the principal point, pixels.
    """

    fx: float
    fy: float
    cx: float
    cy: float


def back_project(
    columns: NDArray[np.number],
    rows: NDArray[np.number],
    depth: NDArray[np.floating],
    camera: Intrinsics,
) -> NDArray[np.float32]:
    """Return the points, shape (..., 3), of the pixels (columns, rows) at `depth`; metres."""
    x = (columns - camera.cx) * depth / camera.fx
    y = (rows - camera.cy) * depth / camera.fy
    return np.stack([x, y, depth], axis=-1).astype(np.float32)


def project(points: NDArray[np.floating], camera: Intrinsics) -> NDArray[np.float32]:
    """Return the pixels (column, row), shape (..., 2), of `points`, shape (..., 3) in metres.

    A point at or behind the camera (z <= 0) gives NaN.
    """
    z = np.where(points[..., 2] > 0, points[..., 2], np.nan)
    column = camera.cx + camera.fx * points[..., 0] / z
    row = camera.cy + camera.fy * points[..., 1] / z
    return np.stack([column, row], axis=-1).astype(np.float32)
