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

"""The assignment of least cost, against all assignments and against scipy."""

import tracemalloc

import numpy as np
import pytest

from lsc_pose_ros.tracking.assignment import assign


def least_cost(costs: np.ndarray, unassigned: float) -> float:
    """Return the least cost of all assignments: each row has a free column, or none."""

    def rest(row: int, used: frozenset[int]) -> float:
        if row == len(costs):
            return 0.0
        best = unassigned + rest(row + 1, used)
        for column in set(range(costs.shape[1])) - used:
            best = min(best, costs[row, column] + rest(row + 1, used | {column}))
        return best

    return rest(0, frozenset())


@pytest.mark.parametrize('seed', range(200))
def test_no_other_assignment_costs_less(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shape = tuple(rng.integers(0, 6, 2))
    # Whole numbers have many ties.
    costs = rng.uniform(-5, 10, shape) if seed % 2 else rng.integers(0, 4, shape).astype(float)
    costs[rng.random(shape) < 0.2] = np.inf
    unassigned = float(rng.uniform(1, 8))
    pairs = assign(costs, unassigned)
    rows, columns = zip(*pairs, strict=True) if pairs else ((), ())
    assert list(rows) == sorted(set(rows))
    assert len(set(columns)) == len(columns)
    found = sum(costs[pair] for pair in pairs) + unassigned * (shape[0] - len(pairs))
    assert found == pytest.approx(least_cost(costs, unassigned))
    assert all(costs[pair] < unassigned for pair in pairs)


@pytest.mark.parametrize('shape', [(40, 50), (50, 40), (30, 30)])
def test_many_things_are_assigned_as_by_scipy(shape: tuple[int, int]) -> None:
    optimize = pytest.importorskip('scipy.optimize', reason='SciPy is not installed')
    costs = np.random.default_rng(sum(shape)).normal(size=shape)
    rows, columns = optimize.linear_sum_assignment(costs)
    assert assign(costs, 1e6) == list(zip(rows.tolist(), columns.tolist(), strict=True))


@pytest.mark.parametrize('cost', [np.nan, -np.inf])
def test_costs_that_are_no_numbers_are_refused(cost: float) -> None:
    with pytest.raises(ValueError, match='not a number'):
        assign(np.array([[1.0, cost]]), 2.0)


@pytest.mark.parametrize('shape', [(20_000, 3), (3, 20_000), (20_000, 0)])
def test_thousands_of_things_for_a_few_take_no_square_of_memory(shape: tuple[int, int]) -> None:
    costs = np.random.default_rng(5).uniform(0, 10, shape)
    tracemalloc.start()
    try:
        pairs = assign(costs, 20.0)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert len(pairs) == min(shape)
    assert peak < 20 * costs.nbytes + (1 << 20)
