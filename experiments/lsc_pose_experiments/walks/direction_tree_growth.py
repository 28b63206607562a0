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

"""Growth of the tree of directions of one joint."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.depth_comparisons import (
    compare_cells,
    draw_offsets,
    draw_subset,
    draw_thresholds,
    move_below,
)
from lsc_pose_experiments.walks.direction_clusters import cluster_directions
from lsc_pose_experiments.walks.direction_samples import BodyGrids, DirectionSamples, cells_of
from lsc_pose_ros.numerics.jit import kernel

LEAST_GAIN = 1e-3
"""A smaller gain is a rounding error."""


class DirectionGrowth(NamedTuple):
    """The settings of a tree.

    Attributes:
        depth: the largest number of splits above a leaf.
        leaf_samples: the fewest samples of a leaf.
        features: number of random pairs of offsets that are tried at a node.
        thresholds: number of thresholds that are tried for each of them.
        subset: at a node with more samples, a random subset of this size chooses the split.
        reach: the largest offset, metres.
        clusters: K, number of directions of a leaf.
    """

    depth: int = 24
    leaf_samples: int = 10
    features: int = 40
    thresholds: int = 10
    subset: int = 1000
    reach: float = 1.0
    clusters: int = 8


class DirectionTree(NamedTuple):
    """The tree of one joint; the root is node 0. Attributes as in DirectionTrees."""

    splits: NDArray[np.float32]
    left: NDArray[np.int32]
    directions: NDArray[np.float32]
    cumulative: NDArray[np.float32]


@kernel
def grow_direction_tree(
    grids: BodyGrids, samples: DirectionSamples, growth: DirectionGrowth, seed: int
) -> DirectionTree:
    """Grow a tree by splits after which the directions vary least.

    Args:
        grids: the bodies.
        samples: at least one point around the joint.
        growth: the settings.
        seed: of the random numbers of the calling thread.
    """
    np.random.seed(seed)  # noqa: NPY002 - numba has no generators
    count = samples.grid.shape[0]
    order = np.arange(count)
    most = 2 * (count // growth.leaf_samples) + 1
    splits, left = np.zeros((most, 5), np.float32), np.zeros(most, np.int32)
    directions = np.zeros((most // 2 + 1, growth.clusters, 3), np.float32)
    cumulative = np.zeros((most // 2 + 1, growth.clusters), np.float32)
    # Nodes that wait for their split: node, first and last member, depth.
    waiting = np.zeros((growth.depth + 2, 4), np.int64)
    waiting[0, 2] = count
    pending, nodes, leaf = 1, 1, 0
    while pending > 0:
        pending -= 1
        node, first, last, level = waiting[pending]
        members = order[first:last]
        if level < growth.depth and last - first >= 2 * growth.leaf_samples:
            split, gain = find_split(grids, samples, members, growth)
            middle = first
            if gain > 0:
                middle = first + partition(grids, samples, members, split)
            if min(middle - first, last - middle) >= growth.leaf_samples:
                splits[node], left[node] = split, nodes
                waiting[pending] = nodes + 1, middle, last, level + 1
                waiting[pending + 1] = nodes, first, middle, level + 1
                pending += 2
                nodes += 2
                continue
        left[node] = -1 - leaf
        cluster_directions(samples.direction[members], directions[leaf], cumulative[leaf])
        leaf += 1
    return DirectionTree(
        splits[:nodes].copy(), left[:nodes].copy(), directions[:leaf].copy(),
        cumulative[:leaf].copy(),
    )  # fmt: skip


@kernel
def find_split(
    grids: BodyGrids,
    samples: DirectionSamples,
    members: NDArray[np.int64],
    growth: DirectionGrowth,
) -> tuple[NDArray[np.float32], float]:
    """Return the best of random splits: offsets and threshold, and its gain.

    The gain is by how much the sum of squared distances of the directions to their mean becomes
    smaller. For unit vectors this sum is n - |s|^2 / n, where s is the sum of the n vectors, so
    the gain is |s_l|^2 / n_l + |s_r|^2 / n_r - |s|^2 / n. A split is not tried if too few samples
    for a leaf, in proportion to the random subset, are on one side.

    Args:
        grids: the bodies.
        samples: all samples.
        members: the samples of the node.
        growth: the settings.
    """
    chosen = draw_subset(members, growth.subset)
    cells, directions = cells_of(grids, samples, chosen), samples.direction[chosen]
    values = np.empty(chosen.shape[0], np.float32)
    sums = np.zeros((growth.thresholds + 1, 4))
    total = np.zeros(4)
    for n in range(chosen.shape[0]):
        total[:3] += directions[n]
    total[3] = chosen.shape[0]
    before = squared_length_per_count(total)
    fewest = growth.leaf_samples * chosen.shape[0] / members.shape[0]
    best, best_gain = np.zeros(5, np.float32), LEAST_GAIN
    split = np.zeros(5, np.float32)
    thresholds = np.empty(growth.thresholds, np.float32)
    for _ in range(growth.features):
        draw_offsets(split, growth.reach)
        compare_cells(grids.depth, cells, split, values)
        draw_thresholds(values, thresholds)
        sum_directions(directions, values, thresholds, sums)
        for t in range(growth.thresholds):
            if t > 0:
                sums[t] += sums[t - 1]
            if min(sums[t, 3], total[3] - sums[t, 3]) < fewest:
                continue
            after = squared_length_per_count(sums[t])
            after += squared_length_per_count(total - sums[t])
            if after - before > best_gain:
                best[:] = split
                best[4] = thresholds[t]
                best_gain = after - before
    return best, best_gain if best_gain > LEAST_GAIN else 0.0


@kernel
def sum_directions(
    directions: NDArray[np.float32],
    values: NDArray[np.float32],
    thresholds: NDArray[np.float32],
    sums: NDArray[np.float64],
) -> None:
    """Sum the directions of the values between successive thresholds, into `sums`.

    Args:
        directions: of each sample, shape (n, 3).
        values: the depth comparison of each sample, shape (n,).
        thresholds: ascending, shape (t,).
        sums: row k receives the sum of the directions, and their number, of the values below
            threshold k that are in no earlier row; the last row has the rest. Shape (t + 1, 4).
    """
    sums[:] = 0
    for n in range(values.shape[0]):
        row = 0
        for t in range(thresholds.shape[0]):
            row += values[n] >= thresholds[t]
        for axis in range(3):
            sums[row, axis] += directions[n, axis]
        sums[row, 3] += 1


@kernel
def squared_length_per_count(total: NDArray[np.float64]) -> float:
    """Return |s|^2 / n of a sum s and a number n, shape (4,); 0 for no vectors."""
    if total[3] <= 0:
        return 0.0
    squared: float = (total[0] ** 2 + total[1] ** 2 + total[2] ** 2) / total[3]
    return squared


@kernel
def partition(
    grids: BodyGrids,
    samples: DirectionSamples,
    members: NDArray[np.int64],
    split: NDArray[np.float32],
) -> int:
    """Move the members that go left to the front, in place; return their number."""
    values = np.empty(members.shape[0], np.float32)
    compare_cells(grids.depth, cells_of(grids, samples, members), split, values)
    return move_below(members, values, split[4])
