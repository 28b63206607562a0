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

"""Depth comparisons (Shotton et al., eq. 1) at many points, for the growth of trees.

f(I, x) = d(x + u / d(x)) - d(x + v / d(x)): two depths at offsets from a point that are given in
metres, and so are fewer pixels if the point is farther away.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel

BEYOND = np.float32(10.0)
"""The depth of a cell that is unknown or outside of the image, metres."""

HALF_MILLIMETRE = np.float32(0.0005)
"""Depths are whole millimetres, so no comparison is equal to a threshold between two of them."""

_SMALLEST_OFFSET = 0.02  # metres


class Cells(NamedTuple):
    """The positions of n samples in their depth grids, for the many comparisons at a node.

    Attributes:
        first: index of the first cell of each sample's grid in the depths of all grids.
        rows, columns: the shape of the grid.
        row, column: the position of the sample from the upper left corner of the grid, in cells.
        across, down: cells per metre along a row and a column, at the depth of the sample.
        z: the depth of the sample, metres.
    """

    first: NDArray[np.int64]
    rows: NDArray[np.int64]
    columns: NDArray[np.int64]
    row: NDArray[np.float32]
    column: NDArray[np.float32]
    across: NDArray[np.float32]
    down: NDArray[np.float32]
    z: NDArray[np.float32]


@kernel
def compare_cells(
    depth: NDArray[np.uint16],
    cells: Cells,
    split: NDArray[np.float32],
    values: NDArray[np.float32],
) -> None:
    """Compute the depth comparison of each sample (eq. 1) into `values`.

    The depth of the sample itself takes the place of the second depth if the second offset is 0.
    """
    u_across, u_down, v_across, v_down = split[0], split[1], split[2], split[3]
    alone = v_across == 0 and v_down == 0
    for k in range(values.shape[0]):
        first, rows, columns = cells.first[k], cells.rows[k], cells.columns[k]
        row = cells.row[k] + u_down * cells.down[k]
        column = cells.column[k] + u_across * cells.across[k]
        value = BEYOND
        if 0 <= row < rows and 0 <= column < columns:
            found = depth[first + int(row) * columns + int(column)]
            value = np.float32(found) * np.float32(0.001) if found > 0 else BEYOND
        if alone:
            other = cells.z[k]
        else:
            row = cells.row[k] + v_down * cells.down[k]
            column = cells.column[k] + v_across * cells.across[k]
            other = BEYOND
            if 0 <= row < rows and 0 <= column < columns:
                found = depth[first + int(row) * columns + int(column)]
                other = np.float32(found) * np.float32(0.001) if found > 0 else BEYOND
        values[k] = value - other


@kernel
def depth_at(depth: NDArray[np.float32], row: np.float32, column: np.float32) -> np.float32:
    """Return the depth of the cell at a position, BEYOND if it is unknown or outside.

    Args:
        depth: metres, 0 if unknown, shape (h, w).
        row: from the upper edge of the first cell, in cells.
        column: from the left edge of the first cell, in cells.
    """
    # Compared before conversion: a large position does not fit into an integer.
    if not (0 <= row < depth.shape[0] and 0 <= column < depth.shape[1]):
        return BEYOND
    found = depth[int(row), int(column)]
    return found if found > 0 else BEYOND


@kernel
def draw_subset(members: NDArray[np.int64], size: int) -> NDArray[np.int64]:
    """Return up to `size` of `members`, drawn at random with replacement if there are more."""
    if members.shape[0] <= size:
        return members
    chosen = np.empty(size, np.int64)
    for n in range(size):
        chosen[n] = members[np.random.randint(members.shape[0])]  # noqa: NPY002
    chosen.sort()  # the images of successive samples are the same, and in the cache
    return chosen


@kernel
def draw_offsets(split: NDArray[np.float32], reach: float) -> None:
    """Draw two offsets; the second is 0 in 40 % of all cases.

    Their directions are uniform. Their lengths are log-uniform: small ones find the outlines of
    a part, large ones the rest of the body and its surroundings.
    """
    for k in range(2):
        angle = 2.0 * math.pi * np.random.random()  # noqa: NPY002
        fraction = np.random.random()  # noqa: NPY002
        length = _SMALLEST_OFFSET * math.pow(reach / _SMALLEST_OFFSET, fraction)
        split[2 * k], split[2 * k + 1] = length * math.cos(angle), length * math.sin(angle)
    if np.random.random() < 0.4:  # noqa: NPY002
        split[2] = split[3] = np.float32(0)


@kernel
def draw_thresholds(values: NDArray[np.float32], thresholds: NDArray[np.float32]) -> None:
    """Draw thresholds just below random ones of the values, ascending.

    Args:
        values: depth comparisons, shape (n,), n > 0.
        thresholds: receives the thresholds, shape (t,).
    """
    for t in range(thresholds.shape[0]):
        drawn = values[np.random.randint(values.shape[0])]  # noqa: NPY002
        thresholds[t] = drawn - HALF_MILLIMETRE
    thresholds.sort()


@kernel
def move_below(
    members: NDArray[np.int64], values: NDArray[np.float32], threshold: np.float32
) -> int:
    """Move the members with values below a threshold to the front; return their number.

    Args:
        members: changed in place; both groups keep their order, shape (n,).
        values: of the members, shape (n,).
        threshold: the smallest value of the second group.
    """
    above = np.empty_like(members)
    low, high = 0, 0
    for n in range(members.shape[0]):
        member = members[n]
        if values[n] < threshold:
            members[low] = member
            low += 1
        else:
            above[high] = member
            high += 1
    members[low:] = above[:high]
    return low


class JoinedNodes(NamedTuple):
    """Where the nodes of several trees are in one table.

    Attributes:
        roots: the first node of each tree, shape (T,).
        left: the left child of each node, or -1 - its leaf, shape (n,).
    """

    roots: NDArray[np.int32]
    left: NDArray[np.int32]


def join_nodes(lefts: Sequence[NDArray[np.int32]]) -> JoinedNodes:
    """Return the nodes of all trees, with nodes and leaves renumbered consecutively.

    Args:
        lefts: for each tree, the left child of each node, or -1 - its leaf, shape (nodes,).
    """
    nodes = np.cumsum([0, *(len(left) for left in lefts)])
    leaves = np.cumsum([0, *((left < 0).sum() for left in lefts)])
    joined = [
        np.where(left >= 0, left + nodes[t], left - leaves[t]) for t, left in enumerate(lefts)
    ]
    return JoinedNodes(nodes[:-1].astype(np.int32), np.concatenate(joined).astype(np.int32))
