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


"""People told apart on a grid of cells, compared with plain numpy."""

import itertools

import numpy as np
import pytest

from lsc_pose_ros.body_parts.part_network import CellParts
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.segmentation import cell_labels, person_instances
from lsc_pose_ros.segmentation.cell_labels import labels_from_cells
from lsc_pose_ros.segmentation.person_cells import PersonCells, person_cells
from lsc_pose_ros.segmentation.person_instances import (
    find_bodies,
    find_middles,
    heaviest_voxel,
    least_person,
    measure_bodies,
    nearest_middles,
)

CAMERA = (60.0, 62.0, 30.0, 22.0)  # fx, fy, cx, cy in cells


def random_scene(seed: int) -> CellParts:
    """Return cells of several surfaces, some of them not classified."""
    rng = np.random.default_rng(seed)
    depth = rng.choice([1.5, 1.58, 2.0, 2.6], (14, 18)).astype(np.float32)
    person = rng.random((14, 18)).astype(np.float32)
    unknown = rng.random(depth.shape) < 0.15
    depth[unknown], person[unknown] = 0, 0
    return CellParts(depth, person, rng.normal(0, 0.4, (14, 18, 3)).astype(np.float32))


def cells_of(parts: CellParts, threshold: float = 0.4) -> PersonCells:
    return person_cells(parts, CAMERA, threshold)


@pytest.mark.parametrize('seed', range(3))
def test_cells_of_people_vote_for_their_middle(seed: int) -> None:
    parts = random_scene(seed)
    cells = person_cells(parts, CAMERA, 0.4)
    chosen = np.argwhere(parts.person >= np.float32(0.4))
    assert len(chosen) == len(cells.area) > 10
    fx, fy, cx, cy = CAMERA
    for n, (i, j) in enumerate(chosen):
        z = float(parts.depth[i, j])
        across, down, away = parts.to_middle[i, j].astype(float)
        # The pixel and the depth of the middle, projected back.
        row, column, middle = i + down * fy / z, j + across * fx / z, max(z + away, 0.1)
        expected = [(column - cx) / fx * middle, (row - cy) / fy * middle, middle]
        np.testing.assert_allclose(cells.vote[n], expected, rtol=1e-4, atol=1e-4)
        assert cells.number[i, j] == n
        assert cells.person[n] == parts.person[i, j]
        assert cells.area[n] == pytest.approx(z * z / fx / fy, rel=1e-5)
    assert (cells.number >= 0).sum() == len(chosen)


@pytest.mark.parametrize('seed', range(4))
def test_the_heaviest_cube_is_that_of_the_largest_sum(seed: int) -> None:
    rng = np.random.default_rng(seed)
    voxel = rng.integers(-3, 5, (80, 3))
    weight = (rng.random(80) * (rng.random(80) < 0.7)).astype(np.float32)
    around = (abs(voxel[:, None] - voxel[None]) <= 1).all(axis=-1)
    sums = {}
    for center in itertools.product(range(-4, 6), repeat=3):
        near = (abs(voxel - center) <= 1).all(axis=1)
        sums[center] = float(weight[near].sum())
    found, best = heaviest_voxel(voxel, weight)
    assert best == pytest.approx(max(sums.values()), rel=1e-5)
    assert sums[tuple(found)] == pytest.approx(best, rel=1e-5)
    assert best >= (around * weight).sum(axis=1).max() * (1 - 1e-5)
    nothing, none = heaviest_voxel(voxel, np.zeros(80, np.float32))
    assert none == 0
    assert (nothing == 0).all()


@pytest.mark.parametrize('seed', range(3))
def test_each_cell_belongs_to_the_nearest_middle(seed: int) -> None:
    cells = cells_of(random_scene(seed))
    middles = np.random.default_rng(seed).uniform(-1, 2.5, (5, 3))
    body = nearest_middles(cells, middles)
    apart = np.linalg.norm(cells.vote[:, None] - middles[None], axis=-1)
    nearest = apart.argmin(axis=1)
    reached = apart.min(axis=1) < person_instances.REACH
    np.testing.assert_array_equal(body, np.where(reached, nearest, -1))
    area, person = measure_bodies(cells, body, 5)
    for b in range(5):
        assert area[b] == pytest.approx(cells.area[body == b].sum(), rel=1e-4)
        total = (cells.area * cells.person)[body == b].sum()
        assert person[b] == pytest.approx(total / max(area[b], 1e-9), rel=1e-4)


def test_middles_are_where_votes_meet_and_apart() -> None:
    rng = np.random.default_rng(0)
    places = np.array([[0, 0, 2], [1, 0, 2.5], [0.1, 0.1, 3.5]])
    vote = np.concatenate([each + rng.normal(0, 0.05, (60, 3)) for each in places])
    number = np.full((1, 1), -1, np.int32)
    cells = PersonCells(
        number, vote.astype(np.float32), np.full(180, 0.002, np.float32), np.ones(180, np.float32)
    )
    middles = find_middles(cells)
    assert len(middles) == 3
    apart = np.linalg.norm(middles[:, None] - places[None], axis=-1)
    assert sorted(apart.argmin(axis=1)) == [0, 1, 2]
    # Each is the mean of the votes around it: four standard errors per axis.
    assert apart.min(axis=1).max() < 4 * 0.05 / np.sqrt(60) * np.sqrt(3)


