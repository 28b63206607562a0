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


"""The body yaw over time: what successive frames say of it together.

People turn steadily. The belief in each body yaw is the largest sum of agreements over a path of
body yaws that ends there, less a penalty for each step on the circle (max-sum, the Viterbi
algorithm). It forgets: beliefs are bounded, so that some frames that agree overrule the past.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.pose.forest.body_yaw import body_yaws_around
from lsc_pose_ros.pose.forest.body_yaw_search import (
    agreements,
    choose_body_yaw,
    few_points,
    peak_beside,
)
from lsc_pose_ros.pose.model import Model

TURN_PENALTY = 0.5
"""The penalty of a step to the next of eight body yaws, in units of the agreement."""

LARGEST_DOUBT = 3.0
"""No body yaw is believed less than the best one by more than this."""

LEAST_AGREEMENT = 0.85
"""All body yaws are tried if the agreement falls below this fraction of that before."""

LEAST_LEAD = 1.0
"""A person's body yaw is decided if no other one, not beside it, is believed nearly as much: less
by no more than this."""


class BodyYawBelief(NamedTuple):
    """What is known of a person's body yaw.

    Attributes:
        yaw: radians, as `body_yaw_of`.
        belief: in each of the model's body yaws, 0 for the best one, less for the others, shape
            (n,).
        agreement: of the votes on each when they were last tried, as a fraction of the largest
            one of that frame, shape (n,).
        best_agreement: of the votes at the best one.
        doubtful: whether another one, not beside it, is believed nearly as much, or agrees better
            in this frame alone. Then all are tried again in the next frame.
    """

    yaw: float
    belief: NDArray[np.float64]
    agreement: NDArray[np.float64]
    best_agreement: float
    doubtful: bool = False


def carry_over(belief: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the belief before the next frame: b_k = max_j b_j - p |k - j| 8 / n on the circle.

    Args:
        belief: after the frame before, shape (n,).
    """
    count = len(belief)
    steps = abs(np.arange(count)[:, None] - np.arange(count)[None])
    steps = np.minimum(steps, count - steps)
    carried = (belief[None] - TURN_PENALTY * steps * 8 / count).max(axis=1)
    bounded: NDArray[np.float64] = np.maximum(carried - carried.max(), -LARGEST_DOUBT)
    return bounded


def follow_body_yaw(
    model: Model,
    points: NDArray[np.float32],
    quantised: NDArray[np.uint8],
    scale: float,
    before: BodyYawBelief | None,
    *,
    all_round: bool,
) -> BodyYawBelief:
    """Return the body yaw of a person, given that of the frame before.

    For a new person a few points try all body yaws. If several are nearly equal, all points decide
    between them. Between two body yaws the agreement is interpolated by a parabola.

    Args:
        model: its trees split by the body yaw.
        points: the person's points that vote, metres, shape (Q, 3).
        quantised: their quantised descriptors, shape (Q, F).
        scale: rho_bar, metres.
        before: after the frame before; None for a new person. It does not count if it has another
            number of body yaws.
        all_round: whether all body yaws are tried, or only those beside the one before if that is
            not doubtful.
    """
    body_yaws = body_yaws_around(model.settings.body_yaws)
    some = few_points(points, quantised)
    if before is None or len(before.belief) != len(body_yaws):
        rough = agreements(model, *some, scale, body_yaws)
        best = choose_body_yaw(model, points, quantised, scale, rough)
        belief = rough.copy()
        belief[best] = rough.max()
        return _belief(belief, rough, best)
    carried = carry_over(before.belief)
    expected = int(np.argmax(before.belief))
    if not all_round and not before.doubtful:
        near = np.arange(expected - 1, expected + 2) % len(body_yaws)
        tried = agreements(model, *some, scale, body_yaws[near])
        # The others agree as they did when they were tried: a body yaw that could be the right
        # one does not lose by not being tried.
        rough = before.agreement * tried.max()
        rough[near] = tried
        best = int(np.argmax(rough + carried))
        if rough[best] >= LEAST_AGREEMENT * before.best_agreement:
            return _belief(rough + carried, rough, best)
    rough = agreements(model, *some, scale, body_yaws)
    return _belief(rough + carried, rough, int(np.argmax(rough + carried)))


def _belief(belief: NDArray[np.float64], rough: NDArray[np.float64], best: int) -> BodyYawBelief:
    count = len(belief)
    yaw = float(body_yaws_around(count)[best] + peak_beside(rough, best) * 2 * np.pi / count)
    bounded = np.maximum(belief - belief.max(), -LARGEST_DOUBT)
    steps = abs(np.arange(count) - best)
    away = np.minimum(steps, count - steps) > 1
    doubtful = bool(away[np.argmax(rough)]) or bool((bounded[away] > -LEAST_LEAD).any())
    agreement = rough / max(rough.max(), np.finfo(np.float64).tiny)
    return BodyYawBelief(yaw, bounded, agreement, float(rough[best]), doubtful)
