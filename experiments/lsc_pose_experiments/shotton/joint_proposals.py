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

"""Joint proposals from the pixels of body parts (Shotton et al., section 3.3)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.shotton.part_pixels import PartCloud
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.inference.density import climb, squared_distance

MOST_STARTS = 30
"""Mean-shift starts at no more pixels than this; they are taken evenly from all."""


class Proposal(NamedTuple):
    """The best proposal for a joint.

    Attributes:
        x, y, z: metres; NaN if there is none.
        confidence: the fraction of the weight of all starts that reaches it, 0 if there is none.
    """

    x: np.float32
    y: np.float32
    z: np.float32
    confidence: np.float32


class ProposalSettings(NamedTuple):
    """The settings of one part, learned by `choose_settings`.

    Attributes:
        bandwidth: b_c of eq. 7, metres.
        threshold: lambda_c: mean-shift starts at pixels with at least this probability.
        depth_offset: zeta_c: how far the joint is behind the surface, metres.
    """

    bandwidth: float
    threshold: float
    depth_offset: float


@kernel
def surface_proposal(cloud: PartCloud, bandwidth: float, threshold: float) -> Proposal:
    """Return the mode of a part's density (eq. 7) that gets most of the weight.

    Mean-shift starts at pixels whose probability is at least `threshold`. The weight of each
    start counts for the mode that it reaches. Modes closer than a bandwidth are one.

    Args:
        cloud: the pixels.
        bandwidth: b_c, metres.
        threshold: lambda_c.
    """
    votes = cloud.votes
    starts = starts_of(cloud.probability, threshold)
    modes = np.empty((starts.shape[0], 3), np.float32)
    weights = np.zeros(starts.shape[0], np.float32)
    near = np.float32(bandwidth * bandwidth)
    found = 0
    for start in starts:
        mode = climb((votes.x[start], votes.y[start], votes.z[start]), votes, bandwidth)
        known = 0
        while known < found and squared_distance(mode, modes[known]) >= near:
            known += 1
        if known == found:
            modes[known, 0], modes[known, 1], modes[known, 2] = mode
            found += 1
        weights[known] += votes.weight[start]
    if not found:
        nothing = np.float32(np.nan)
        return Proposal(nothing, nothing, nothing, np.float32(0))
    best = np.argmax(weights)
    return Proposal(modes[best, 0], modes[best, 1], modes[best, 2], weights[best] / weights.sum())


@kernel
def starts_of(probability: NDArray[np.float32], threshold: float) -> NDArray[np.int64]:
    """Return the indices of the pixels at which mean-shift starts, at most MOST_STARTS."""
    possible = np.flatnonzero(probability >= threshold)
    stride = max(1, -(-possible.shape[0] // MOST_STARTS))
    return possible[::stride]


def push_back(positions: NDArray[np.float32], offset: float) -> NDArray[np.float32]:
    """Return positions, metres, shape (..., 3), moved along their rays: `offset` more depth."""
    pushed: NDArray[np.float32] = positions * (1 + offset / positions[..., 2:])
    return pushed
