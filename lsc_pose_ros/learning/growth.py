"""Grows one tree: which feature and threshold split each node (eq. 7, 8)."""

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.core.descriptor import DESCRIPTOR_SIZE
from lsc_pose_ros.core.jit import kernel, parallel_kernel
from lsc_pose_ros.learning.criterion import entropy_times_count

LEVELS = 256


class GrowthSettings(NamedTuple):
    """When a tree stops and how hard it looks for a split.

    Attributes:
        depth: how many splits a point passes at most.
        leaf_samples: the fewest samples a leaf may have.
        features: how many random features are tried at a node.
        thresholds: how many random thresholds are tried for each feature.
    """

    depth: int = 20
    leaf_samples: int = 20
    features: int = 12
    thresholds: int = 100


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


class Split(NamedTuple):
    """The best split of a node that was found; feature -1 where there is none."""

    feature: int
    threshold: int
    cost: float


def grow_tree(
    levels: NDArray[np.uint8],
    weights: NDArray[np.float32],
    settings: GrowthSettings,
    rng: np.random.Generator,
) -> Tree:
    """Return a tree grown on all samples.

    Args:
        levels: quantised descriptors, shape (360, S).
        weights: the joints' contributions, shape (S, J) (eq. 10).
        settings: when to stop.
        rng: draws features and thresholds.
    """
    order = np.arange(levels.shape[1], dtype=np.int32)
    feature: list[int] = [-1]
    threshold: list[int] = [0]
    left: list[int] = [0]
    leaf_start: list[int] = []
    waiting = [(0, 0, len(order), 0)]
    while waiting:
        node, start, end, depth = waiting.pop()
        split = _find_split(levels, weights, order[start:end], settings, rng, depth)
        if split.feature < 0:
            left[node] = len(leaf_start)
            leaf_start.append(start)
            continue
        middle = start + partition(levels[split.feature], order[start:end], split.threshold)
        feature[node], threshold[node] = split.feature, split.threshold
        left[node] = len(feature)
        for _ in range(2):
            feature.append(-1)
            threshold.append(0)
            left.append(0)
        waiting.append((left[node] + 1, middle, end, depth + 1))
        waiting.append((left[node], start, middle, depth + 1))
    return Tree(
        np.array(feature, np.int16),
        np.array(threshold, np.uint8),
        np.array(left, np.int32),
        order,
        np.array([*leaf_start, len(order)], np.int64),
    )


def _find_split(
    levels: NDArray[np.uint8],
    weights: NDArray[np.float32],
    members: NDArray[np.int32],
    settings: GrowthSettings,
    rng: np.random.Generator,
    depth: int,
) -> Split:
    if depth >= settings.depth or len(members) < 2 * settings.leaf_samples:
        return Split(-1, 0, np.inf)
    features = rng.choice(DESCRIPTOR_SIZE, settings.features, replace=False)
    draws = rng.random((settings.features, settings.thresholds))
    return best_split(levels, weights, members, (features, draws), settings.leaf_samples)


def best_split(
    levels: NDArray[np.uint8],
    weights: NDArray[np.float32],
    members: NDArray[np.int32],
    trials: tuple[NDArray[np.int64], NDArray[np.float64]],
    leaf_samples: int,
) -> Split:
    """Return the split with the least weighted entropy among the trials (eq. 8).

    Args:
        levels: quantised descriptors, shape (360, S).
        weights: the joints' contributions, shape (S, J).
        members: the node's samples, shape (n,).
        trials: features, shape (F,), and for each its thresholds as shares of the range of levels
            that the node's samples have, within [0, 1), shape (F, thresholds).
        leaf_samples: the fewest samples that a side may have.
    """
    features, draws = trials
    costs = np.full(len(features), np.inf)
    thresholds = np.zeros(len(features), np.int64)
    search = _search_together if len(members) > _WORTH_SHARING else _search
    search(levels, weights[members], members, (features, draws), leaf_samples, costs, thresholds)
    best = int(np.argmin(costs))
    if not np.isfinite(costs[best]):
        return Split(-1, 0, np.inf)
    return Split(int(features[best]), int(thresholds[best]), float(costs[best]))


