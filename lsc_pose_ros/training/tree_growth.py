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

"""Grows one tree: large nodes one after the other, then the branches below them in parallel.

At a large node all cores search for the split, one feature each. A small node is too little work
for that, so each core grows a whole branch.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel, parallel_kernel
from lsc_pose_ros.pose.forest.forest import TreeNodes
from lsc_pose_ros.training.checkpoint import FinishedTree
from lsc_pose_ros.training.criterion import JointStatistics, select_statistics
from lsc_pose_ros.training.splitter import Split, partition, try_feature

# A node with fewer samples than this is the root of a branch.
BRANCH_SAMPLES = 20_000

# The parallel kernels take the arrays of JointStatistics one by one, because numba's parallel
# loops do not accept a named tuple of different arrays.


class GrowthSettings(NamedTuple):
    """The limits of a tree, and the number of splits that are tried.

    Attributes:
        depth: the largest number of splits from the root to a leaf.
        leaf_samples: the fewest samples of a leaf.
        features: number of random features that are tried at a node.
        thresholds: number of random thresholds that are tried for each feature.
        always: number of features, the last ones, that are tried at each node in addition.
    """

    depth: int = 24
    leaf_samples: int = 8
    features: int = 12
    thresholds: int = 100
    always: int = 0


class Tree(NamedTuple):
    """One tree with nodes as in Forest; leaves are numbered from 0.

    Attributes:
        feature, threshold, left: as in Forest, shape (nodes,).
        order: the sample indices, ordered by leaf, shape (S,).
        leaf_start: the samples of leaf l are order[leaf_start[l] : leaf_start[l + 1]].
    """

    feature: NDArray[np.int16]
    threshold: NDArray[np.uint8]
    left: NDArray[np.int32]
    order: NDArray[np.int32]
    leaf_start: NDArray[np.int64]


class Nodes(NamedTuple):
    """Nodes of a growing tree: as in Tree, but `left` of a leaf is the start of its samples."""

    feature: NDArray[np.int16]
    threshold: NDArray[np.uint8]
    left: NDArray[np.int64]


class Branches(NamedTuple):
    """B branches that are grown in parallel.

    Attributes:
        node: the node of the trunk that is the root of the branch, shape (B,).
        start, end: the range of its samples in their order, shape (B,).
        depth: number of splits above the root, shape (B,).
        seed: seed of its random numbers, shape (B,).
        first_node: branch b has the nodes first_node[b] to first_node[b + 1], shape (B + 1,).
    """

    node: NDArray[np.int64]
    start: NDArray[np.int64]
    end: NDArray[np.int64]
    depth: NDArray[np.int64]
    seed: NDArray[np.int64]
    first_node: NDArray[np.int64]


def grow_tree(
    quantised: NDArray[np.uint8],
    statistics: JointStatistics,
    settings: GrowthSettings,
    rng: np.random.Generator,
) -> Tree:
    """Return a tree grown on all samples.

    Args:
        quantised: quantised descriptors, shape (F, S).
        statistics: the statistics from which the criterion computes the cost of a split.
        settings: limits of the tree.
        rng: draws features and thresholds.
    """
    order = np.arange(quantised.shape[1], dtype=np.int32)
    trunk, branches = _grow_trunk(quantised, statistics, order, settings, rng)
    grown = Nodes(
        np.full(branches.first_node[-1], -1, np.int16),
        np.zeros(branches.first_node[-1], np.uint8),
        np.zeros(branches.first_node[-1], np.int64),
    )
    sizes = _grow_branches(
        quantised,
        order,
        statistics.start,
        statistics.joint,
        statistics.value,
        statistics.zeros,
        branches,
        grown,
        settings,
    )
    return _graft(trunk, branches, sizes, grown, order)


def _grow_trunk(
    quantised: NDArray[np.uint8],
    statistics: JointStatistics,
    order: NDArray[np.int32],
    settings: GrowthSettings,
    rng: np.random.Generator,
) -> tuple[Nodes, Branches]:
    """Split the large nodes; return them, and the branches, whose roots are the leaves here."""
    feature: list[int] = [-1]
    threshold: list[int] = [0]
    left: list[int] = [0]
    branches: list[tuple[int, int, int, int]] = []
    waiting = [(0, 0, len(order), 0)]
    while waiting:
        node, start, end, depth = waiting.pop()
        split = Split(-1, 0, np.inf)
        if end - start >= BRANCH_SAMPLES and depth < settings.depth:
            split = find_split(quantised, statistics, order[start:end], settings, rng)
        if split.feature < 0:
            branches.append((node, start, end, depth))
            continue
        middle = start + partition(quantised[split.feature], order[start:end], split.threshold)
        feature[node], threshold[node], left[node] = split.feature, split.threshold, len(feature)
        feature += [-1, -1]
        threshold += [0, 0]
        left += [0, 0]
        waiting.append((left[node] + 1, middle, end, depth + 1))
        waiting.append((left[node], start, middle, depth + 1))
    trunk = Nodes(
        np.array(feature, np.int16), np.array(threshold, np.uint8), np.array(left, np.int64)
    )
    node_of, starts, ends, depths = np.array(branches, np.int64).T.copy()
    seeds = rng.integers(0, 2**31, len(branches))
    first_node = np.concatenate(
        [[0], np.cumsum(2 * ((ends - starts) // settings.leaf_samples) + 1)]
    )
    return trunk, Branches(node_of, starts, ends, depths, seeds, first_node)


def find_split(
    quantised: NDArray[np.uint8],
    statistics: JointStatistics,
    members: NDArray[np.int32],
    settings: GrowthSettings,
    rng: np.random.Generator,
) -> Split:
    """Return the best of random splits of `members`, on all cores (eq. 8).

    Args:
        quantised: quantised descriptors, shape (F, S).
        statistics: the joint statistics of all samples.
        members: the samples of the node, shape (n,).
        settings: number of tries, and the fewest samples of a leaf.
        rng: draws features and thresholds.
    """
    drawn = len(quantised) - settings.always
    features = rng.choice(drawn, min(settings.features, drawn), replace=False)
    features = np.concatenate([features, np.arange(drawn, len(quantised))])
    draws = rng.random((len(features), settings.thresholds))
    own = select_statistics(statistics, members)
    costs, thresholds = _try_features(
        quantised,
        own.start,
        own.joint,
        own.value,
        own.zeros,
        members,
        features,
        draws,
        settings.leaf_samples,
    )
    best = int(np.argmin(costs))
    if not np.isfinite(costs[best]):
        return Split(-1, 0, np.inf)
    return Split(int(features[best]), int(thresholds[best]), float(costs[best]))


@parallel_kernel
def _try_features(
    quantised: NDArray[np.uint8],
    start: NDArray[np.int64],
    joint: NDArray[np.uint8],
    value: NDArray[np.float32],
    zeros: NDArray[np.float32],
    members: NDArray[np.int32],
    features: NDArray[np.int64],
    draws: NDArray[np.float64],
    leaf_samples: int,
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the lowest cost of each feature, and its threshold."""
    costs = np.full(features.shape[0], np.inf)
    thresholds = np.zeros(features.shape[0], np.int64)
    for f in numba.prange(features.shape[0]):
        costs[f], thresholds[f] = try_feature(
            quantised[features[f]],
            JointStatistics(start, joint, value, zeros),
            members,
            draws[f],
            leaf_samples,
        )
    return costs, thresholds


