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

"""The stature of a body, from the distances of its joints: posture does not change it."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS

_TRUNK = (('head', 'neck'), ('neck', 'torso'), ('torso', 'pelvis'))
_LEG = (('hip', 'knee'), ('knee', 'ankle'))

SKELETON_TO_STATURE = 1.09
"""Stature divided by the length from head to ankle along the joints.

Measured on the synthetic bodies of all ages: 1.09 to 1.10 for statures from 0.97 to 1.9 m.
"""


def statures(
    positions: NDArray[np.float32], joints: NDArray[np.unsignedinteger]
) -> NDArray[np.float32]:
    """Return the stature of each body, metres, shape (B,); NaN if a needed joint is missing.

    The legs count with the mean of both sides, or with the one that is known.

    Args:
        positions: of the joints, metres, NaN if unknown, shape (B, J, 3).
        joints: the number of each joint, shape (J,).
    """
    columns = {int(number): column for column, number in enumerate(joints)}

    def length(first: str, second: str) -> NDArray[np.float32]:
        ends = [columns.get(JOINT_NUMBERS[name]) for name in (first, second)]
        if None in ends:
            return np.full(len(positions), np.nan, np.float32)
        between: NDArray[np.float32] = np.linalg.norm(
            positions[:, ends[0]] - positions[:, ends[1]], axis=-1
        )
        return between

    trunk = sum((length(*ends) for ends in _TRUNK), np.zeros(len(positions), np.float32))
    sides = np.array(
        [
            sum(length(f'{side}_{first}', f'{side}_{second}') for first, second in _LEG)
            for side in 'lr'
        ]
    )
    known = ~np.isnan(sides)
    legs = np.where(known, sides, 0).sum(axis=0) / np.where(
        known.any(axis=0), known.sum(axis=0), np.nan
    )
    stature: NDArray[np.float32] = (SKELETON_TO_STATURE * (trunk + legs)).astype(np.float32)
    return stature
