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

"""The second classification, with what is around a cell, against plain numpy."""

import numpy as np
import pytest

from lsc_pose_ros.body_parts.context import (
    PLANES,
    REFINED,
    UNIT,
    PartForests,
    classify_alone,
    classify_in_context,
    context_planes,
)
from lsc_pose_ros.body_parts.depth_grid import DepthGrid
from lsc_pose_ros.body_parts.part_forest import (
    BEYOND,
    CLASSES,
    LIKELY,
    NOT_A_PERSON,
    PartForest,
    classify,
    classify_likely,
)
from lsc_pose_ros.body_parts.smoothing import SURFACE_STEP, smooth_person
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.training.body_parts.context_samples import PartGrid, collect_context_samples
from lsc_pose_ros.training.body_parts.part_training import train_part_forest
from lsc_pose_ros.training.body_parts.part_tree_growth import PartGrowth, draw_plane

GROUP = {
    'head': 2, 'neck': 2,
    'torso': 3, 'pelvis': 3, 'shoulder': 3, 'hip': 3,
    'elbow': 4, 'wrist': 4, 'hand': 4,
    'knee': 5, 'ankle': 5, 'foot': 5,
}  # fmt: skip
FOCAL_LENGTHS = (100.0, 110.0)


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


def stump(plane: int, threshold: float, offset: float, below: int, above: int) -> PartForest:
    """Return a tree that compares a cell with one to its right, with two sure leaves."""
    leaves = np.zeros((2, CLASSES), np.uint8)
    leaves[0, below], leaves[1, above] = 255, 255
    return PartForest(
        np.zeros(1, np.int32),
        np.array([[offset, 0, 0, 0, threshold], [0] * 5, [0] * 5], np.float32),
        np.array([plane, 0, 0], np.uint8),
        np.array([1, -1, -2], np.int32),
        leaves,
    )


def grid_of(depth: np.ndarray) -> DepthGrid:
    return DepthGrid(depth, 2, FOCAL_LENGTHS)


@pytest.mark.parametrize('reach', [0, 1, 2])
@pytest.mark.parametrize('seed', range(3))
def test_the_probability_of_a_person_is_averaged_over_a_surface(seed: int, reach: int) -> None:
    probabilities, depth = random_scene(seed)
    smoothed = smooth_person(probabilities, depth, reach)
    for i, j in np.ndindex(depth.shape):
        window = (
            slice(max(i - reach, 0), i + reach + 1),
            slice(max(j - reach, 0), j + reach + 1),
        )
        near = (depth[window] > 0) & (abs(depth[window] - depth[i, j]) <= SURFACE_STEP)
        person = 1 - probabilities[window][..., NOT_A_PERSON]
        expected = person[near].mean() if depth[i, j] > 0 else 0
        assert smoothed[i, j] == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize('seed', range(3))
def test_planes_are_depth_and_the_probabilities_of_groups_of_parts(seed: int) -> None:
    probabilities, depth = random_scene(seed)
    person = smooth_person(probabilities, depth, 1)
    planes = context_planes(depth, probabilities, person)
    expected = np.zeros((PLANES, *depth.shape))
    expected[0], expected[1] = depth, person
    for joint, name in enumerate(JOINT_NAMES):
        expected[GROUP[name.split('_')[-1]]] += probabilities[..., 1 + joint]
    expected[1:] += UNIT
    # Rounded to UNIT.
    np.testing.assert_allclose(planes, expected, atol=0.51 * UNIT)
    np.testing.assert_allclose(planes / UNIT, np.rint(planes / UNIT), atol=1e-3)
    assert (planes[1:] > 0).all()


@pytest.mark.parametrize('seed', range(4))
def test_few_cells_are_classified_far_from_people(seed: int) -> None:
    rng = np.random.default_rng(seed)
    depth = rng.uniform(1, 7, (31, 42)).astype(np.float32)
    depth[rng.random(depth.shape) < 0.3] = 0
    forest = stump(0, 4.0, 0.08, NOT_A_PERSON, 3)
    grid, stride = grid_of(depth), 1 + seed % 2
    everywhere = classify(grid, forest, stride, 6.0)
    found = classify_likely(grid, forest, stride, 6.0)
    classified = everywhere.sum(axis=-1) > 0
    for i, j in np.ndindex(classified.shape):
        around = [
            everywhere[k, m]
            for k in range(max(i - 1, 0), min(i + 2, classified.shape[0]))
            for m in range(max(j - 1, 0), min(j + 2, classified.shape[1]))
            if k % 2 == m % 2 == 0 and classified[k, m]
        ]
        likely = any(each[NOT_A_PERSON] <= 1 - LIKELY for each in around) or not around
        expected = everywhere[i, j]
        if classified[i, j] and not likely:
            expected = np.eye(CLASSES)[NOT_A_PERSON]
        np.testing.assert_allclose(found[i, j], expected, atol=1e-6)


