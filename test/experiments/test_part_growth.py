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


"""Growing trees of body parts: the split with the largest gain of information is chosen."""

import numpy as np
import pytest
from lsc_pose_experiments.depth_comparisons import compare_cells
from lsc_pose_experiments.shotton.part_forest import classify
from lsc_pose_experiments.shotton.part_forest_training import train_part_forest
from lsc_pose_experiments.shotton.part_samples import (
    PartImage,
    PartSamples,
    collect_samples,
)
from lsc_pose_experiments.shotton.part_tree_growth import (
    PartGrowth,
    cells_of,
    count_classes,
    entropy_of_both,
    entropy_times_count,
    find_split,
    grow_part_tree,
    n_log_n,
    partition,
)
from plain.depth_comparison import comparison_twin

from lsc_pose_ros.body_parts.classes import CLASSES, NOT_A_PERSON
from lsc_pose_ros.body_parts.depth_grid import depth_grid
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.errors import InputError

CAMERA = Intrinsics(100.0, 100.0, 79.5, 59.5)


def an_image(seed: int) -> PartImage:
    """Return a wall with a disc (class 1) and a square (class 5) in front of it."""
    rng = np.random.default_rng(seed)
    rows, columns = np.mgrid[:60, :80]
    depth = np.full((60, 80), 3.0, np.float32)
    parts = np.zeros((60, 80), np.uint8)
    i, j = rng.integers(12, 48), rng.integers(12, 30)
    disc = (rows - i) ** 2 + (columns - j) ** 2 < 90
    k, m = rng.integers(5, 40), rng.integers(45, 60)
    square = (abs(rows - k - 8) < 8) & (abs(columns - m - 8) < 8)
    depth[disc], parts[disc] = 1.8, 1
    depth[square], parts[square] = 2.4, 5
    depth[rng.random(depth.shape) < 0.03] = 0
    return PartImage(depth, parts, CAMERA)


@pytest.fixture(name='samples')
def some_samples() -> PartSamples:
    return collect_samples((an_image(seed) for seed in range(12)), 80, 60, 6.0, 0)


def entropy(parts: np.ndarray) -> float:
    counts = np.bincount(parts)
    fractions = counts[counts > 0] / max(len(parts), 1)
    return float(-(fractions * np.log2(fractions)).sum()) * len(parts)


def test_samples_have_the_class_of_their_cell(samples: PartSamples) -> None:
    assert len(samples.start) == 12
    for s in range(0, len(samples.part), 7):
        image = an_image(samples.image[s])
        row, column = samples.row[s], samples.column[s]
        assert samples.part[s] == image.parts[row, column]
        cell = samples.start[samples.image[s]] + row * 80 + column
        assert samples.depth[cell] == round(float(image.depth[row, column]) * 1000) > 0
    people = np.bincount(samples.image[samples.part != NOT_A_PERSON])
    others = np.bincount(samples.image[samples.part == NOT_A_PERSON])
    assert (people == 80).all()
    assert (others == 60).all()


def test_no_sample_is_beyond_the_largest_depth() -> None:
    samples = collect_samples([an_image(0)], 10_000, 10_000, 2.5, 0)
    assert set(samples.part.tolist()) == {1, 5}
    assert len(samples.part) == (an_image(0).parts > 0).sum() - _unknown_in_parts(an_image(0))


def _unknown_in_parts(image: PartImage) -> int:
    return int(((image.parts > 0) & (image.depth == 0)).sum())


def test_cells_are_compared_as_the_forest_compares_them(samples: PartSamples) -> None:
    rng = np.random.default_rng(1)
    members = np.arange(0, len(samples.part), 3)
    cells = cells_of(samples, members)
    values = np.empty(len(members), np.float32)
    for k in range(10):
        split = rng.uniform(-0.6, 0.6, 5).astype(np.float32)
        if k % 2:
            split[2:4] = 0
        compare_cells(samples.depth, cells, split, values)
        wrong = 0
        for value, member in zip(values, members, strict=True):
            first = samples.start[samples.image[member]]
            depth = samples.depth[first : first + 4800].reshape(60, 80) / 1000
            twin = comparison_twin(
                depth, samples.row[member], samples.column[member], split, CAMERA
            )
            wrong += abs(value - twin) > 1e-5
        assert wrong <= 0.02 * len(members)


