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

"""The confidence in a joint, from the fraction of its votes' weight near the joint.

Of the joints with confidence c, about a fraction c lies within NEAR of the ground truth. Training
learns for each joint which vote fraction means which confidence, from people that the forest was
not trained on (`training/calibration.py`). In a model without that calibration the confidence is
the vote fraction itself.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.forest.votes import Votes, votes_of_target
from lsc_pose_ros.pose.inference.density import Position, VoteCloud, density

NEAR = 0.1
"""A joint counts as correct up to this distance from the ground truth, metres."""

KNOTS = 41
"""The number of vote fractions, evenly from 0 to 1, for which a model has a confidence."""


def uncalibrated() -> NDArray[np.float32]:
    """Return the calibration of a model that has none, shape (0, KNOTS)."""
    return np.zeros((0, KNOTS), np.float32)


@kernel
def vote_fractions(
    votes: Votes, positions: NDArray[np.float32], bandwidth: float
) -> NDArray[np.float32]:
    """Return the fraction of the votes' weight near each joint, 0 to 1, shape (J,).

    It is 0 for a joint without votes or whose position is NaN. Arguments as `confidence_in`.
    """
    fractions = np.zeros(positions.shape[0], np.float32)
    for joint in range(positions.shape[0]):
        cloud = votes_of_target(votes, joint)
        if cloud.x.shape[0] == 0 or math.isnan(positions[joint, 0]):
            continue
        fractions[joint] = vote_fraction_near(positions[joint], cloud, bandwidth)
    return fractions


@kernel
def vote_fraction_near(position: Position, cloud: VoteCloud, bandwidth: float) -> np.float32:
    """Return the fraction of the weight of one joint's votes near a position, 0 to 1.

    Each vote counts by the Gaussian of eq. 14, from 1 at the position to 0 far away.

    Args:
        position: metres, shape (3,).
        cloud: the votes, at least one.
        bandwidth: h_j, metres.
    """
    return density(position, cloud, bandwidth) / np.sum(cloud.weight)


@kernel
def confidence_in(
    calibration: NDArray[np.float32],
    votes: Votes,
    positions: NDArray[np.float32],
    bandwidth: float,
) -> NDArray[np.float32]:
    """Return the confidence in each joint, 0 to 1, shape (J,); 0 if its position is NaN.

    Args:
        calibration: as in Model, shape (J, K) or (0, K).
        votes: the votes for each joint (eq. 13).
        positions: the joints, metres, shape (J, 3).
        bandwidth: h_j, metres.
    """
    fractions = vote_fractions(votes, positions, bandwidth)
    if calibration.shape[0] == 0:
        return fractions
    steps = calibration.shape[1] - 1
    confidence = np.zeros_like(fractions)
    for joint in range(positions.shape[0]):
        if math.isnan(positions[joint, 0]):
            continue
        scaled = min(max(fractions[joint], np.float32(0)), np.float32(1)) * np.float32(steps)
        knot = max(min(int(scaled), steps - 1), 0)  # NaN becomes some integer
        part = scaled - np.float32(knot)
        before, after = calibration[joint, knot], calibration[joint, knot + 1]
        confidence[joint] = before + part * (after - before)
    return confidence


def body_confidence(confidence: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the confidence in each body, 0 to 1, shape (B,).

    It is the mean confidence of the half of its joints that is most certain. So a person of whom
    only the upper half is seen can have a high one, whereas a piece of furniture, in which no
    joint is certain, has a low one.

    Args:
        confidence: in each joint, shape (B, J), at least one joint.
    """
    best = np.sort(confidence, axis=1)[:, confidence.shape[1] // 2 :]
    means: NDArray[np.float32] = best.mean(axis=1)
    return means
