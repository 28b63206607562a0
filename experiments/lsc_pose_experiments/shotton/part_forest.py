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


"""The forest of Shotton et al. that classifies the cells of a depth grid into body parts.

J. Shotton et al., "Real-time human pose recognition in parts from single depth images", CVPR
2011. Each split compares two depths (eq. 1): f(I, x) = d(x + u / d(x)) - d(x + v / d(x)); each
leaf has a distribution over the classes, and that of the forest is the mean of its trees' (eq. 2).
There, the background is removed beforehand. Here what is not a
person is a class of its own.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.depth_comparisons import depth_at
from lsc_pose_ros.body_parts.classes import NOT_A_PERSON
from lsc_pose_ros.body_parts.depth_grid import DepthGrid
from lsc_pose_ros.numerics.jit import kernel

SURE = np.float32(0.8)
"""If the first trees say "no person" with this probability, the others are not asked."""

_FULL = np.float32(1.0 / 255.0)


class PartForest(NamedTuple):
    """T trees, all nodes in one table.

    Attributes:
        roots: the first node of each tree, shape (T,), int32.
        splits: u right, u down, v right, v down in metres, and the threshold in metres,
            shape (n, 5), float32. A cell with f below the threshold goes left.
        left: the left child of each node; the right child follows it. A leaf has -1 - its row in
            `leaves`. Shape (n,), int32.
        leaves: the probability of each class at each leaf times 255, shape (L, CLASSES), uint8.
    """

    roots: NDArray[np.int32]
    splits: NDArray[np.float32]
    left: NDArray[np.int32]
    leaves: NDArray[np.uint8]


def classify(
    grid: DepthGrid, forest: PartForest, stride: int, farthest: float
) -> NDArray[np.float32]:
    """Return the probability of each class at every `stride`-th cell of a grid.

    Args:
        grid: the depth grid.
        forest: the forest.
        stride: how many cells apart the classified ones are, along rows and columns.
        farthest: cells at a larger depth are not classified, metres.

    Returns:
        The probabilities, the means of the trees', shape (ceil(h / stride), ceil(w / stride),
        CLASSES); all 0 at a cell without depth, or farther than `farthest`.
    """
    depth = grid.depth[::stride, ::stride]
    wanted = (depth > 0) & (depth <= farthest)
    probabilities = np.zeros((*depth.shape, forest.leaves.shape[1]), np.float32)
    classify_cells(grid.depth, grid.focal_lengths, forest, stride, wanted, probabilities)
    return probabilities


@kernel
def classify_cells(
    depth: NDArray[np.float32],
    focal_lengths: tuple[float, float],
    forest: PartForest,
    stride: int,
    wanted: NDArray[np.bool_],
    probabilities: NDArray[np.float32],
) -> None:
    """Classify some cells: the equation of `classify`.

    Args:
        depth: of the grid, 0 if unknown, shape (h, w).
        focal_lengths: of the grid.
        forest: the forest.
        stride: how many cells of the grid apart two cells of `wanted` are.
        wanted: the cells to classify, shape (h, w).
        probabilities: shape (h, w, CLASSES); those of the wanted cells are set. They are 0 before.
    """
    rows, columns = wanted.shape
    for tree in range(forest.roots.shape[0]):  # tree by tree: the nodes of one fit into the cache
        root = forest.roots[tree]
        share = np.float32(1.0 / (tree + 1))
        for i in range(rows):
            for j in range(columns):
                here = probabilities[i, j]
                if not wanted[i, j] or (tree > 0 and here[NOT_A_PERSON] >= SURE):
                    continue
                leaf = find_leaf(depth, focal_lengths, i * stride, j * stride, forest, root)
                for c in range(here.shape[0]):
                    here[c] += share * (_FULL * np.float32(forest.leaves[leaf, c]) - here[c])


@kernel
def find_leaf(
    depth: NDArray[np.float32],
    focal_lengths: tuple[float, float],
    row: int,
    column: int,
    forest: PartForest,
    root: int,
) -> int:
    """Return the leaf that a cell reaches in one tree: a row of `forest.leaves`."""
    z = depth[row, column]
    across, down = np.float32(focal_lengths[0]) / z, np.float32(focal_lengths[1]) / z
    splits = forest.splits
    node = root
    left: int = forest.left[node]
    while left >= 0:
        right_by, down_by = splits[node, 0] * across, splits[node, 1] * down
        value = probe(depth, row, column, down_by, right_by)
        right_by, down_by = splits[node, 2] * across, splits[node, 3] * down
        value -= probe(depth, row, column, down_by, right_by)
        node = left + (value >= splits[node, 4])
        left = forest.left[node]
    return -1 - left


@kernel
def probe(
    depth: NDArray[np.float32], row: int, column: int, down: np.float32, across: np.float32
) -> np.float32:
    """Return the depth at an offset from a cell, BEYOND if it is unknown or outside."""
    at_row, at_column = np.float32(row) + down + np.float32(0.5), np.float32(column) + across
    return depth_at(depth, at_row, at_column + np.float32(0.5))
