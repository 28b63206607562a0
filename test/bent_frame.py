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

"""Frames as a camera with a lens sees them."""

import numpy as np

from lsc_pose_ros.camera.projection import back_project, project
from lsc_pose_ros.data_types.camera import (
    EQUIDISTANT,
    PLUMB_BOB,
    RATIONAL_POLYNOMIAL,
    Intrinsics,
    Lens,
)
from lsc_pose_ros.data_types.frame import NO_BODY, Frame

LENSES = (
    Lens(PLUMB_BOB, (-0.3, 0.1, 0.001, -0.002, 0.0)),
    Lens(RATIONAL_POLYNOMIAL, (0.6, 0.3, 1e-4, -1e-4, 0.05, 1.1, 0.2, 0.02)),
    Lens(EQUIDISTANT, (0.05, -0.01, 0.0, 0.0)),
)
"""One lens of each model; each moves a pixel at the edge of the image by several pixels."""


def bend(frame: Frame, lens: Lens) -> Frame:
    """Return what the pinhole camera of `frame` sees with `lens` in front, pixel by pixel."""
    camera = Intrinsics(*frame.camera[:4], lens)
    rows, columns = np.indices(frame.depth.shape)
    rays = back_project(columns, rows, np.ones(frame.depth.shape), camera)
    column, row = np.moveaxis(np.rint(project(rays, frame.camera)).astype(int), -1, 0)
    height, width = frame.depth.shape
    inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
    at = row.clip(0, height - 1), column.clip(0, width - 1)
    return frame._replace(
        depth=np.where(inside, frame.depth[at], 0).astype(np.float32),
        labels=np.where(inside, frame.labels[at], NO_BODY).astype(np.int32),
        camera=camera,
    )