@parallel_kernel
def _grow_branches(
    quantised: NDArray[np.uint8],
    order: NDArray[np.int32],
    start: NDArray[np.int64],
    joint: NDArray[np.uint8],
    value: NDArray[np.float32],
    zeros: NDArray[np.float32],
    branches: Branches,
    grown: Nodes,
    settings: GrowthSettings,
) -> NDArray[np.int64]:
    """Grow each branch into its own range of `grown`; return their numbers of nodes."""
    first = branches.first_node
    sizes = np.zeros(branches.node.shape[0], np.int64)
    for b in numba.prange(branches.node.shape[0]):
        nodes = Nodes(
            grown.feature[first[b] : first[b + 1]],
            grown.threshold[first[b] : first[b + 1]],
            grown.left[first[b] : first[b + 1]],
        )
        # Each thread has its own generator, and one thread grows the whole branch.
        np.random.seed(branches.seed[b])  # noqa: NPY002 - the only generator in kernels
        sizes[b] = _grow_branch(
            quantised,
            order,
            JointStatistics(start, joint, value, zeros),
            branches.start[b],
            branches.end[b],
            branches.depth[b],
            nodes,
            settings,
        )
    return sizes


@kernel
def _grow_branch(
    quantised: NDArray[np.uint8],
    order: NDArray[np.int32],
    statistics: JointStatistics,
    first: int,
    last: int,
    above: int,
    nodes: Nodes,
    settings: GrowthSettings,
) -> int:
    """Grow one branch into `nodes`; return its number of nodes.

    Args:
        quantised: quantised descriptors, shape (F, S).
        order: the sample indices; those of the branch are sorted by leaf.
        statistics: the joint statistics of all samples.
        first: the start of the branch in `order`.
        last: its end.
        above: number of splits above the root of the branch.
        nodes: receives the nodes.
        settings: limits of the tree.
    """
    # Node, start, end, depth; the stack has at most one sibling for each depth.
    waiting = np.empty((settings.depth + 2, 4), np.int64)
    waiting[0, 0] = 0
    waiting[0, 1], waiting[0, 2], waiting[0, 3] = first, last, above
    height, used = 1, 1
    while height > 0:
        height -= 1
        node, start, end, depth = waiting[height]
        members = order[start:end]
        split = Split(-1, 0, np.inf)
        if depth < settings.depth and end - start >= 2 * settings.leaf_samples:
            split = _draw_split(
                quantised, select_statistics(statistics, members), members, settings
            )
        if split.feature < 0:
            nodes.left[node] = start
            continue
        middle = start + partition(quantised[split.feature], members, split.threshold)
        nodes.feature[node] = split.feature
        nodes.threshold[node] = split.threshold
        nodes.left[node] = used
        waiting[height] = np.array((used + 1, middle, end, depth + 1))
        waiting[height + 1] = np.array((used, start, middle, depth + 1))
        height += 2
        used += 2
    return used


