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

"""Fits the votes of the leaves: the largest clusters of their samples' offsets (eq. 11, 12)."""

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel, parallel_kernel
from lsc_pose_ros.pose.forest.forest import LeafVotes
from lsc_pose_ros.pose.inference.density import VoteCloud, climb, squared_distance
from lsc_pose_ros.training.samples import Samples
from lsc_pose_ros.training.tree_growth import Tree


class LeafSettings(NamedTuple):
    """How leaf votes are fitted.

    Attributes:
        joint_reach: a sample votes for a joint within this distance, in units of rho_bar.
        joint_fraction: a cluster of offsets to a joint is kept if it has at least this fraction
            of the samples of its leaf.
        pair_reach: a sample votes for a pair if one of its joints is within this distance.
        pair_fraction: a cluster of pair offsets is kept if it has at least this fraction of the
            samples of its leaf; smaller clusters make estimates worse and slower.
        bandwidth: bandwidth of mean-shift over offsets, in units of rho_bar.
        clusters: K, the number of clusters that a leaf keeps for each joint and each pair.
        most_offsets: more offsets than this are thinned evenly before clustering.
        fewest_offsets: a leaf with fewer offsets does not vote for the joint or pair.
    """

    joint_reach: float = 0.35
    joint_fraction: float = 0.0
    pair_reach: float = 0.6
    pair_fraction: float = 0.8
    bandwidth: float = 0.1
    clusters: int = 2
    most_offsets: int = 100
    fewest_offsets: int = 3


def fit_joint_votes(samples: Samples, tree: Tree, settings: LeafSettings) -> LeafVotes:
    """Return the joint votes of the leaves: offsets x_j - p in units of rho_bar (eq. 11)."""
    count = samples.joints.shape[1]
    # A joint is a pair whose offsets start at the point itself (-1).
    pairs = np.stack([np.full(count, -1), np.arange(count)], axis=1)
    reach, fraction = settings.joint_reach, settings.joint_fraction
    return _fit(samples, tree, pairs, reach, fraction, settings)


def fit_pair_votes(
    samples: Samples, tree: Tree, edges: NDArray[np.int32], settings: LeafSettings
) -> LeafVotes:
    """Return the pair votes of the leaves: x_child - x_parent in units of rho_bar (eq. 12).

    Args:
        samples: the samples that the tree was grown on.
        tree: the tree.
        edges: (parent, child) joint indices, shape (E, 2).
        settings: reach, bandwidth and numbers of clusters.
    """
    pairs, reach, fraction = edges.astype(np.int64), settings.pair_reach, settings.pair_fraction
    return _fit(samples, tree, pairs, reach, fraction, settings)


def _fit(
    samples: Samples,
    tree: Tree,
    pairs: NDArray[np.int64],
    reach: float,
    fraction: float,
    settings: LeafSettings,
) -> LeafVotes:
    """Return the votes for `pairs`, (parent or -1, child) joint indices, shape (targets, 2)."""
    offsets, weights = _fit_leaves(
        samples.points,
        samples.person,
        samples.joints,
        tree.order,
        tree.leaf_start,
        pairs,
        reach,
        settings,
    )
    filled = (weights > 0) & (weights >= fraction)
    start = np.zeros(len(weights) + 1, np.int32)
    start[1:] = np.cumsum(filled.sum(axis=(1, 2)))
    targets = np.arange(len(pairs), dtype=np.uint8)
    target = np.broadcast_to(targets[None, :, None], filled.shape)
    return LeafVotes(start, target[filled], offsets[filled], weights[filled])


@parallel_kernel
def _fit_leaves(
    points: NDArray[np.float32],
    person: NDArray[np.int32],
    joints: NDArray[np.float32],
    order: NDArray[np.int32],
    leaf_start: NDArray[np.int64],
    pairs: NDArray[np.int64],
    reach: float,
    settings: LeafSettings,
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    count = leaf_start.shape[0] - 1
    targets = pairs.shape[0]
    offsets = np.zeros((count, targets, settings.clusters, 3), np.float32)
    weights = np.zeros((count, targets, settings.clusters), np.float32)
    for leaf in numba.prange(count):
        members = order[leaf_start[leaf] : leaf_start[leaf + 1]]
        for pair in range(targets):
            voting = _offsets(points, person, joints, members, pairs[pair], reach)
            if voting.shape[0] < settings.fewest_offsets:
                continue
            centres, sizes = largest_clusters(voting, settings)
            offsets[leaf, pair, : len(sizes)] = centres
            # A fraction, not a count: a large leaf may be badly sorted.
            weights[leaf, pair, : len(sizes)] = sizes / np.float32(members.shape[0])
    return offsets, weights


@kernel
def _offsets(
    points: NDArray[np.float32],
    person: NDArray[np.int32],
    joints: NDArray[np.float32],
    members: NDArray[np.int32],
    pair: NDArray[np.int64],
    reach: float,
) -> NDArray[np.float32]:
    """Return the offsets, (n, 3), of the members in reach of `pair`, (parent or -1, child)."""
    offsets = np.empty((members.shape[0], 3), np.float32)
    count = 0
    for sample in members:
        point = points[sample]
        child = joints[person[sample], pair[1]]
        near = squared_distance(child, point) <= reach * reach  # false for NaN
        origin = point
        if pair[0] >= 0:
            origin = joints[person[sample], pair[0]]
            near |= squared_distance(origin, point) <= reach * reach
        if near and not np.isnan(origin[0]) and not np.isnan(child[0]):
            offsets[count] = child - origin
            count += 1
    return offsets[:count]


@kernel
def largest_clusters(
    offsets: NDArray[np.float32], settings: LeafSettings
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the centres, (k, 3), and sizes, (k,), of the k <= K largest mean-shift clusters.

    Mean-shift moves each offset to a mode of the density of all offsets. Offsets whose modes are
    within half a bandwidth are one cluster. The size is the number of its offsets.

    Args:
        offsets: in units of rho_bar, shape (n, 3).
        settings: bandwidth, K and `most_offsets`.
    """
    step = max(1, -(-offsets.shape[0] // settings.most_offsets))
    thinned = offsets[::step].copy()
    x, y, z = thinned.T.copy()
    cloud = VoteCloud(x, y, z, np.ones(thinned.shape[0], np.float32))
    centres = np.empty_like(thinned)
    sizes = np.zeros(thinned.shape[0], np.float32)
    found = 0
    near = (0.5 * settings.bandwidth) ** 2
    for n in range(thinned.shape[0]):
        mode = climb(thinned[n], cloud, settings.bandwidth)
        k = 0
        while k < found and squared_distance(mode, centres[k]) > near:
            k += 1
        if k == found:
            centres[found, 0], centres[found, 1], centres[found, 2] = mode
            found += 1
        sizes[k] += 1
    largest = np.argsort(-sizes[:found], kind='mergesort')[: settings.clusters]
    # Thinning must not reduce the weight of a large leaf.
    return centres[largest], sizes[largest] * np.float32(offsets.shape[0] / thinned.shape[0])
