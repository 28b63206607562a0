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


"""What the frames before say of a person: where the joints were, and the body yaw.

A frame alone does not tell a left from a right arm, or a front from a back, as well as a sequence
does. The past is a bounded prior: it decides between candidates that a frame finds nearly equally
good, and a frame that clearly says otherwise wins.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.forest.body_yaw_tracking import BodyYawBelief
from lsc_pose_ros.pose.inference.candidates import Candidates
from lsc_pose_ros.pose.inference.density import Position, squared_distance

STRENGTH = 1.0
"""How much the past counts, in units of the logarithm of a density."""

MOST_REACHES = 2.0
"""A candidate farther from the past than so many reaches is not rated lower any more."""

NEW_PERSON = 0.3
"""If the median joint is so far from the past, the past is that of something else, metres."""


class Past(NamedTuple):
    """What is expected of one person in a frame.

    Attributes:
        joints: where each joint is expected, metres, NaN if unknown, shape (J, 3), float32.
        weight: how much is known of each, 0 to 1, shape (J,), float32.
        reach: how far a joint moves until this frame, metres.
        body_yaw: what is known of the body yaw; None if the model does not split by it.
        all_round: whether all body yaws are to be tried again.
    """

    joints: NDArray[np.float32]
    weight: NDArray[np.float32]
    reach: float
    body_yaw: BodyYawBelief | None
    all_round: bool


@kernel
def log_past(expected: Position, weight: float, reach: float, position: Position) -> float:
    """Return the logarithm of the prior of a joint at `position`: -s w min((d / r)^2, m^2).

    d is its distance from where it is expected, r the reach, m MOST_REACHES, s STRENGTH. It is 0
    if nothing is expected.

    Args:
        expected: metres, NaN if unknown, shape (3,).
        weight: w.
        reach: r, metres.
        position: metres, shape (3,).
    """
    squared = float(squared_distance(expected, position)) / (reach * reach)
    if math.isnan(squared):
        return 0.0
    return -STRENGTH * weight * min(squared, MOST_REACHES * MOST_REACHES)


def contradicts(past: Past, joints: NDArray[np.float32]) -> bool:
    """Return whether the joints of a frame are those of something else than the past's.

    Args:
        past: what is expected.
        joints: the highest mode of each joint in the frame, metres, NaN for none, shape (J, 3).
    """
    distance = np.linalg.norm(joints - past.joints, axis=1)
    known = distance[np.isfinite(distance)]
    return not len(known) or float(np.median(known)) >= NEW_PERSON


def log_pasts(past: Past | None, candidates: Candidates) -> NDArray[np.float64]:
    """Return `log_past` of each candidate, shape (J, K); 0 without a past."""
    if past is None:
        return np.zeros(candidates.positions.shape[:2])
    return _log_pasts(past.joints, past.weight, past.reach, candidates)


@kernel
def _log_pasts(
    expected: NDArray[np.float32],
    weight: NDArray[np.float32],
    reach: float,
    candidates: Candidates,
) -> NDArray[np.float64]:
    positions, counts = candidates.positions, candidates.counts
    priors = np.zeros(positions.shape[:2])
    for joint in range(positions.shape[0]):
        for k in range(counts[joint]):
            priors[joint, k] = log_past(expected[joint], weight[joint], reach, positions[joint, k])
    return priors