@kernel
def _draw_split(
    quantised: NDArray[np.uint8],
    statistics: JointStatistics,
    members: NDArray[np.int32],
    settings: GrowthSettings,
) -> Split:
    """Return the best of random splits, as `find_split`, on one core."""
    best = Split(-1, 0, np.inf)
    size = quantised.shape[0] - settings.always
    drawn = np.zeros(size, np.bool_)
    wanted = min(settings.features, size)
    for n in range(wanted + settings.always):
        feature = size + n - wanted
        if n < wanted:
            feature = np.random.randint(size)  # noqa: NPY002
            while drawn[feature]:
                feature = np.random.randint(size)  # noqa: NPY002
            drawn[feature] = True
        draws = np.random.random(settings.thresholds)  # noqa: NPY002
        cost, threshold = try_feature(
            quantised[feature], statistics, members, draws, settings.leaf_samples
        )
        if cost < best.cost:
            best = Split(feature, threshold, cost)
    return best


def _graft(
    trunk: Nodes,
    branches: Branches,
    sizes: NDArray[np.int64],
    nodes: Nodes,
    order: NDArray[np.int32],
) -> Tree:
    """Return trunk and branches as one tree, with leaves in the order of their samples.

    Args:
        trunk: the large nodes.
        branches: the branches.
        sizes: number of nodes of each branch, shape (B,).
        nodes: the nodes of all branches.
        order: the sample indices, ordered by leaf.
    """
    parts = [trunk]
    used = len(trunk.feature)
    for b, (node, size) in enumerate(zip(branches.node, sizes, strict=True)):
        own = slice(branches.first_node[b], branches.first_node[b] + size)
        branch = Nodes(nodes.feature[own], nodes.threshold[own], nodes.left[own].copy())
        # The root of the branch replaces the leaf of the trunk; its other nodes are appended.
        branch.left[branch.feature >= 0] += used - 1
        trunk.feature[node] = branch.feature[0]
        trunk.threshold[node] = branch.threshold[0]
        trunk.left[node] = branch.left[0]
        parts.append(Nodes(branch.feature[1:], branch.threshold[1:], branch.left[1:]))
        used += size - 1
    feature, threshold, left = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    leaves = feature < 0
    starts = np.unique(left[leaves])
    left[leaves] = np.searchsorted(starts, left[leaves])
    return Tree(feature, threshold, left.astype(np.int32), order, np.append(starts, len(order)))


def join_trees(trees: Sequence[Tree | FinishedTree]) -> TreeNodes:
    """Return the nodes of all trees as one, with nodes and leaves renumbered consecutively."""
    nodes = np.cumsum([0, *(len(tree.feature) for tree in trees)])
    leaves = np.cumsum([0, *((tree.feature < 0).sum() for tree in trees)])
    left = [
        np.where(tree.feature >= 0, tree.left + nodes[t], tree.left + leaves[t])
        for t, tree in enumerate(trees)
    ]
    return TreeNodes(
        nodes[:-1].astype(np.int32),
        np.concatenate([tree.feature for tree in trees]),
        np.concatenate([tree.threshold for tree in trees]),
        np.concatenate(left).astype(np.int32),
    )