def test_classes_are_counted_between_thresholds() -> None:
    rng = np.random.default_rng(2)
    values = rng.normal(size=300).astype(np.float32)
    values[:10] = 0.25
    parts = rng.integers(0, CLASSES, 300).astype(np.uint8)
    thresholds = np.array([-1.0, 0.25, 0.25, 2.0], np.float32)
    counts = np.full((5, CLASSES), -1)
    count_classes(parts, values, thresholds, counts)
    limits = [-np.inf, *thresholds, np.inf]
    for row in range(5):
        inside = (values >= limits[row]) & (values < limits[row + 1])
        np.testing.assert_array_equal(counts[row], np.bincount(parts[inside], minlength=CLASSES))


def test_the_entropy_is_that_of_its_equation() -> None:
    rng = np.random.default_rng(3)
    logarithms = n_log_n(2000)
    for size in (0, 1, 2, 500, 2000):
        parts = rng.integers(0, CLASSES, size)
        left = parts[: size // 3]
        total = np.bincount(parts, minlength=CLASSES)
        counts = np.bincount(left, minlength=CLASSES)
        assert entropy_times_count(total, logarithms) == pytest.approx(entropy(parts), abs=1e-8)
        both = entropy(left) + entropy(parts[size // 3 :])
        assert entropy_of_both(counts, total, logarithms) == pytest.approx(both, abs=1e-8)


def test_the_gain_of_a_split_is_that_of_its_samples(samples: PartSamples) -> None:
    members = np.arange(len(samples.part))
    growth = PartGrowth(features=30, subset=10_000)
    split, gain = find_split(samples, members, growth, n_log_n(10_001))
    left = partition(samples, members, split)
    parts = samples.part[members]
    both = entropy(parts[:left]) + entropy(parts[left:])
    assert 0 < left < len(parts)
    assert sorted(members) == list(range(len(parts)))
    assert gain == pytest.approx(entropy(samples.part) - both, abs=1e-6)


def test_nothing_is_gained_by_splitting_one_class(samples: PartSamples) -> None:
    members = np.flatnonzero(samples.part == 1)
    *_, gain = find_split(samples, members, PartGrowth(features=20), n_log_n(4001))
    assert gain == 0


def test_a_tree_has_leaves_of_enough_samples(samples: PartSamples) -> None:
    growth = PartGrowth(depth=6, leaf_samples=25, features=20)
    tree = grow_part_tree(samples, growth, 1)
    inner = tree.left >= 0
    assert len(tree.leaves) == (~inner).sum() == inner.sum() + 1
    np.testing.assert_allclose(tree.leaves.sum(axis=1), 1, atol=1e-4)
    assert sorted(-1 - tree.left[~inner]) == list(range(len(tree.leaves)))


def test_the_forest_learns_the_parts(samples: PartSamples) -> None:
    forest = train_part_forest(samples, 2, PartGrowth(features=40), 0)
    again = train_part_forest(samples, 2, PartGrowth(features=40), 0)
    for one, other in zip(forest, again, strict=True):
        np.testing.assert_array_equal(one, other)
    image = an_image(100)
    grid = depth_grid(image.depth, CAMERA)
    found = classify(grid, forest, 1, 6.0)
    known = grid.depth > 0
    right = found.argmax(axis=-1) == image.parts
    for part in (0, 1, 5):
        assert right[known & (image.parts == part)].mean() > 0.8


def test_training_without_samples_is_refused() -> None:
    empty = PartImage(np.zeros((60, 80), np.float32), np.zeros((60, 80), np.uint8), CAMERA)
    with pytest.raises(InputError, match='no image has a pixel with depth'):
        train_part_forest(collect_samples([empty], 5, 5, 6.0, 0), 1, PartGrowth(), 0)
