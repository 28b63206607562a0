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


"""Growth of one tree of the body-part forest (Shotton et al., section 3.3)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.depth_comparisons import (
    Cells,
    compare_cells,
    draw_offsets,
    draw_subset,
    draw_thresholds,
    move_below,
)
from lsc_pose_experiments.shotton.part_samples import PartSamples
from lsc_pose_ros.body_parts.classes import CLASSES
from lsc_pose_ros.numerics.jit import kernel

LEAST_GAIN = 1e-6
"""A smaller gain is a rounding error, bits."""


class PartGrowth(NamedTuple):
    """The settings of a tree.

    Attributes:
        depth: the largest number of splits above a leaf.
        leaf_samples: the fewest samples of a leaf.
        features: number of random pairs of offsets that are tried at a node.
        thresholds: number of thresholds that are tried for each of them.
        subset: at a node with more samples, a random subset of this size chooses the split.
        reach: the largest offset, metres.
    """

    depth: int = 20
    leaf_samples: int = 20
    features: int = 200
    thresholds: int = 10
    subset: int = 4000
    reach: float = 1.2


class PartTree(NamedTuple):
    """One tree; the root is node 0.

    Attributes:
        splits: as in PartForest, shape (n, 5).
        left: as in PartForest, shape (n,).
        leaves: the probability of each class at each leaf, shape (L, CLASSES).
    """

    splits: NDArray[np.float32]
    left: NDArray[np.int32]
    leaves: NDArray[np.float32]


@kernel
def grow_part_tree(samples: PartSamples, growth: PartGrowth, seed: int) -> PartTree:
    """Grow a tree by splits with the largest gain of information.

    Args:
        samples: the samples.
        growth: the settings.
        seed: of the random numbers of the calling thread.
    """
    np.random.seed(seed)  # noqa: NPY002 - numba has no generators
    count = samples.part.shape[0]
    order = np.arange(count)
    most = 2 * (count // max(growth.leaf_samples, 1)) + 1
    splits, left = np.zeros((most, 5), np.float32), np.zeros(most, np.int32)
    leaves = np.zeros((most // 2 + 1, CLASSES), np.float32)
    # Nodes that wait for their split: node, first and last member, depth.
    waiting = np.zeros((growth.depth + 2, 4), np.int64)
    waiting[0, 2] = count
    pending, nodes, leaf = 1, 1, 0
    logarithms = n_log_n(growth.subset + 1)
    while pending > 0:
        pending -= 1
        node, first, last, level = waiting[pending]
        members = order[first:last]
        middle = first
        if level < growth.depth and last - first >= 2 * growth.leaf_samples:
            split, gain = find_split(samples, members, growth, logarithms)
            if gain > 0:
                middle = first + partition(samples, members, split)
            if min(middle - first, last - middle) >= growth.leaf_samples:
                splits[node], left[node] = split, nodes
                waiting[pending] = nodes + 1, middle, last, level + 1
                waiting[pending + 1] = nodes, first, middle, level + 1
                pending += 2
                nodes += 2
                continue
        left[node] = -1 - leaf
        for member in members:
            leaves[leaf, samples.part[member]] += np.float32(1.0 / max(last - first, 1))
        leaf += 1
    return PartTree(splits[:nodes].copy(), left[:nodes].copy(), leaves[:leaf].copy())


@kernel
def n_log_n(count: int) -> NDArray[np.float64]:
    """Return n log2 n for n = 0 to `count`, with 0 log2 0 = 0."""
    values = np.zeros(count + 1)
    for n in range(2, count + 1):
        values[n] = n * np.log2(n)
    return values


@kernel
def find_split(
    samples: PartSamples,
    members: NDArray[np.int64],
    growth: PartGrowth,
    logarithms: NDArray[np.float64],
) -> tuple[NDArray[np.float32], float]:
    """Return the best of random splits: offsets and threshold, and its gain in bits.

    The gain is |S| H(S) - |S_l| H(S_l) - |S_r| H(S_r) with the entropy H of the classes.

    Args:
        samples: all samples.
        members: the samples of the node.
        growth: the settings.
        logarithms: of `n_log_n`.
    """
    chosen = draw_subset(members, growth.subset)
    cells = cells_of(samples, chosen)
    parts = samples.part[chosen]
    values = np.empty(chosen.shape[0], np.float32)
    counts = np.zeros((growth.thresholds + 1, CLASSES), np.int64)
    total = np.zeros(CLASSES, np.int64)
    for part in parts:
        total[part] += 1
    before = entropy_times_count(total, logarithms)
    best, best_gain = np.zeros(5, np.float32), LEAST_GAIN
    split = np.zeros(5, np.float32)
    thresholds = np.empty(growth.thresholds, np.float32)
    for _ in range(growth.features):
        draw_offsets(split, growth.reach)
        compare_cells(samples.depth, cells, split, values)
        draw_thresholds(values, thresholds)
        count_classes(parts, values, thresholds, counts)
        for t in range(growth.thresholds):
            if t > 0:
                counts[t] += counts[t - 1]
            if t + 1 < growth.thresholds and thresholds[t] == thresholds[t + 1]:
                continue
            after = entropy_of_both(counts[t], total, logarithms)
            if before - after > best_gain:
                best[:] = split
                best[4] = thresholds[t]
                best_gain = before - after
    return best, best_gain if best_gain > LEAST_GAIN else 0.0


@kernel
def cells_of(samples: PartSamples, members: NDArray[np.int64]) -> Cells:
    """Return the cells of some samples."""
    n = members.shape[0]
    first, rows, columns = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n, np.int64)
    row, column, z = np.empty(n, np.float32), np.empty(n, np.float32), np.empty(n, np.float32)
    across, down = np.empty_like(z), np.empty_like(z)
    for k in range(n):
        member = members[k]
        image = samples.image[member]
        first[k] = samples.start[image]
        rows[k], columns[k] = samples.shape[image, 0], samples.shape[image, 1]
        cell = first[k] + samples.row[member] * columns[k] + samples.column[member]
        z[k] = np.float32(samples.depth[cell]) * np.float32(0.001)
        row[k] = np.float32(samples.row[member]) + np.float32(0.5)
        column[k] = np.float32(samples.column[member]) + np.float32(0.5)
        across[k] = samples.focal_lengths[image, 0] / z[k]
        down[k] = samples.focal_lengths[image, 1] / z[k]
    return Cells(first, rows, columns, row, column, across, down, z)


@kernel
def count_classes(
    parts: NDArray[np.uint8],
    values: NDArray[np.float32],
    thresholds: NDArray[np.float32],
    counts: NDArray[np.int64],
) -> None:
    """Count the classes of the values between successive thresholds, into `counts`.

    Args:
        parts: the class of each cell, shape (n,).
        values: their depth comparisons, shape (n,).
        thresholds: ascending, shape (t,).
        counts: row k counts the values below threshold k that are in no earlier row; the last
            row has the rest. Shape (t + 1, CLASSES).
    """
    counts[:] = 0
    for n in range(parts.shape[0]):
        row = 0
        for t in range(thresholds.shape[0]):
            row += values[n] >= thresholds[t]
        counts[row, parts[n]] += 1


@kernel
def entropy_times_count(counts: NDArray[np.int64], logarithms: NDArray[np.float64]) -> float:
    """Return |S| H(S) = |S| log2 |S| - sum_c n_c log2 n_c of the counts n_c, bits."""
    total, summed = 0, 0.0
    for count in counts:
        total += count
        summed += logarithms[count]
    entropy: float = logarithms[total] - summed
    return entropy


@kernel
def entropy_of_both(
    counts: NDArray[np.int64], total: NDArray[np.int64], logarithms: NDArray[np.float64]
) -> float:
    """Return |S| H(S) of the counts, plus that of the rest of the total, bits."""
    here, rest, summed = 0, 0, 0.0
    for c in range(counts.shape[0]):
        here += counts[c]
        rest += total[c] - counts[c]
        summed += logarithms[counts[c]] + logarithms[total[c] - counts[c]]
    entropy: float = logarithms[here] + logarithms[rest] - summed
    return entropy


@kernel
def partition(samples: PartSamples, members: NDArray[np.int64], split: NDArray[np.float32]) -> int:
    """Move the members that go left to the front, in place; return their number."""
    values = np.empty(members.shape[0], np.float32)
    compare_cells(samples.depth, cells_of(samples, members), split, values)
    return move_below(members, values, split[4])
