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

"""Tests of furniture against people and camera: whether it intersects or hides them."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import exact_kernel
from lsc_pose_ros.synthetic.scene.shapes import Blocks


@exact_kernel
def is_clear(blocks: Blocks, points: NDArray[np.float64], gap: float) -> bool:
    """Return whether no point is in a block that is enlarged by `gap` on all sides.

    Args:
        blocks: the blocks.
        points: metres, shape (P, 3).
        gap: metres; negative if slight contact is allowed.
    """
    for block in range(len(blocks.centres)):
        centre, axes, half = blocks.centres[block], blocks.axes[block], blocks.halves[block]
        reach = half[0] + half[1] + half[2] + 3.0 * abs(gap)
        for point in range(len(points)):
            x, y, z = (
                points[point, 0] - centre[0],
                points[point, 1] - centre[1],
                points[point, 2] - centre[2],
            )
            if abs(x) > reach or abs(y) > reach or abs(z) > reach:
                continue
            inside = True
            for axis in range(3):
                along = axes[0, axis] * x + axes[1, axis] * y + axes[2, axis] * z
                if abs(along) >= half[axis] + gap:
                    inside = False
                    break
            if inside:
                return False
    return True


@exact_kernel
def hides(blocks: Blocks, point: NDArray[np.float64]) -> bool:
    """Return whether a block crosses the line from the camera, at the origin, to `point`."""
    for block in range(len(blocks.centres)):
        centre, axes, half = blocks.centres[block], blocks.axes[block], blocks.halves[block]
        enters, leaves = 0.0, 1.0
        for axis in range(3):
            start, along = 0.0, 0.0
            for row in range(3):
                start -= axes[row, axis] * centre[row]
                along += axes[row, axis] * point[row]
            if along == 0.0:
                if abs(start) > half[axis]:
                    leaves = -1.0
                continue
            first, last = (-half[axis] - start) / along, (half[axis] - start) / along
            enters = max(enters, min(first, last))
            leaves = min(leaves, max(first, last))
        if enters < leaves:
            return True
    return False
