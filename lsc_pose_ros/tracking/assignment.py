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

"""Which of several things each of others is, so that the sum of the costs is least.

The assignment problem is solved exactly by shortest augmenting paths with potentials: H. W. Kuhn,
"The Hungarian method for the assignment problem", 1955; J. Munkres, 1957; in the form of R. Jonker
and A. Volgenant, 1987. A frame has some tens of people, so plain Python is fast enough.
"""

import numpy as np
from numpy.typing import NDArray


def assign(costs: NDArray[np.float64], unassigned: float) -> list[tuple[int, int]]:
    """Return the pairs of rows and columns whose sum of costs is least, ascending by row.

    A row and a column that are not paired cost `unassigned` together, so no pair costs more.

    Args:
        costs: of each pair, infinity for pairs that are impossible, shape (R, C).
        unassigned: the cost of a row and a column without a partner.

    Raises:
        ValueError: a cost is not a number, or is minus infinity.
    """
    if np.isnan(costs).any() or np.isneginf(costs).any():
        msg = 'a cost is not a number'
        raise ValueError(msg)
    rows, columns = costs.shape
    if rows > columns:
        # The time grows with the square of the rows.
        return sorted((row, column) for column, row in assign(costs.T, unassigned))
    # Each row may have a partner that stands for none.
    square = np.full((rows, columns + rows), float(unassigned))
    square[:, :columns] = np.minimum(costs, unassigned)
    pairs = enumerate(_assign_rows(square))
    return [(row, k) for row, k in pairs if k < columns and costs[row, k] < unassigned]


def _assign_rows(costs: NDArray[np.float64]) -> list[int]:
    """Return the column of each row, shape (R,); costs are finite, shape (R, C) with R <= C."""
    rows, columns = costs.shape
    u, v = np.zeros(rows), np.zeros(columns)  # the potentials of rows and columns
    row_of = np.full(columns, -1)
    for row in range(rows):
        _augment(costs, row, (u, v), row_of)
    return [int(np.flatnonzero(row_of == row)[0]) for row in range(rows)]


def _augment(
    costs: NDArray[np.float64],
    start: int,
    potentials: tuple[NDArray[np.float64], NDArray[np.float64]],
    row_of: NDArray[np.int64],
) -> None:
    """Assign one more row, along the shortest path to a free column (Dijkstra).

    Args:
        costs: shape (R, C).
        start: the row.
        potentials: of rows and columns; updated.
        row_of: the row of each column, -1 for none; updated.
    """
    u, v = potentials
    columns = costs.shape[1]
    distance, before = np.full(columns, np.inf), np.full(columns, -1)
    visited = np.zeros(columns, bool)
    row, last, length = start, -1, 0.0
    while True:
        reached = length + costs[row] - u[row] - v
        shorter = ~visited & (reached < distance)
        distance[shorter], before[shorter] = reached[shorter], last
        last = int(np.argmin(np.where(visited, np.inf, distance)))
        length = float(distance[last])
        if row_of[last] < 0:
            break
        visited[last] = True
        row = int(row_of[last])
    u[start] += length
    u[row_of[visited]] += length - distance[visited]
    v[visited] -= length - distance[visited]
    while last >= 0:
        previous = int(before[last])
        row_of[last] = start if previous < 0 else row_of[previous]
        last = previous
