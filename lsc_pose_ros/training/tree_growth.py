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

"""Grows one tree, first its large nodes one by one, then what is below them side by side.

At a large node all cores look for the split, a feature each. A small node is too little work for
that; there each core grows a whole branch.
"""

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numba
import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel, parallel_kernel
from lsc_pose_ros.pose.forest.forest import TreeNodes
from lsc_pose_ros.training.criterion import Evidence, evidence_of
from lsc_pose_ros.training.splitter import Split, partition, try_feature

# A node with fewer samples than this is the root of a branch.
BRANCH_SAMPLES = 20_000


# Evidence as a plain tuple: numba's parallel loops take no named one of different arrays.
_Parts: TypeAlias = tuple[
    NDArray[np.int64], NDArray[np.uint8], NDArray[np.float32], NDArray[np.float32]
]


def _parts_of(evidence: Evidence) -> _Parts:
    return evidence.start, evidence.joint, evidence.value, evidence.nothing


class GrowthSettings(NamedTuple):
    """When a tree stops and how hard it looks for a split.

    Attributes:
        depth: how many splits a point passes at most.
        leaf_samples: the fewest samples a leaf may have.
        features: how many random features are tried at a node.
        thresholds: how many random thresholds are tried for each feature.
        always: the last so many features are tried at every node, beside the random ones.
    """

    depth: int = 24
    leaf_samples: int = 8
    features: int = 12
    thresholds: int = 100
    always: int = 0


class Tree(NamedTuple):
    """One tree, its nodes as in Forest; leaves are numbered from 0.

    Attributes:
        feature, threshold, left: as in Forest, shape (nodes,).
        order: the samples, leaf after leaf, shape (S,).
        leaf_start: the samples of leaf l are order[leaf_start[l] : leaf_start[l + 1]].
    """

    feature: NDArray[np.int16]
    threshold: NDArray[np.uint8]
    left: NDArray[np.int32]
    order: NDArray[np.int32]
    leaf_start: NDArray[np.int64]


class Nodes(NamedTuple):
    """Nodes while a tree grows: as in Tree, but a leaf's `left` is where its samples start."""

    feature: NDArray[np.int16]
    threshold: NDArray[np.uint8]
    left: NDArray[np.int64]


class Branches(NamedTuple):
    """Nodes that are grown side by side.

    Attributes:
        node: the branch's root in the tree, shape (B,).
        start, end: which of the ordered samples it has, shape (B,).
        depth: how many splits lie above, shape (B,).
        seed: of what it draws, shape (B,).
        room: its nodes have the places from room[b] to room[b + 1], shape (B + 1,).
    """

    node: NDArray[np.int64]
    start: NDArray[np.int64]
    end: NDArray[np.int64]
    depth: NDArray[np.int64]
    seed: NDArray[np.int64]
    room: NDArray[np.int64]


def grow_tree(
    quantised: NDArray[np.uint8],
    evidence: Evidence,
    settings: GrowthSettings,
    rng: np.random.Generator,
) -> Tree:
    """Return a tree grown on all samples.

    Args:
        quantised: quantised descriptors, shape (F, S).
        evidence: what the samples say of the joints, which the criterion judges splits by.
        settings: when to stop.
        rng: draws features and thresholds.
    """
    order = np.arange(quantised.shape[1], dtype=np.int32)
    trunk, branches = _grow_trunk(quantised, evidence, order, settings, rng)
    grown = Nodes(
        np.full(branches.room[-1], -1, np.int16),
        np.zeros(branches.room[-1], np.uint8),
        np.zeros(branches.room[-1], np.int64),
    )
    samples = (quantised, order)
    sizes = _grow_branches(samples, _parts_of(evidence), branches, grown, settings)
    return _graft(trunk, branches, (sizes, grown), order)


