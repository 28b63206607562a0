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


"""People told apart on a grid of cells, compared with plain Python."""

import itertools

import numpy as np
import pytest

from lsc_pose_ros.body_parts.part_forest import CLASSES, NOT_A_PERSON
from lsc_pose_ros.body_parts.smoothing import SURFACE_STEP, smooth_person
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.segmentation import cell_labels, person_instances
from lsc_pose_ros.segmentation.cell_labels import labels_from_cells
from lsc_pose_ros.segmentation.person_cells import (
    HEAD_CLASS,
    TRUNK_CLASSES,
    PersonCells,
    person_cells,
)
from lsc_pose_ros.segmentation.person_instances import (
    find_bodies,
    find_peaks,
    spread,
    sum_in_spheres,
)

CAMERA = (60.0, 62.0, 30.0, 22.0)  # fx, fy, cx, cy in cells
ARM_CLASS = 1 + JOINT_NUMBERS['l_elbow']


def random_scene(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return probabilities and depth with several surfaces, and cells that are not classified."""
    rng = np.random.default_rng(seed)
    depth = rng.choice([1.5, 1.58, 2.0, 2.6], (14, 18)).astype(np.float32)
    probabilities = rng.random((14, 18, CLASSES)).astype(np.float32)
    probabilities[..., NOT_A_PERSON] *= 15
    probabilities /= probabilities.sum(axis=-1, keepdims=True)
    unknown = rng.random(depth.shape) < 0.15
    depth[unknown], probabilities[unknown] = 0, 0
    return probabilities, depth


def cells_of(seed: int, threshold: float = 0.4) -> PersonCells:
    probabilities, depth = random_scene(seed)
    smoothed = smooth_person(probabilities, depth, 1)
    return person_cells(probabilities, smoothed, depth, CAMERA, threshold)


@pytest.mark.parametrize('seed', range(3))
def test_cells_of_people_have_positions_areas_and_parts(seed: int) -> None:
    probabilities, depth = random_scene(seed)
    smoothed = smooth_person(probabilities, depth, 1)
    cells = person_cells(probabilities, smoothed, depth, CAMERA, 0.4)
    chosen = np.argwhere(smoothed >= 0.4)
    assert len(chosen) == len(cells.area) > 10
    fx, fy, cx, cy = CAMERA
    for n, (i, j) in enumerate(chosen):
        z = depth[i, j]
        assert cells.number[i, j] == n
        assert (cells.row[n], cells.column[n]) == (i, j)
        np.testing.assert_allclose(
            cells.points[n], [(j - cx) / fx * z, (i - cy) / fy * z, z], rtol=1e-5
        )
        assert cells.area[n] == pytest.approx(z * z / fx / fy, rel=1e-5)
        assert cells.head[n] == probabilities[i, j, HEAD_CLASS]
        trunk = probabilities[i, j, TRUNK_CLASSES].sum()
        assert cells.trunk[n] == pytest.approx(trunk, abs=1e-5)
    assert (cells.number >= 0).sum() == len(chosen)


@pytest.mark.parametrize('radius', [0.0213, 0.1517, 0.4039])
@pytest.mark.parametrize('seed', range(3))
def test_evidence_is_summed_in_spheres(seed: int, radius: float) -> None:
    cells = cells_of(seed)
    found = sum_in_spheres(cells, cells.trunk, radius)
    apart = np.linalg.norm(cells.points[:, None] - cells.points[None], axis=-1)
    # No distance of two cells is within rounding of these radii.
    assert (abs(apart - radius) > 1e-6).all()
    expected = ((apart <= radius) * (cells.trunk * cells.area)[None]).sum(axis=1)
    expected[cells.trunk < person_instances.LEAST_PROBABILITY] = 0
    np.testing.assert_allclose(found, expected, rtol=1e-4)


def test_peaks_are_the_best_and_apart() -> None:
    cells = cells_of(1)
    evidence = sum_in_spheres(cells, cells.trunk, 0.2)
    peaks = find_peaks(cells, cells.trunk, 0.2, 0.3, 0.003)
    assert len(peaks) > 1
    assert evidence[peaks[0]] == evidence.max()
    assert (np.diff(evidence[peaks]) <= 0).all()
    for one, other in itertools.combinations(peaks, 2):
        assert np.linalg.norm(cells.points[one] - cells.points[other]) >= 0.3
    # Every cell with enough evidence is near a peak.
    for n in np.flatnonzero(evidence >= 0.003):
        assert np.linalg.norm(cells.points[peaks] - cells.points[n], axis=1).min() < 0.3


def shortest_paths(cells: PersonCells, seed: int) -> np.ndarray:
    """Return the cost of the cheapest path from one cell to each, by repeated relaxation."""
    steps = []
    reach = person_instances.NEIGHBOURS
    for one, other in itertools.permutations(range(len(cells.area)), 2):
        rows = abs(int(cells.row[one]) - int(cells.row[other]))
        columns = abs(int(cells.column[one]) - int(cells.column[other]))
        if max(rows, columns) > reach:
            continue
        difference = (cells.points[one] - cells.points[other]).astype(float)
        length, jump = float(np.linalg.norm(difference)), abs(difference[2])
        if jump > person_instances.LARGEST_JUMP:
            continue
        factor = 1 if jump <= SURFACE_STEP else person_instances.JUMP_FACTOR
        steps.append((one, other, length * factor))
    cost = np.full(len(cells.area), np.inf)
    cost[seed] = 0
    while True:
        before = cost.copy()
        for one, other, length in steps:
            cost[other] = min(cost[other], cost[one] + length)
        if (cost == before).all():
            return np.where(cost <= person_instances.REACH, cost, np.inf)


@pytest.mark.parametrize('seed', range(3))
def test_each_cell_belongs_to_the_nearest_seed(seed: int) -> None:
    cells = cells_of(seed)
    seeds = np.array([3, len(cells.area) // 2, len(cells.area) - 4])
    distance = np.full(len(cells.area), np.inf)
    body = np.full(len(cells.area), -1, np.int32)
    for number in range(3):
        spread(cells, seeds, number, distance, body)
    paths = np.array([shortest_paths(cells, each) for each in seeds])
    np.testing.assert_allclose(distance, paths.min(axis=0), rtol=1e-5)
    reached = np.isfinite(distance)
    assert (body[~reached] == -1).all()
    chosen = paths[body[reached], np.flatnonzero(reached)]
    np.testing.assert_allclose(chosen, distance[reached], rtol=1e-5)


def paint(people: list[tuple[int, float]], *, arm: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Return probabilities and depth of people: the column of their middle, and their depth."""
    depth = np.full((45, 60), 4.0, np.float32)
    classes = np.zeros((45, 60), np.int64)
    for column, z in people:
        depth[6:10, column - 2 : column + 2] = z
        classes[6:10, column - 2 : column + 2] = HEAD_CLASS
        depth[10:40, column - 5 : column + 5] = z
        classes[10:40, column - 5 : column + 5] = TRUNK_CLASSES[1]
        classes[26:40, column - 5 : column + 5] = 1 + JOINT_NUMBERS['l_knee']
        if arm:
            depth[14:22, column - 2 : column + 1] = z - 0.5
            classes[14:22, column - 2 : column + 1] = ARM_CLASS
    return np.eye(CLASSES, dtype=np.float32)[classes], depth


def bodies_in(probabilities: np.ndarray, depth: np.ndarray) -> np.ndarray:
    smoothed = smooth_person(probabilities, depth, 1)
    cells = person_cells(probabilities, smoothed, depth, CAMERA, 0.5)
    return np.append(find_bodies(cells).body, -1)[cells.number]


def test_two_people_side_by_side_are_two() -> None:
    probabilities, depth = paint([(20, 2.5), (30, 2.5)])
    body = bodies_in(probabilities, depth)
    assert body.max() == 1
    assert (body[11:40, 15:23] == body[8, 20]).all()
    assert (body[11:40, 27:35] == body[8, 30]).all()
    assert body[8, 20] != body[8, 30]


def test_an_arm_before_the_trunk_belongs_to_it() -> None:
    body = bodies_in(*paint([(20, 2.0)], arm=True))
    assert body.max() == 0
    assert (body[14:22, 18:21] == 0).all()


def test_a_person_behind_another_is_another() -> None:
    body = bodies_in(*paint([(22, 3.4), (30, 2.0)]))
    assert body.max() == 1
    assert body[8, 22] >= 0
    assert body[8, 22] != body[8, 30]


def test_a_few_cells_of_a_limb_are_no_body() -> None:
    probabilities, depth = paint([(20, 2.5)])
    depth[20:24, 45:48] = 2.5
    probabilities[20:24, 45:48] = np.eye(CLASSES)[ARM_CLASS]
    body = bodies_in(probabilities, depth)
    assert body.max() == 0
    assert (body[20:24, 45:48] == -1).all()


def test_no_cells_are_no_bodies() -> None:
    probabilities, depth = paint([])
    assert (bodies_in(probabilities, depth) == -1).all()
    assert (bodies_in(np.zeros_like(probabilities), np.zeros_like(depth)) == -1).all()


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
