"""Finds the best split of one node: which feature, which threshold (eq. 7, 8)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.core.jit import kernel
from lsc_pose_ros.learning.criterion import entropy_times_count

LEVELS = 256


class Split(NamedTuple):
    """A split of a node; feature -1 where there is none.

    Attributes:
        feature: the bin of the descriptor that is compared.
        threshold: a level below it goes left.
        cost: |S_l| H(S_l) + |S_r| H(S_r), bits.
    """

    feature: int
    threshold: int
    cost: float


@kernel
def try_feature(
    levels: NDArray[np.uint8],
    weights: NDArray[np.float32],
    members: NDArray[np.int32],
    draws: NDArray[np.float64],
    leaf_samples: int,
) -> tuple[float, int]:
    """Return the least |S_l| H(S_l) + |S_r| H(S_r) and its threshold, for one feature (eq. 8).

    The contributions are summed by level once; every threshold then costs two sums over J.

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
    low, high = _accumulate(sums, counts)
    sides = np.empty((2, joints), np.float32)
    bits = sides.view(np.int32)
    # Levels that no sample has make different thresholds the same split.
    tried = np.zeros(count + 1, np.bool_)
    best, best_threshold = np.inf, 0
    for draw in draws:
        threshold = low + 1 + int(draw * (high - low))
        if threshold > high:
            continue
        below = counts[threshold - 1]
        if tried[below] or below < leaf_samples or count - below < leaf_samples:
            continue
        tried[below] = True
        for j in range(joints):
            sides[0, j] = sums[threshold - 1, j]
            sides[1, j] = sums[high, j] - sums[threshold - 1, j]
        left = entropy_times_count(sides[0], bits[0], below)
        right = entropy_times_count(sides[1], bits[1], count - below)
        cost = float(left) + float(right)
        if cost < best:
            best, best_threshold = cost, threshold
    return best, best_threshold


@kernel
def _accumulate(sums: NDArray[np.float64], counts: NDArray[np.int64]) -> tuple[int, int]:
    """Add up over the levels, in place; return the lowest and the highest level that occur."""
    low = 0
    while counts[low] == 0:
        low += 1
    high = LEVELS - 1
    while counts[high] == 0:
        high -= 1
    for level in range(low + 1, high + 1):
        counts[level] += counts[level - 1]
        sums[level] += sums[level - 1]
    return low, high


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
