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

"""The votes of a body's silhouette points, from the leaves that they reach (eq. 13)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.forest.forest import LeafVotes
from lsc_pose_ros.pose.inference.density import VoteCloud


class Votes(NamedTuple):
    """The heaviest votes for each target, a joint or an edge, in metres.

    Attributes:
        start: the votes for target t are start[t] to start[t + 1], shape (targets + 1,).
        cloud: the V votes for all targets: the position of a joint, or for an edge that of the
            child relative to its parent.
    """

    start: NDArray[np.int64]
    cloud: VoteCloud

    @property
    def position(self) -> NDArray[np.float32]:
        """The votes' positions, shape (V, 3)."""
        return np.stack([self.cloud.x, self.cloud.y, self.cloud.z], axis=1)

    @property
    def weight(self) -> NDArray[np.float32]:
        """The votes' weights, shape (V,)."""
        return self.cloud.weight


class VoteSettings(NamedTuple):
    """How votes are gathered.

    Attributes:
        targets: the number of joints, or of edges, that get votes.
        heaviest: M, how many votes for each are kept.
        scale: rho_bar, metres; the leaves' offsets are multiples of it.
    """

    targets: int
    heaviest: int
    scale: float


@kernel
def gather_votes(
    votes: LeafVotes,
    leaves: NDArray[np.int32],
    origins: NDArray[np.float32],
    vote_settings: VoteSettings,
) -> Votes:
    """Return the M heaviest votes for each target (eq. 13, sets S and S').

    Args:
        votes: the forest's votes for joints or for pairs.
        leaves: the leaf of each point in each tree, shape (N, T).
        origins: the offsets are added to these: the points in metres, or zeros for pairs, (N, 3).
        vote_settings: the numbers of targets and votes, and the scale.
    """
    gathered = _gather(votes, leaves, vote_settings.targets)
    counts = gathered.counts
    start = np.zeros(vote_settings.targets + 1, np.int64)
    start[1:] = np.cumsum(np.minimum(counts, vote_settings.heaviest))
    x, y, z, weight = np.empty((4, start[-1]), np.float32)
    scale = np.float32(vote_settings.scale)
    for target in range(vote_settings.targets):
        kept = _heaviest(gathered.weight[target, : counts[target]], vote_settings.heaviest)
        for n in range(len(kept)):
            entry = gathered.entry[target, kept[n]]
            point = gathered.point[target, kept[n]]
            row = start[target] + n
            weight[row] = gathered.weight[target, kept[n]]
            x[row] = origins[point, 0] + scale * votes.offset[entry, 0]
            y[row] = origins[point, 1] + scale * votes.offset[entry, 1]
            z[row] = origins[point, 2] + scale * votes.offset[entry, 2]
    return Votes(start, VoteCloud(x, y, z, weight))


@kernel
def votes_of_target(votes: Votes, target: int) -> VoteCloud:
    """Return the votes for one target, as views."""
    start, end = votes.start[target], votes.start[target + 1]
    cloud = votes.cloud
    return VoteCloud(
        cloud.x[start:end], cloud.y[start:end], cloud.z[start:end], cloud.weight[start:end]
    )


class _Gathered(NamedTuple):
    """All votes for each target, in the order of points and trees.

    Attributes:
        counts: how many each target has, shape (targets,).
        entry: their indices in the forest's votes, shape (targets, most).
        point: the index of the point that votes, shape (targets, most).
        weight: shape (targets, most).
    """

    counts: NDArray[np.int64]
    entry: NDArray[np.int32]
    point: NDArray[np.int32]
    weight: NDArray[np.float32]


@kernel
def _gather(votes: LeafVotes, leaves: NDArray[np.int32], targets: int) -> _Gathered:
    # The leaves are scattered over memory, so each is read once only: the arrays have room for
    # the case that all votes have the same target.
    most = 0
    for point in range(leaves.shape[0]):
        for tree in range(leaves.shape[1]):
            leaf = leaves[point, tree]
            most += votes.start[leaf + 1] - votes.start[leaf]
    counts = np.zeros(targets, np.int64)
    entries = np.empty((targets, most), np.int32)
    points = np.empty((targets, most), np.int32)
    weights = np.empty((targets, most), np.float32)
    for point in range(leaves.shape[0]):
        for tree in range(leaves.shape[1]):
            leaf = leaves[point, tree]
            for entry in range(votes.start[leaf], votes.start[leaf + 1]):
                target = votes.target[entry]
                column = counts[target]
                entries[target, column] = entry
                points[target, column] = point
                weights[target, column] = votes.weight[entry]
                counts[target] = column + 1
    return _Gathered(counts, entries, points, weights)


@kernel
def _heaviest(weights: NDArray[np.float32], wanted: int) -> NDArray[np.int64]:
    """Return the indices of the `wanted` largest weights; the earlier ones among equal ones."""
    count = weights.shape[0]
    if count <= wanted:
        return np.arange(count)
    limit = np.partition(weights, count - wanted)[count - wanted]
    kept = np.empty(wanted, np.int64)
    free = wanted
    for i in range(count):
        free -= weights[i] > limit
    found = 0
    for i in range(count):
        if weights[i] > limit:
            kept[found] = i
            found += 1
        elif weights[i] == limit and free > 0:
            kept[found] = i
            found += 1
            free -= 1
    return kept
