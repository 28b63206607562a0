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

"""The space that a person takes up in a room."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.synthetic.body.body_file import BodyModel

LIMB, SEAT, TRUNK = 0, 1, 2
"""Regions of the skin: limbs and head, buttocks and thighs, trunk without buttocks."""

_BONES_OF_REGIONS = (
    (SEAT, ('root', 'pelvis', 'spine05', 'upperleg')),
    (TRUNK, ('spine01', 'spine02', 'spine03', 'spine04', 'clavicle', 'shoulder')),
)


class Occupant(NamedTuple):
    """A person in T frames, in the level frame at the camera: x right, y down, z away.

    Attributes:
        points: of the skin, spread over it, metres, shape (T, P, 3).
        regions: the region of each point: LIMB, SEAT or TRUNK, shape (P,).
        joints: metres, shape (T, 20, 3).
        seated: whether the person sits on a seat.
        raised: whether the person lies on something that is higher than the floor.
    """

    points: NDArray[np.float64]
    regions: NDArray[np.int64]
    joints: NDArray[np.float64]
    seated: bool
    raised: bool = False

    def joint(self, name: str) -> NDArray[np.float64]:
        """Return the mean position of a joint, shape (3,)."""
        mean: NDArray[np.float64] = self.joints[:, JOINT_NUMBERS[name]].mean(axis=0)
        return mean

    def front(self) -> NDArray[np.float64]:
        """Return the horizontal direction (x, z) that the pelvis faces on average, length 1."""
        across = (self.joint('l_hip') - self.joint('r_hip'))[[0, 2]]
        ahead = np.array([across[1], -across[0]])
        return unit(ahead)


def unit(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a horizontal direction (x, z) with length 1; away from the camera if it is zero."""
    length = float(np.sqrt((direction**2).sum()))
    return direction / length if length > 0 else np.array([0.0, 1.0])


def regions_of(body: BodyModel) -> NDArray[np.int64]:
    """Return the region of each vertex by the bone that it follows most, shape (V,)."""
    regions = np.full(len(body.bones), LIMB)
    for region, starts in _BONES_OF_REGIONS:
        regions[[str(name).startswith(starts) for name in body.bones]] = region
    chosen: NDArray[np.int64] = regions[body.skin_bones[:, 0]]
    return chosen
