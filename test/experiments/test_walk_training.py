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

"""The training of Random Tree Walks: samples, splits, clusters; and the estimator as a whole."""

import numpy as np
import pytest
from lsc_pose_experiments.depth_comparisons import compare_cells
from lsc_pose_experiments.walks.body_grid import BodyGrid, GridCamera
from lsc_pose_experiments.walks.direction_clusters import cluster_directions
from lsc_pose_experiments.walks.direction_samples import (
    cells_of,
    draw_samples,
    join_grids,
)
from lsc_pose_experiments.walks.direction_tree_growth import (
    DirectionGrowth,
    find_split,
    grow_direction_tree,
    partition,
)
from lsc_pose_experiments.walks.walk_training import (
    WalkModelSettings,
    join_direction_trees,
)
from plain.tree_walk import comparison_of_point, leaf_of_point

from lsc_pose_ros.data_types.joints import numbers_of

JOINTS = numbers_of(['head', 'neck', 'torso', 'l_shoulder', 'r_shoulder', 'l_knee', 'r_hand'])
SMALL = WalkModelSettings(points=60, growth=DirectionGrowth(depth=16))


def a_body(seed: int) -> tuple[BodyGrid, np.ndarray]:
    """Return a disc, and its middle as a joint."""
    rng = np.random.default_rng(seed)
    camera = GridCamera(60.0, 65.0, 19.5, 24.5)
    middle = rng.uniform(-0.15, 0.15, 3) + np.array([0, 0, 2])
    rows, columns = np.mgrid[:50, :40]
    x = (columns + 0.5 - camera.cx) * middle[2] / camera.fx - middle[0]
    y = (rows + 0.5 - camera.cy) * middle[2] / camera.fy - middle[1]
    depth = np.where(x**2 + y**2 < 0.05, middle[2], 0)
    return BodyGrid(np.round(depth, 3).astype(np.float32), camera), middle.astype(np.float32)


@pytest.fixture(name='bodies', scope='module')
def some_bodies():
    return [a_body(seed) for seed in range(40)]


@pytest.fixture(name='grids', scope='module')
def some_grids(bodies):
    return join_grids(grid for grid, _ in bodies)


@pytest.fixture(name='samples', scope='module')
def some_samples(bodies):
    joints = np.array([middle for _, middle in bodies])
    return draw_samples(joints, 50, 0.4, np.random.default_rng(0))


def test_samples_surround_the_labelled_joints(bodies):
    joints = np.array([middle for _, middle in bodies])
    joints[3] = np.nan
    samples = draw_samples(joints, 200, 0.4, np.random.default_rng(0))
    assert np.bincount(samples.grid).tolist() == [200, 200, 200, 0, *[200] * 36]
    offset = joints[samples.grid] - samples.point
    distance = np.linalg.norm(offset, axis=1)
    np.testing.assert_allclose(samples.direction * distance[:, None], offset, atol=1e-6)
    # Uniform distances: a quarter in each quarter of the reach; 7800 samples, 5 deviations.
    fractions = np.histogram(distance, 4, (0, 0.4))[0] / len(distance)
    np.testing.assert_allclose(fractions, 0.25, atol=5 * (0.25 * 0.75 / 7800) ** 0.5)
    # No side is preferred: the mean of unit vectors has a deviation of (3 n)^-1/2 in each axis.
    np.testing.assert_allclose(samples.direction.mean(axis=0), 0, atol=5 / (3 * 7800) ** 0.5)


def test_no_sample_is_behind_the_camera():
    samples = draw_samples(np.array([[0, 0, 0.3]], np.float32), 500, 0.6, np.random.default_rng(0))
    assert 100 < len(samples.grid) < 500
    assert samples.point[:, 2].min() > 0.1


