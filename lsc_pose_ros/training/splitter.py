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

"""Finds the best split of one node: which feature, which threshold (eq. 7, 8)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.training.criterion import Evidence, add_up, cost_of

LEVELS = 256


class Split(NamedTuple):
    """A split of a node; feature -1 where there is none.

    Attributes:
        feature: the bin of the descriptor that is compared.
        threshold: a level below it goes left.
        cost: of both sides together, as the criterion counts it.
    """

    feature: int
    threshold: int
    cost: float


@kernel
def try_feature(
    quantised: NDArray[np.uint8],
    evidence: Evidence,
    members: NDArray[np.int32],
    draws: NDArray[np.float64],
    leaf_samples: int,
) -> tuple[float, int]:
    """Return the least cost of both sides together and its threshold, for one feature (eq. 8).

    The evidence is summed by level once; every threshold then costs two sums over J.

    Args:
        quantised: the feature's level in every sample, shape (S,).
        evidence: of the members, in their order.
        members: the node's samples, shape (n,).
        draws: thresholds as shares of the members' range of levels, shape (thresholds,).
        leaf_samples: the fewest samples that a side may have.
    """
    low, high = _range(quantised, members)
    counts, sums = _sums_below(quantised, evidence, members, (low, high))
    count, everything = members.shape[0], sums[-1]
    rest = np.empty_like(everything)
    # Levels that no sample has make different thresholds the same split.
    tried = np.zeros(count + 1, np.bool_)
    best, best_threshold = np.inf, 0
    for draw in draws:
        threshold = low + 1 + int(draw * (high - low))
        if threshold > high:
            continue
        below = counts[threshold - low - 1]
        if tried[below] or below < leaf_samples or count - below < leaf_samples:
            continue
        tried[below] = True
        left = sums[threshold - low - 1]
        for j in range(rest.shape[0]):
            for c in range(rest.shape[1]):
                rest[j, c] = everything[j, c] - left[j, c]
        cost = float(cost_of(left, below)) + float(cost_of(rest, count - below))
        if cost < best:
            best, best_threshold = cost, threshold
    return best, best_threshold


@kernel
def _range(quantised: NDArray[np.uint8], members: NDArray[np.int32]) -> tuple[int, int]:
    """Return the lowest and the highest level of the members."""
    low, high = LEVELS - 1, 0
    for member in members:
        low = min(low, int(quantised[member]))
        high = max(high, int(quantised[member]))
    return low, high


@kernel
def _sums_below(
    quantised: NDArray[np.uint8],
    evidence: Evidence,
    members: NDArray[np.int32],
    span: tuple[int, int],
) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """Return how many members have at most each level of the span, and their evidence's sums."""
    low, high = span
    counts = np.zeros(high - low + 1, np.int64)
    sums = np.zeros((high - low + 1, *evidence.nothing.shape), np.float32)
    for n in range(members.shape[0]):
        level = quantised[members[n]] - low
        counts[level] += 1
        add_up(sums[level], evidence, n)
    for level in range(1, high - low + 1):
        counts[level] += counts[level - 1]
        for j in range(sums.shape[1]):
            for c in range(sums.shape[2]):
                sums[level, j, c] += sums[level - 1, j, c]
    return counts, sums


@kernel
def partition(quantised: NDArray[np.uint8], members: NDArray[np.int32], threshold: int) -> int:
    """Put the members below `threshold` first, in place, orders kept; return how many they are.

    Args:
        quantised: the feature's level in every sample, shape (S,).
        members: the node's samples, shape (n,).
        threshold: the level at which the right side begins.
    """
    right = np.empty_like(members)
    below, above = 0, 0
    for n in range(members.shape[0]):
        if quantised[members[n]] < threshold:
            members[below] = members[n]
            below += 1
        else:
            right[above] = members[n]
            above += 1
    members[below:] = right[:above]
    return below
