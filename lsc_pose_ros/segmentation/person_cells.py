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


"""The cells of a depth grid that show people: their areas and the middles that they vote for."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.body_parts.part_network import CellParts
from lsc_pose_ros.numerics.jit import kernel


class PersonCells(NamedTuple):
    """The N cells that probably show people, in scan order.

    Attributes:
        number: the number of each cell, -1 for the others, shape (h, w), int32.
        vote: where each cell says the middle of its person is, metres, shape (N, 3), float32.
        area: of each cell as if it faced the camera, square metres, shape (N,), float32.
        person: the probability that it shows a person, shape (N,), float32.
    """

    number: NDArray[np.int32]
    vote: NDArray[np.float32]
    area: NDArray[np.float32]
    person: NDArray[np.float32]


@kernel
def person_cells(
    parts: CellParts,
    camera: tuple[float, float, float, float],
    threshold: float,
) -> PersonCells:
    """Return the cells whose probability of a person is at least `threshold`.

    Args:
        parts: what the cells show.
        camera: fx, fy, cx, cy in cells.
        threshold: the least probability.
    """
    height, width = parts.depth.shape
    fx, fy, cx, cy = camera
    number = np.full((height, width), -1, np.int32)
    count = 0
    for i in range(height):
        for j in range(width):
            if parts.person[i, j] >= threshold and parts.person[i, j] > 0:
                number[i, j] = count
                count += 1
    vote = np.empty((count, 3), np.float32)
    area, person = np.empty(count, np.float32), np.empty(count, np.float32)
    for i in range(height):
        for j in range(width):
            n = number[i, j]
            if n < 0:
                continue
            z = parts.depth[i, j]
            across, down, away = parts.to_middle[i, j]
            middle = max(z + away, np.float32(0.1))
            vote[n, 0] = ((j - cx) / fx + across / z) * middle
            vote[n, 1] = ((i - cy) / fy + down / z) * middle
            vote[n, 2] = middle
            area[n] = z * z / (fx * fy)
            person[n] = parts.person[i, j]
    return PersonCells(number, vote, area, person)
