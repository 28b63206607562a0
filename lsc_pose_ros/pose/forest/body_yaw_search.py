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

"""Search for the body yaw for which the votes of a forest agree most.

From behind, a person has the left hand where the right hand is from the front, and the
surroundings of a single point hardly distinguish the two. So the trees split by the body yaw, too.
With a wrong body yaw, points reach leaves of other body parts and their votes contradict each
other. The search tries several body yaws and takes the one for which the votes agree most.

Forests that are conditioned on a property of the whole body are those of Sun, Kohli and Shotton,
Conditional regression forests for human pose estimation (CVPR 2012). This goes beyond the paper.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.forest.body_yaw import body_yaws_around, with_body_yaw
from lsc_pose_ros.pose.forest.forest import find_leaves
from lsc_pose_ros.pose.forest.votes import Votes, VoteSettings, gather_votes, votes_of_target
from lsc_pose_ros.pose.inference.confidence import vote_fraction_near
from lsc_pose_ros.pose.inference.density import find_modes
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.silhouette.silhouette import choose_uniformly

# All body yaws are tried with this many of a person's points; more points change little.
_FEW_POINTS = 60

# The best body yaws are tried again with all points: at most this many, and only those with at
# least this fraction of the best agreement. In most cases only one is left.
_SHORTLIST = 3
_NEARLY_BEST = 0.9


def few_points(
    points: NDArray[np.float32], quantised: NDArray[np.uint8]
) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
    """Return some of the points and their descriptors, to try body yaws with."""
    few = choose_uniformly(len(points), _FEW_POINTS)
    return points[few], quantised[few]


def agreements(
    model: Model,
    points: NDArray[np.float32],
    quantised: NDArray[np.uint8],
    scale: float,
    body_yaws: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return `agreement_on` of each body yaw."""
    return np.array([agreement_on(model, points, quantised, scale, each) for each in body_yaws])


def choose_body_yaw(
    model: Model,
    points: NDArray[np.float32],
    quantised: NDArray[np.uint8],
    scale: float,
    rough: NDArray[np.float64],
) -> int:
    """Return the index of the best body yaw; all points decide between those that are nearly so.

    Args:
        model: its trees split by the body yaw.
        points: the person's points that vote, metres, shape (Q, 3).
        quantised: their quantised descriptors, shape (Q, F).
        scale: rho_bar, metres.
        rough: the agreement on each of the model's body yaws with few points.
    """
    body_yaws = body_yaws_around(len(rough))
    shortlist = np.argsort(-rough)[:_SHORTLIST]
    shortlist = shortlist[rough[shortlist] >= _NEARLY_BEST * rough.max()]
    if len(shortlist) == 1:
        return int(shortlist[0])
    exact = agreements(model, points, quantised, scale, body_yaws[shortlist])
    return int(shortlist[np.argmax(exact)])


def peak_beside(values: NDArray[np.float64], index: int) -> float:
    """Return the distance from `index` to the peak of `values` on a circle, from -0.5 to 0.5.

    Args:
        values: shape (n,).
        index: of a large value, though not always the largest.
    """
    before, here, after = values[index - 1], values[index], values[(index + 1) % len(values)]
    bend = before - 2 * here + after
    if bend >= 0:  # the parabola has no peak
        return 0.5 * float(np.sign(after - before))
    return float(np.clip(0.5 * (before - after) / bend, -0.5, 0.5))


def agreement_on(
    model: Model,
    points: NDArray[np.float32],
    quantised: NDArray[np.uint8],
    scale: float,
    body_yaw: float,
) -> float:
    """Return how well the votes agree if the person's body yaw is `body_yaw`, radians.

    Other arguments as `choose_body_yaw`.
    """
    settings = model.settings
    leaves = find_leaves(model.forest, with_body_yaw(quantised, body_yaw))
    vote_settings = VoteSettings(len(model.joints), settings.heaviest_votes, scale)
    votes = gather_votes(model.forest.joint_votes, leaves, points, vote_settings)
    return agreement(votes, settings.joint_bandwidth)


@kernel
def agreement(votes: Votes, bandwidth: float) -> float:
    """Return the vote fraction near each joint's best mode, summed over the joints.

    Args:
        votes: the votes for each joint (eq. 13).
        bandwidth: h_j, metres (eq. 14).
    """
    total = 0.0
    for joint in range(votes.start.shape[0] - 1):
        cloud = votes_of_target(votes, joint)
        modes = find_modes(cloud, bandwidth, 1)
        if modes.shape[0] > 0:
            total += float(vote_fraction_near(modes[0], cloud, bandwidth))
    return total