# With fewer samples than this, waking the other cores costs more than they save.
_WORTH_SHARING = 4096


@parallel_kernel
def _search_together(
    levels: NDArray[np.uint8],
    weights: NDArray[np.float32],
    members: NDArray[np.int32],
    trials: tuple[NDArray[np.int64], NDArray[np.float64]],
    leaf_samples: int,
    costs: NDArray[np.float64],
    thresholds: NDArray[np.int64],
) -> None:
    features, draws = trials
    for f in numba.prange(features.shape[0]):
        costs[f], thresholds[f] = try_feature(
            levels[features[f]], weights, members, draws[f], leaf_samples
        )


@kernel
def _search(
    levels: NDArray[np.uint8],
    weights: NDArray[np.float32],
    members: NDArray[np.int32],
    trials: tuple[NDArray[np.int64], NDArray[np.float64]],
    leaf_samples: int,
    costs: NDArray[np.float64],
    thresholds: NDArray[np.int64],
) -> None:
    features, draws = trials
    for f in range(features.shape[0]):
        costs[f], thresholds[f] = try_feature(
            levels[features[f]], weights, members, draws[f], leaf_samples
        )


@kernel
def try_feature(
    levels: NDArray[np.uint8],
    weights: NDArray[np.float32],
    members: NDArray[np.int32],
    draws: NDArray[np.float64],
    leaf_samples: int,
) -> tuple[float, int]:
    """Return the least |S_l| H(S_l) + |S_r| H(S_r) and its threshold, for one feature (eq. 8).

    The contributions are summed by level once; every threshold then costs J additions.

    Args:
        levels: the feature's level in every sample, shape (S,).
        weights: the members' contributions, shape (n, J).
        members: the node's samples, shape (n,).
        draws: thresholds as shares of the members' range of levels, shape (thresholds,).
        leaf_samples: the fewest samples that a side may have.
    """
    count, joints = weights.shape
    sums = np.zeros((LEVELS, joints))
    counts = np.zeros(LEVELS, np.int64)
    for n in range(count):
        level = levels[members[n]]
        counts[level] += 1
        for j in range(joints):
            sums[level, j] += weights[n, j]
    occupied = np.flatnonzero(counts)
    low, high = occupied[0], occupied[-1]
    for level in range(low + 1, high + 1):
        counts[level] += counts[level - 1]
        sums[level] += sums[level - 1]
    tried = np.zeros(LEVELS, np.bool_)
    best, best_threshold = np.inf, 0
    for draw in draws:
        threshold = low + 1 + int(draw * (high - low))
        if threshold > high or tried[threshold]:
            continue
        tried[threshold] = True
        below = counts[threshold - 1]
        if below < leaf_samples or count - below < leaf_samples:
            continue
        cost = entropy_times_count(sums[threshold - 1], below) + entropy_times_count(
            sums[high] - sums[threshold - 1], count - below
        )
        if cost < best:
            best, best_threshold = cost, threshold
    return best, best_threshold


@kernel
def partition(levels: NDArray[np.uint8], members: NDArray[np.int32], threshold: int) -> int:
    """Put the members below `threshold` first, in place, orders kept; return how many they are.

    Args:
        levels: the feature's level in every sample, shape (S,).
        members: the node's samples, shape (n,).
        threshold: the level at which the right side begins.
    """
    right = np.empty_like(members)
    below, above = 0, 0
    for n in range(members.shape[0]):
        if levels[members[n]] < threshold:
            members[below] = members[n]
            below += 1
        else:
            right[above] = members[n]
            above += 1
    members[below:] = right[:above]
    return below