def _grow_trunk(
    quantised: NDArray[np.uint8],
    evidence: Evidence,
    order: NDArray[np.int32],
    settings: GrowthSettings,
    rng: np.random.Generator,
) -> tuple[Nodes, Branches]:
    """Split the large nodes; return them and the roots of the branches, which are leaves here."""
    feature: list[int] = [-1]
    threshold: list[int] = [0]
    left: list[int] = [0]
    branches: list[tuple[int, int, int, int]] = []
    waiting = [(0, 0, len(order), 0)]
    while waiting:
        node, start, end, depth = waiting.pop()
        split = Split(-1, 0, np.inf)
        if end - start >= BRANCH_SAMPLES and depth < settings.depth:
            split = find_split(quantised, evidence, order[start:end], settings, rng)
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
    room = np.concatenate([[0], np.cumsum(2 * ((ends - starts) // settings.leaf_samples) + 1)])
    return trunk, Branches(node_of, starts, ends, depths, seeds, room)


def find_split(
    quantised: NDArray[np.uint8],
    evidence: Evidence,
    members: NDArray[np.int32],
    settings: GrowthSettings,
    rng: np.random.Generator,
) -> Split:
    """Return the best of the random splits of the `members`, shape (n,), on all cores (eq. 8).

    The other arguments as `grow_tree`.
    """
    drawn = len(quantised) - settings.always
    features = rng.choice(drawn, min(settings.features, drawn), replace=False)
    features = np.concatenate([features, np.arange(drawn, len(quantised))])
    draws = rng.random((len(features), settings.thresholds))
    parts = _parts_of(evidence_of(evidence, members))
    costs, thresholds = _try_features(
        quantised, parts, members, (features, draws), settings.leaf_samples
    )
    best = int(np.argmin(costs))
    if not np.isfinite(costs[best]):
        return Split(-1, 0, np.inf)
    return Split(int(features[best]), int(thresholds[best]), float(costs[best]))


@parallel_kernel
def _try_features(
    quantised: NDArray[np.uint8],
    parts: _Parts,
    members: NDArray[np.int32],
    trials: tuple[NDArray[np.int64], NDArray[np.float64]],
    leaf_samples: int,
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    features, draws = trials
    costs = np.full(features.shape[0], np.inf)
    thresholds = np.zeros(features.shape[0], np.int64)
    for f in numba.prange(features.shape[0]):
        costs[f], thresholds[f] = try_feature(
            quantised[features[f]], Evidence(*parts), members, draws[f], leaf_samples
        )
    return costs, thresholds


@parallel_kernel
def _grow_branches(
    samples: tuple[NDArray[np.uint8], NDArray[np.int32]],
    parts: _Parts,
    branches: Branches,
    grown: Nodes,
    settings: GrowthSettings,
) -> NDArray[np.int64]:
    """Grow each branch into its own stretch of `grown`; return how many nodes each has."""
    first = branches.room
    sizes = np.zeros(branches.node.shape[0], np.int64)
    for b in numba.prange(branches.node.shape[0]):
        nodes = Nodes(
            grown.feature[first[b] : first[b + 1]],
            grown.threshold[first[b] : first[b + 1]],
            grown.left[first[b] : first[b + 1]],
        )
        # The generator is the thread's own, and a branch is grown by one thread.
        np.random.seed(branches.seed[b])  # noqa: NPY002 - the generator that kernels have
        span = branches.start[b], branches.end[b], branches.depth[b]
        sizes[b] = _grow_branch(samples, Evidence(*parts), span, (nodes, settings))
    return sizes


@kernel
def _grow_branch(
    samples: tuple[NDArray[np.uint8], NDArray[np.int32]],
    evidence: Evidence,
    span: tuple[int, int, int],
    growing: tuple[Nodes, GrowthSettings],
) -> int:
    quantised, order = samples
    nodes, settings = growing
    # Node, start, end, depth; the stack never holds more than a sibling a level.
    waiting = np.empty((settings.depth + 2, 4), np.int64)
    waiting[0, 0] = 0
    waiting[0, 1], waiting[0, 2], waiting[0, 3] = span
    height, used = 1, 1
    while height > 0:
        height -= 1
        node, start, end, depth = waiting[height]
        members = order[start:end]
        split = Split(-1, 0, np.inf)
        if depth < settings.depth and end - start >= 2 * settings.leaf_samples:
            split = _draw_split(quantised, evidence_of(evidence, members), members, settings)
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
    evidence: Evidence,
    members: NDArray[np.int32],
    settings: GrowthSettings,
) -> Split:
    """Return the best of random splits; as `find_split`, on one core."""
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
            quantised[feature], evidence, members, draws, settings.leaf_samples
        )
        if cost < best.cost:
            best = Split(feature, threshold, cost)
    return best


def _graft(
    trunk: Nodes,
    branches: Branches,
    grown: tuple[NDArray[np.int64], Nodes],
    order: NDArray[np.int32],
) -> Tree:
    """Return the trunk with the branches on it, leaves numbered in the order of their samples."""
    sizes, nodes = grown
    parts = [trunk]
    used = len(trunk.feature)
    for b, (node, size) in enumerate(zip(branches.node, sizes, strict=True)):
        own = slice(branches.room[b], branches.room[b] + size)
        branch = Nodes(nodes.feature[own], nodes.threshold[own], nodes.left[own].copy())
        # The branch's root takes the place of the trunk's leaf; its other nodes are put behind.
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


def join_trees(trees: Sequence[Tree]) -> TreeNodes:
    """Return the trees in one set of nodes, nodes and leaves renumbered one after the other."""
    nodes = np.cumsum([0, *(len(tree.feature) for tree in trees)])
    leaves = np.cumsum([0, *(len(tree.leaf_start) - 1 for tree in trees)])
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
