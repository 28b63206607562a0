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

"""What a leaf remembers: the largest clusters of its samples' offsets (eq. 11, 12)."""

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
    """Which samples speak for a joint or a pair, and how they are clustered.

    Attributes:
        joint_reach: a sample votes for a joint no farther than this, in units of rho_bar.
        joint_fraction: a cluster of offsets to a joint is kept if it has at least this fraction
            of the samples of its leaf.
        pair_reach: a sample votes for a pair when one of its joints is no farther than this.
        pair_fraction: a cluster of pair offsets is kept if it has at least this fraction of the
            samples of its leaf; smaller ones mislead more than they help, and cost time.
        bandwidth: of the mean-shift over offsets, in units of rho_bar.
        clusters: K, how many clusters a leaf keeps for each joint and each pair.
        most_samples: at most so many offsets are clustered; more are thinned out evenly.
        fewest_samples: a leaf with fewer offsets than this says nothing of the joint or pair.
    """

    joint_reach: float = 0.35
    joint_fraction: float = 0.0
    pair_reach: float = 0.6
    pair_fraction: float = 0.8
    bandwidth: float = 0.1
    clusters: int = 2
    most_samples: int = 100
    fewest_samples: int = 3


def fit_joint_votes(samples: Samples, tree: Tree, settings: LeafSettings) -> LeafVotes:
    """Return the leaves' joint votes: offsets x_j - p in units of rho_bar (eq. 11)."""
    count = samples.joints.shape[1]
    # For a joint, both ends of the "pair" are the joint itself, and offsets start at the point.
    pairs = np.stack([np.full(count, -1), np.arange(count)], axis=1)
    wanted = _Wanted(pairs, settings.joint_reach, settings.joint_fraction)
    return _fit(samples, tree, wanted, settings)


def fit_pair_votes(
    samples: Samples, tree: Tree, edges: NDArray[np.int32], settings: LeafSettings
) -> LeafVotes:
    """Return the leaves' pair votes: offsets x_child - x_parent in units of rho_bar (eq. 12).

    Args:
        samples: what the tree was grown on.
        tree: the tree.
        edges: (parent, child) joint indices, shape (E, 2).
        settings: reach and clustering.
    """
    wanted = _Wanted(edges.astype(np.int64), settings.pair_reach, settings.pair_fraction)
    return _fit(samples, tree, wanted, settings)


class _Wanted(NamedTuple):
    """What is voted for, shape (targets, 2), from how near, and from which share of a leaf on."""

    pairs: NDArray[np.int64]
    reach: float
    share: float


def _fit(samples: Samples, tree: Tree, wanted: _Wanted, settings: LeafSettings) -> LeafVotes:
    offsets, weights = _fit_leaves(
        (samples.points, samples.person, samples.joints),
        (tree.order, tree.leaf_start),
        wanted.pairs,
        wanted.reach,
        settings,
    )
    filled = (weights > 0) & (weights >= wanted.share)
    start = np.zeros(len(weights) + 1, np.int32)
    start[1:] = np.cumsum(filled.sum(axis=(1, 2)))
    targets = np.arange(len(wanted.pairs), dtype=np.uint8)
    target = np.broadcast_to(targets[None, :, None], filled.shape)
    return LeafVotes(start, target[filled], offsets[filled], weights[filled])


@parallel_kernel
def _fit_leaves(
    samples: tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.float32]],
    leaves: tuple[NDArray[np.int32], NDArray[np.int64]],
    pairs: NDArray[np.int64],
    reach: float,
    settings: LeafSettings,
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    order, leaf_start = leaves
    count = leaf_start.shape[0] - 1
    targets = pairs.shape[0]
    offsets = np.zeros((count, targets, settings.clusters, 3), np.float32)
    weights = np.zeros((count, targets, settings.clusters), np.float32)
    for leaf in numba.prange(count):
        members = order[leaf_start[leaf] : leaf_start[leaf + 1]]
        for pair in range(targets):
            spoken = _offsets(samples, members, pairs[pair], reach)
            if spoken.shape[0] < settings.fewest_samples:
                continue
            centres, sizes = largest_clusters(spoken, settings)
            offsets[leaf, pair, : len(sizes)] = centres
            # A share, not a count: a leaf that sorted its samples badly is large, not right.
            weights[leaf, pair, : len(sizes)] = sizes / np.float32(members.shape[0])
    return offsets, weights


@kernel
def _offsets(
    samples: tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.float32]],
    members: NDArray[np.int32],
    pair: NDArray[np.int64],
    reach: float,
) -> NDArray[np.float32]:
    """Return the offsets, (n, 3), of the members that may speak of (parent or -1, child)."""
    points, person, joints = samples
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

    Every offset climbs the density of all; those that arrive within half a bandwidth of each other
    are one cluster. Its size is the number of offsets that it stands for.

    Args:
        offsets: in units of rho_bar, shape (n, 3).
        settings: bandwidth, K, and how many offsets are clustered at most.
    """
    step = max(1, -(-offsets.shape[0] // settings.most_samples))
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
    # Thinning must not make a well-filled leaf speak more softly.
    return centres[largest], sizes[largest] * np.float32(offsets.shape[0] / thinned.shape[0])
