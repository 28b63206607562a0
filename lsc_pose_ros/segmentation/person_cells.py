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


"""The cells of a depth grid that show people: positions, areas, and evidence for their parts."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.numerics.jit import kernel

_TRUNK = ('neck', 'torso', 'pelvis', 'l_shoulder', 'r_shoulder', 'l_hip', 'r_hip')

HEAD_CLASS = 1 + JOINT_NUMBERS['head']
"""The class of the head."""

TRUNK_CLASSES = np.array([1 + JOINT_NUMBERS[name] for name in _TRUNK], np.int64)
"""The classes of the trunk."""


class PersonCells(NamedTuple):
    """The N cells that probably show people, in scan order.

    Attributes:
        number: the number of each cell, -1 for the others, shape (h, w), int32.
        row, column: of each cell, shape (N,), int32.
        points: positions, metres, shape (N, 3), float32.
        area: of each cell as if it faced the camera, square metres, shape (N,), float32.
        person: the probability that it shows a person, shape (N,), float32.
        head: the probability that it shows a head, shape (N,), float32.
        trunk: the probability that it shows a trunk, shape (N,), float32.
    """

    number: NDArray[np.int32]
    row: NDArray[np.int32]
    column: NDArray[np.int32]
    points: NDArray[np.float32]
    area: NDArray[np.float32]
    person: NDArray[np.float32]
    head: NDArray[np.float32]
    trunk: NDArray[np.float32]


@kernel
def person_cells(
    probabilities: NDArray[np.float32],
    smoothed: NDArray[np.float32],
    depth: NDArray[np.float32],
    camera: tuple[float, float, float, float],
    threshold: float,
) -> PersonCells:
    """Return the cells whose smoothed probability of a person is at least `threshold`.

    Args:
        probabilities: of each class, shape (h, w, CLASSES).
        smoothed: as `smooth_person` returns it, shape (h, w).
        depth: of the cells, metres, shape (h, w).
        camera: fx, fy, cx, cy in cells.
        threshold: the least probability.
    """
    height, width = depth.shape
    fx, fy, cx, cy = camera
    number = np.full((height, width), -1, np.int32)
    count = 0
    for i in range(height):
        for j in range(width):
            if smoothed[i, j] >= threshold and smoothed[i, j] > 0:
                number[i, j] = count
                count += 1
    row, column = np.empty(count, np.int32), np.empty(count, np.int32)
    points = np.empty((count, 3), np.float32)
    area, person = np.empty(count, np.float32), np.empty(count, np.float32)
    head, trunk = np.empty(count, np.float32), np.zeros(count, np.float32)
    for i in range(height):
        for j in range(width):
            n = number[i, j]
            if n < 0:
                continue
            z = depth[i, j]
            row[n], column[n] = i, j
            points[n, 0], points[n, 1] = (j - cx) / fx * z, (i - cy) / fy * z
            points[n, 2] = z
            area[n] = z * z / (fx * fy)
            person[n] = smoothed[i, j]
            head[n] = probabilities[i, j, HEAD_CLASS]
            for c in TRUNK_CLASSES:
                trunk[n] += probabilities[i, j, c]
    return PersonCells(number, row, column, points, area, person, head, trunk)