def test_samples_are_compared_as_the_equation_says(bodies, grids, samples):
    rng = np.random.default_rng(1)
    members = np.arange(0, len(samples.grid), 7)
    cells = cells_of(grids, samples, members)
    values = np.empty(len(members), np.float32)
    wrong = []
    for k in range(10):
        split = rng.uniform(-0.4, 0.4, 5).astype(np.float32)
        if k % 2:
            split[2:4] = 0
        compare_cells(grids.depth, cells, split, values)
        for value, member in zip(values, members, strict=True):
            grid, _ = bodies[samples.grid[member]]
            twin = comparison_of_point(grid.depth, grid.camera, samples.point[member], split)
            wrong.append(abs(value - twin) > 1e-5)
    # A projection at the edge of a cell may fall into either by rounding.
    assert np.mean(wrong) <= 0.01


def spread(directions: np.ndarray) -> float:
    """Return the sum of squared distances to the mean."""
    return float(((directions - directions.mean(axis=0)) ** 2).sum())


def test_gain_is_the_loss_of_spread(grids, samples):
    members = np.arange(len(samples.grid))
    growth = DirectionGrowth(subset=10_000, leaf_samples=50)
    split, gain = find_split(grids, samples, members, growth)
    left = partition(grids, samples, members, split)
    before = spread(samples.direction.astype(float))
    directions = samples.direction[members].astype(float)
    assert sorted(members) == list(range(len(samples.grid)))
    assert min(left, len(members) - left) >= 50
    after = spread(directions[:left]) + spread(directions[left:])
    assert gain == pytest.approx(before - after, rel=1e-5)
    assert gain > 0.05 * before


def test_tree_sorts_directions_into_leaves(bodies, grids, samples):
    growth = DirectionGrowth(depth=8, leaf_samples=20)
    tree = grow_direction_tree(grids, samples, growth, 1)
    inner = tree.left >= 0
    assert len(tree.directions) == (~inner).sum() == inner.sum() + 1
    assert sorted(-1 - tree.left[~inner]) == list(range(len(tree.directions)))
    np.testing.assert_allclose(np.linalg.norm(tree.directions, axis=2), 1, atol=1e-5)
    np.testing.assert_allclose(tree.cumulative[:, -1], 1, atol=1e-6)
    assert (np.diff(tree.cumulative, axis=1) >= 0).all()
    trees = join_direction_trees([tree, tree])
    leaves = np.array(
        [
            leaf_of_point(bodies[grid][0], point, trees, 1)
            for grid, point in zip(samples.grid, samples.point, strict=True)
        ]
    )
    assert leaves.min() >= len(tree.directions)
    counts = np.bincount(leaves - len(tree.directions))
    assert counts.min() >= 15  # 20, but for rounding at the edges of cells
    kept = sum(spread(samples.direction[leaves == leaf]) for leaf in set(leaves.tolist()))
    assert kept < 0.6 * spread(samples.direction)


def test_clusters_are_those_of_k_means():
    rng = np.random.default_rng(2)
    middles = np.eye(3)[[0, 1, 2, 0]] * [[1], [1], [1], [-1]]
    sizes = [50, 30, 15, 5]
    directions = np.repeat(middles, sizes, axis=0) + rng.normal(scale=0.05, size=(100, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    directions = rng.permutation(directions).astype(np.float32)
    centres, cumulative = np.zeros((6, 3), np.float32), np.zeros(6, np.float32)
    cluster_directions(directions, centres, cumulative)
    nearest = (directions @ centres.T).argmax(axis=1)
    np.testing.assert_allclose(
        np.diff(cumulative, prepend=0), np.bincount(nearest, minlength=6) / 100, atol=1e-6
    )
    for k in set(nearest.tolist()):
        mean = directions[nearest == k].sum(axis=0)
        np.testing.assert_allclose(centres[k], mean / np.linalg.norm(mean), atol=1e-5)


def test_few_directions_are_their_own_clusters():
    directions = np.eye(3, dtype=np.float32)[:2]
    centres, cumulative = np.zeros((4, 3), np.float32), np.zeros(4, np.float32)
    cluster_directions(directions, centres, cumulative)
    np.testing.assert_array_equal(centres[:2], directions)
    np.testing.assert_array_equal(cumulative, [0.5, 1, 1, 1])
