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

"""Whether joints can belong to the person of whom some points are visible."""

import numpy as np
from numpy.typing import NDArray

LONGEST_REACH = 2.0
"""No joint of a person is farther from what is visible of that person, metres."""


def within_reach(joints: NDArray[np.float32], points: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Return which joints are in front of the camera and within LONGEST_REACH, shape (J,).

    If a mask or a depth image is nonsense, the votes can lead anywhere.

    Args:
        joints: metres, in the camera's frame, shape (J, 3); NaN is not within reach.
        points: visible points of the body, shape (N, 3), N > 0.
    """
    nearest = np.clip(joints, points.min(axis=0), points.max(axis=0))
    distances = np.linalg.norm((joints - nearest).astype(np.float64), axis=1)
    within: NDArray[np.bool_] = (joints[:, 2] > 0) & (distances <= LONGEST_REACH)
    return within
