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

"""The candidates for each joint: the highest modes of its density (eq. 14)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.forest.votes import Votes, votes_of_target
from lsc_pose_ros.pose.inference.density import find_modes


class Candidates(NamedTuple):
    """The modes of each joint's density, the highest first.

    Attributes:
        positions: metres, NaN if unused, shape (J, K, 3).
        counts: how many of the K positions are used, shape (J,).
    """

    positions: NDArray[np.float32]
    counts: NDArray[np.int64]


@kernel
def find_candidates(votes: Votes, bandwidth: float, wanted: int) -> Candidates:
    """Return at most `wanted` modes of each joint's density (eq. 14).

    Args:
        votes: the votes for each joint (eq. 13).
        bandwidth: h_j, metres.
        wanted: K.
    """
    joints = votes.start.shape[0] - 1
    positions = np.full((joints, wanted, 3), np.nan, np.float32)
    counts = np.zeros(joints, np.int64)
    for joint in range(joints):
        modes = find_modes(votes_of_target(votes, joint), bandwidth, wanted)
        counts[joint] = modes.shape[0]
        positions[joint, : modes.shape[0]] = modes
    return Candidates(positions, counts)


def positions_of(candidates: Candidates, which: NDArray[np.int64]) -> NDArray[np.float32]:
    """Return the position of one candidate of each joint, metres, shape (J, 3).

    Args:
        candidates: the modes of each joint's density.
        which: the index of the candidate, -1 for none: its position is NaN, shape (J,).
    """
    positions = candidates.positions[np.arange(len(which)), np.maximum(which, 0)]
    return np.where(which[:, None] >= 0, positions, np.float32(np.nan))


def highest_modes(candidates: Candidates) -> NDArray[np.float32]:
    """Return the first candidate of each joint, metres, NaN for a joint without one, (J, 3)."""
    return positions_of(candidates, np.minimum(candidates.counts, 1) - 1)