def paint(people: list[tuple[int, float]], *, arm: bool = False) -> CellParts:
    """Return people with exact votes: the column of their middle, and their depth."""
    depth = np.full((45, 60), 4.0, np.float32)
    owner = np.full((45, 60), -1)
    for number, (column, z) in enumerate(people):
        for rows, half in ((slice(6, 10), 2), (slice(10, 40), 5)):
            depth[rows, column - half : column + half] = z
            owner[rows, column - half : column + half] = number
        if arm:
            depth[14:22, column - 2 : column + 1] = z - 0.5
    to_middle = np.zeros((45, 60, 3), np.float32)
    rows, columns = np.mgrid[:45, :60]
    for number in range(len(people)):
        mine = owner == number
        z = depth[mine]
        to_middle[mine, 0] = (columns[mine].mean() - columns[mine]) * z / CAMERA[0]
        to_middle[mine, 1] = (rows[mine].mean() - rows[mine]) * z / CAMERA[1]
        to_middle[mine, 2] = z.mean() - z
    return CellParts(depth, (owner >= 0).astype(np.float32), to_middle)


def bodies_in(parts: CellParts) -> np.ndarray:
    cells = cells_of(parts, 0.5)
    return np.append(find_bodies(cells).body, -1)[cells.number]


def test_two_people_side_by_side_are_two() -> None:
    body = bodies_in(paint([(20, 2.5), (30, 2.5)]))
    assert body.max() == 1
    assert (body[11:39, 15:25] == body[8, 20]).all()
    assert (body[11:39, 26:34] == body[8, 30]).all()
    assert body[8, 20] != body[8, 30]


def test_an_arm_before_the_trunk_belongs_to_it() -> None:
    body = bodies_in(paint([(20, 2.0)], arm=True))
    assert body.max() == 0
    assert (body[14:22, 18:21] == 0).all()


def test_legs_below_a_counter_belong_to_the_trunk_above_it() -> None:
    parts = paint([(20, 2.0)])
    parts.depth[20:28] = 1.5
    parts.person[20:28] = 0
    body = bodies_in(parts)
    assert body.max() == 0
    assert (body[30:39, 16:24] == 0).all()
    assert (body[21:27] == -1).all()


def test_a_person_behind_another_is_another() -> None:
    body = bodies_in(paint([(22, 3.4), (30, 2.0)]))
    assert body.max() == 1
    assert body[8, 22] >= 0
    assert body[8, 22] != body[8, 30]


def test_a_few_cells_of_a_limb_are_no_body() -> None:
    parts = paint([(20, 2.5)])
    parts.depth[20:24, 45:48] = 2.5
    parts.person[20:24, 45:48] = 1
    body = bodies_in(parts)
    assert body.max() == 0
    assert (body[20:24, 45:48] == -1).all()


def test_small_and_far_bodies_need_more_certainty() -> None:
    assert least_person(0.3, 2.0) == least_person(0.3, 4.0)
    assert least_person(0.1, 2.0) > least_person(0.3, 2.0)
    assert least_person(0.3, 5.0) > least_person(0.3, 4.0)
    parts = paint([(20, 2.5)])
    shown = parts.person > 0
    parts.person[shown] = least_person(0.3, 2.5) - 0.01
    assert bodies_in(parts).max() == -1
    parts.person[shown] += 0.02
    assert bodies_in(parts).max() == 0


def test_no_cells_are_no_bodies() -> None:
    parts = paint([])
    assert (bodies_in(parts) == -1).all()
    nothing = parts._replace(depth=np.zeros_like(parts.depth), person=np.zeros_like(parts.person))
    assert (bodies_in(nothing) == -1).all()


@pytest.mark.parametrize(('spacing', 'offset'), [(1, 0), (2, 0), (4, 1), (8, 2)])
def test_pixels_have_the_label_of_the_cell_at_their_depth(spacing: int, offset: int) -> None:
    rng = np.random.default_rng(spacing)
    cell_depth = rng.choice([0, 1.5, 1.53, 2.0, 2.4], (7, 9)).astype(np.float32)
    cells = rng.integers(-1, 3, (7, 9)).astype(np.int32)
    depth = rng.choice([0, np.nan, np.inf, 1.49, 1.52, 2.03, 3.0], (26, 37)).astype(np.float32)
    labels = labels_from_cells(depth, cells, cell_depth, spacing, offset)
    for row, column in np.ndindex(depth.shape):
        z = depth[row, column]
        i = min((max(row - offset, 0) + spacing // 2) // spacing, 6)
        j = min((max(column - offset, 0) + spacing // 2) // spacing, 8)
        found = [(cell_labels.STEP + cell_labels.SLOPE * float(z), NO_BODY)]
        for k, m in itertools.product(range(max(i - 1, 0), i + 2), range(max(j - 1, 0), j + 2)):
            if k > 6 or m > 8 or cell_depth[k, m] == 0 or not 0 < z < np.inf:
                continue
            difference = abs(float(cell_depth[k, m]) - float(z)) + cell_labels.ASIDE * (
                (k, m) != (i, j)
            )
            found.append((difference, int(cells[k, m])))
        # Of cells that differ equally, any may be taken.
        least = min(found)[0]
        assert labels[row, column] in {label for each, label in found if not each > least + 1e-5}
