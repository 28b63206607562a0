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

"""The probability of a person, averaged over the surface around each cell."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.body_parts.classes import NOT_A_PERSON
from lsc_pose_ros.numerics.jit import kernel

SURFACE_STEP = 0.12
"""Neighbouring cells of one surface differ in depth by at most this, metres."""

SMOOTHING_REACH = 2
"""Half width of the window in which probabilities are averaged, classified cells."""


@kernel
def smooth_person(
    probabilities: NDArray[np.float32], depth: NDArray[np.float32], reach: int
) -> NDArray[np.float32]:
    """Return the probability that each cell shows a person, averaged over its surface.

    It is the mean of 1 - p(no person) over the cells in the square window around a cell whose
    depth differs by at most SURFACE_STEP; 0 for a cell that was not classified.

    Args:
        probabilities: of each class, shape (h, w, CLASSES).
        depth: of the cells, metres, shape (h, w).
        reach: half width of the window, cells.
    """
    height, width = depth.shape
    smoothed = np.zeros((height, width), np.float32)
    person = np.zeros((height, width), np.float32)
    known = np.zeros((height, width), np.bool_)
    for i in range(height):
        for j in range(width):
            total = np.float32(0)
            for c in range(probabilities.shape[2]):
                total += probabilities[i, j, c]
            known[i, j] = total > 0
            person[i, j] = total - probabilities[i, j, NOT_A_PERSON]
    for i in range(height):
        for j in range(width):
            if not known[i, j]:
                continue
            total, count = np.float32(0), 0
            for k in range(max(i - reach, 0), min(i + reach + 1, height)):
                for m in range(max(j - reach, 0), min(j + reach + 1, width)):
                    if known[k, m] and abs(depth[k, m] - depth[i, j]) <= SURFACE_STEP:
                        total += person[k, m]
                        count += 1
            smoothed[i, j] = total / np.float32(count)
    return smoothed