def test_only_cells_that_may_show_a_person_are_classified_again() -> None:
    depth = np.full((40, 60), 2.0, np.float32)
    depth[:, 30:] = 3.0
    depth[:4] = 0
    # The first forest takes all that is nearer than 2.5 m for a head, the second for a foot.
    first = stump(0, 7.5, 50.0, NOT_A_PERSON, 1)
    second = stump(2, 0.0, 0.0, 2, 20)
    parts = classify_in_context(grid_of(depth), PartForests(first, second), 2, 6.0)
    np.testing.assert_array_equal(parts.depth, depth[::2, ::2])
    near = (parts.depth > 0) & (parts.depth < 2.5)
    assert (parts.probabilities[near].argmax(axis=-1) == 20).all()
    far = parts.depth > 2.5
    np.testing.assert_array_equal(parts.probabilities[far], np.eye(CLASSES)[[0] * far.sum()])
    assert not parts.probabilities[parts.depth == 0].any()
    np.testing.assert_allclose(parts.person[near], 1, atol=1e-5)


def test_a_split_compares_its_own_plane() -> None:
    """What is outside of the image is BEYOND in all planes."""
    depth = np.full((10, 10), 2.0, np.float32)
    first = stump(0, 0.0, 0.0, 0, 1)
    for plane in range(PLANES):
        value = 2.0 if plane == 0 else 1.0 + float(UNIT) if plane < 3 else float(UNIT)
        for threshold, part in ((float(BEYOND) - value - 0.01, 20), (9.9999, 2)):
            second = stump(plane, threshold, 50.0, 2, 20)
            found = classify_in_context(grid_of(depth), PartForests(first, second), 1, 6.0)
            assert (found.probabilities.argmax(axis=-1) == part).all()


def test_planes_are_drawn_as_often_as_wanted() -> None:
    assert {draw_plane(1, 0.5) for _ in range(50)} == {0}
    drawn = np.bincount([draw_plane(4, 0.4) for _ in range(6000)], minlength=4)
    expected = 6000 * np.array([0.4, 0.2, 0.2, 0.2])
    # Five standard errors.
    assert (abs(drawn - expected) < 5 * np.sqrt(expected)).all()


def test_the_second_forest_learns_what_the_first_cannot_tell() -> None:
    """A box is a head if there is a trunk below it; the first forest only knows boxes."""
    images = [two_boxes(seed) for seed in range(40)]
    first = stump(0, 6.5, 50.0, NOT_A_PERSON, 1)  # all that is nearer than 3.5 m is a head
    samples = collect_context_samples(images, first, 1, 100, 6.0, 0)
    assert set(samples.part.tolist()) == {0, 1, 3}
    assert samples.planes.shape == (PLANES, 40 * 48 * 64)
    for s in range(0, len(samples.part), 97):
        image = images[samples.image[s]]
        assert samples.part[s] == image.parts[samples.row[s], samples.column[s]]
        alone = classify_alone(image.grid, first, 1, 6.0)
        assert alone.person[samples.row[s], samples.column[s]] >= REFINED
    second = train_part_forest(samples, 2, PartGrowth(features=60), 0)
    test = two_boxes(1000)
    found = classify_in_context(test.grid, PartForests(first, second), 1, 6.0)
    right = found.probabilities.argmax(axis=-1) == test.parts
    assert right[test.grid.depth < 3.5].mean() > 0.8


def two_boxes(seed: int) -> PartGrid:
    """Return a head with a trunk below it, and a box of the size of a head alone."""
    rng = np.random.default_rng(seed)
    depth = np.full((48, 64), 4.0, np.float32)
    parts = np.zeros((48, 64), np.uint8)
    top, left = rng.integers(2, 14), rng.integers(2, 16)
    depth[top : top + 8, left : left + 8], parts[top : top + 8, left : left + 8] = 2.0, 1
    low = slice(top + 8, top + 28)
    depth[low, left : left + 14], parts[low, left : left + 14] = 2.0, 3
    top, left = rng.integers(2, 38), rng.integers(34, 54)
    depth[top : top + 8, left : left + 8] = 2.0
    return PartGrid(DepthGrid(depth, 1, (60.0, 60.0)), parts)
