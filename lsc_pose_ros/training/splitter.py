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

"""Finds the best threshold of one feature, and splits a node there (eq. 7, 8)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.training.criterion import JointStatistics, add_statistics, cost_of

QUANTISED_VALUES = 256


class Split(NamedTuple):
    """A split of a node; the feature is -1 for none.

    Attributes:
        feature: the bin of the descriptor that is compared.
        threshold: samples with a quantised value below it go left.
        cost: the sum of the costs of both sides.
    """

    feature: int
    threshold: int
    cost: float


@kernel
def try_feature(
    quantised: NDArray[np.uint8],
    statistics: JointStatistics,
    members: NDArray[np.int32],
    draws: NDArray[np.float64],
    leaf_samples: int,
) -> tuple[float, int]:
    """Return the lowest cost of a split by one feature, and its threshold (eq. 8).

    The statistics are summed once for each quantised value; then each threshold costs two sums
    over J.

    Args:
        quantised: the quantised feature of all samples, shape (S,).
        statistics: the statistics of the members, in their order.
        members: the samples of the node, shape (n,).
        draws: thresholds as fractions of the members' range of values, shape (thresholds,).
        leaf_samples: the fewest samples that a side may have.

    Returns:
        The cost, infinity if no split is allowed, and the threshold.
    """
    low, high = _range(quantised, members)
    counts, sums = _sums_below(quantised, statistics, members, low, high)
    count, total = members.shape[0], sums[-1]
    rest = np.empty_like(total)
    # Thresholds with no sample between them are the same split, which is tried once.
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
                rest[j, c] = total[j, c] - left[j, c]
        cost = float(cost_of(left, below)) + float(cost_of(rest, count - below))
        if cost < best:
            best, best_threshold = cost, threshold
    return best, best_threshold


@kernel
def _range(quantised: NDArray[np.uint8], members: NDArray[np.int32]) -> tuple[int, int]:
    """Return the lowest and the highest quantised value of the members."""
    low, high = QUANTISED_VALUES - 1, 0
    for member in members:
        low = min(low, int(quantised[member]))
        high = max(high, int(quantised[member]))
    return low, high


@kernel
def _sums_below(
    quantised: NDArray[np.uint8],
    statistics: JointStatistics,
    members: NDArray[np.int32],
    low: int,
    high: int,
) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """Return the cumulated counts and statistics of the members for each value, low to high."""
    counts = np.zeros(high - low + 1, np.int64)
    sums = np.zeros((high - low + 1, *statistics.zeros.shape), np.float32)
    for n in range(members.shape[0]):
        value = quantised[members[n]] - low
        counts[value] += 1
        add_statistics(sums[value], statistics, n)
    for value in range(1, high - low + 1):
        counts[value] += counts[value - 1]
        for j in range(sums.shape[1]):
            for c in range(sums.shape[2]):
                sums[value, j, c] += sums[value - 1, j, c]
    return counts, sums


@kernel
def partition(quantised: NDArray[np.uint8], members: NDArray[np.int32], threshold: int) -> int:
    """Move the members below `threshold` to the front, stably and in place; return their number.

    Args:
        quantised: the quantised feature of all samples, shape (S,).
        members: the samples of the node, shape (n,).
        threshold: the lowest value of the right side.
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
