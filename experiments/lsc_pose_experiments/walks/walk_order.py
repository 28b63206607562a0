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

"""The order of the walks: from the middle of the body to the limb ends."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import PARENTS, names_of

_START: dict[str, str] = {**PARENTS, 'neck': 'torso', 'pelvis': 'torso'}
del _START['torso']
"""The joint where the walk to a joint starts; to the torso it starts at the body's centre."""

CENTRE = -1


class WalkOrder(NamedTuple):
    """The walks to J joints, in an order in which each starts at a joint that is known.

    Attributes:
        joint: the index of the joint of each walk, shape (J,).
        start: the index of the joint where it starts, CENTRE for the body's centre, shape (J,).
    """

    joint: NDArray[np.int32]
    start: NDArray[np.int32]


def walk_order(numbers: NDArray[np.uint16] | Sequence[int]) -> WalkOrder:
    """Return the walks to the joints `numbers`.

    If the joint where a walk starts is not among them, that joint's own start replaces it.
    """
    names = names_of(numbers)
    chains = [_chain(name) for name in names]
    joints = sorted(range(len(names)), key=lambda j: len(chains[j]))
    known = [[names.index(name) for name in chains[j] if name in names] for j in joints]
    return WalkOrder(
        np.array(joints, np.int32),
        np.array([before[0] if before else CENTRE for before in known], np.int32),
    )


def _chain(name: str) -> list[str]:
    """Return the joints from the start of the walk to `name` back to the torso."""
    chain: list[str] = []
    while name in _START:
        name = _START[name]
        chain.append(name)
    return chain
