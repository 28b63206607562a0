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

"""The walks of Random Tree Walks, against plain numpy; their order; the grid of a body."""

import numpy as np
import pytest
from lsc_pose_experiments.walks.body_grid import (
    BodyGrid,
    GridCamera,
    body_centre,
    body_grid,
    pinhole_images,
)
from lsc_pose_experiments.walks.walk_order import CENTRE, WalkOrder, walk_order
from lsc_pose_experiments.walks.walk_trees import (
    DirectionTrees,
    WalkSettings,
    find_leaf,
    walk_body,
)
from plain.tree_walk import leaf_of_point, position_and_confidence, walk

from lsc_pose_ros.camera.projection import back_project, project
from lsc_pose_ros.data_types.camera import PLUMB_BOB, Intrinsics, Lens
from lsc_pose_ros.data_types.image_arguments import ImageArguments
from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, names_of, numbers_of

SETTINGS = WalkSettings(steps=12, step=0.04, skipped=3)


def random_trees(seed: int, joints: int) -> DirectionTrees:
    """Return trees of three splits and four leaves with five directions each."""
    rng = np.random.default_rng(seed)
    splits = rng.uniform(-0.5, 0.5, (7 * joints, 5)).astype(np.float32)
    splits[rng.random(len(splits)) < 0.5, 2:4] = 0
    left = [
        [7 * j + 1, 7 * j + 3, 7 * j + 5, *(-1 - np.arange(4 * j, 4 * j + 4))]
        for j in range(joints)
    ]
    directions = rng.normal(size=(4 * joints, 5, 3))
    directions /= np.linalg.norm(directions, axis=2, keepdims=True)
    probabilities = rng.dirichlet(np.ones(5), 4 * joints)
    return DirectionTrees(
        np.arange(joints, dtype=np.int32) * 7,
        splits,
        np.concatenate(left).astype(np.int32),
        directions.astype(np.float32),
        probabilities.cumsum(axis=1).astype(np.float32),
    )


def random_grid(seed: int) -> BodyGrid:
    """Return a rough disc."""
    rng = np.random.default_rng(seed)
    rows, columns = np.mgrid[:50, :40]
    depth = 2 + 0.01 * rows + rng.uniform(-0.2, 0.2, (50, 40))
    depth[(rows - 25) ** 2 + (columns - 20) ** 2 > 300] = 0
    return BodyGrid(depth.astype(np.float32), GridCamera(60.0, 65.0, 18.5, 26.5))


@pytest.mark.parametrize('seed', range(3))
def test_leaf_is_that_of_the_equation(seed):
    grid, trees = random_grid(seed), random_trees(seed, 3)
    rng = np.random.default_rng(seed)
    points = (rng.uniform(-0.6, 0.6, (300, 3)) + np.array([0, 0, 2.2])).astype(np.float32)
    leaves = [[find_leaf(grid, p, trees, j) for p in points] for j in range(3)]
    twins = [[leaf_of_point(grid, p, trees, j) for p in points] for j in range(3)]
    # A projection at the edge of a cell may fall into either by rounding.
    assert np.mean(np.not_equal(leaves, twins)) <= 0.01
    assert all(len(set(each)) >= 3 for each in leaves)


@pytest.mark.parametrize('seed', range(3))
def test_joint_is_the_mean_of_its_walk_from_the_joint_before(seed):
    grid, trees = random_grid(seed), random_trees(seed, 4)
    order = WalkOrder(np.array([2, 0, 3, 1], np.int32), np.array([CENTRE, 2, CENTRE, 3], np.int32))
    wrong = []
    for trial in range(20):
        draws = np.random.default_rng(trial).random((4, SETTINGS.steps), np.float32)
        centre = np.array([0.01 * trial, 0, 2.1], np.float32)
        found = walk_body(grid, centre, trees, order, draws, SETTINGS)
        for joint, start in zip(order.joint, order.start, strict=True):
            first = centre if start == CENTRE else found[start, :3]
            path = walk(grid, first, trees, joint, draws[joint], SETTINGS)
            twin = position_and_confidence(path, SETTINGS)
            wrong.append(not np.allclose(found[joint], twin, rtol=0, atol=1e-4))
    # After a projection at the edge of a cell, the rest of a walk may be another one.
    assert np.mean(wrong) <= 0.05


def one_direction(direction: list[float]) -> DirectionTrees:
    """Return a tree that always leads into one direction."""
    return DirectionTrees(
        np.zeros(1, np.int32),
        np.zeros((1, 5), np.float32),
        np.array([-1], np.int32),
        np.array([[direction]], np.float32),
        np.ones((1, 1), np.float32),
    )


def test_straight_walk_has_no_confidence():
    order = WalkOrder(np.zeros(1, np.int32), np.array([CENTRE], np.int32))
    draws = np.zeros((1, SETTINGS.steps), np.float32)
    centre = np.array([0.1, 0.2, 2], np.float32)
    (found,) = walk_body(random_grid(0), centre, one_direction([1, 0, 0]), order, draws, SETTINGS)
    # The mean of the steps 4 to 12.
    np.testing.assert_allclose(found[:3], [0.1 + 0.04 * 8, 0.2, 2], rtol=0, atol=1e-6)
    assert found[3] == pytest.approx(0, abs=1e-5)


def test_walk_does_not_pass_the_camera():
    order = WalkOrder(np.zeros(1, np.int32), np.array([CENTRE], np.int32))
    settings = WalkSettings(steps=40, step=0.1, skipped=30)
    draws = np.zeros((1, 40), np.float32)
    centre = np.array([0, 0, 1], np.float32)
    (found,) = walk_body(random_grid(0), centre, one_direction([0, 0, -1]), order, draws, settings)
    np.testing.assert_allclose(found, [0, 0, 0.1, 1], rtol=0, atol=1e-6)


def test_each_walk_starts_at_a_joint_that_is_known():
    joints = numbers_of(DEFAULT_JOINTS)
    names = names_of(joints)
    order = walk_order(joints)
    starts = {names[j]: s for j, s in zip(order.joint, order.start, strict=True)}
    assert sorted(order.joint) == list(range(len(joints)))
    assert names[starts['l_hand']] == 'l_wrist'
    assert names[starts['head']] == 'neck'
    assert names[starts['neck']] == 'torso'
    assert names[starts['r_hip']] == 'torso'  # without the pelvis
    assert starts['torso'] == CENTRE
    place = list(order.joint)
    for joint, start in zip(order.joint, order.start, strict=True):
        assert start == CENTRE or place.index(start) < place.index(joint)


def test_missing_joint_is_replaced_by_its_own_start():
    joints = numbers_of(['neck', 'l_hand', 'r_ankle', 'r_foot'])
    order = walk_order(joints)
    starts = {int(j): int(s) for j, s in zip(order.joint, order.start, strict=True)}
    assert starts == {0: CENTRE, 1: 0, 2: CENTRE, 3: 2}


def images_of(frame):
    return ImageArguments(frame.depth, frame.labels, frame.camera)


def test_grid_has_the_points_of_the_body(simple_frames):
    frame = simple_frames[2]
    grid = body_grid(images_of(frame), 2)
    rows, columns = np.nonzero((frame.labels == 2) & (frame.depth > 0))
    points = back_project(columns, rows, frame.depth[rows, columns], frame.camera)
    camera = grid.camera
    row = (camera.fy * points[:, 1] / points[:, 2] + camera.cy).astype(int)
    column = (camera.fx * points[:, 0] / points[:, 2] + camera.cx).astype(int)
    np.testing.assert_array_equal(grid.depth[row, column], points[:, 2])
    assert (grid.depth > 0).sum() == len(points)
    np.testing.assert_allclose(body_centre(grid), points.mean(axis=0), rtol=0, atol=1e-5)
    assert body_grid(images_of(frame), 7) is None


def test_large_image_is_reduced():
    depth = np.full((480, 640), 2, np.float32)
    images = ImageArguments(depth, np.ones((480, 640), np.int32), Intrinsics(500, 520, 320, 240))
    grid = body_grid(images, 1)
    assert abs(grid.depth.shape[1] - 320) <= 1
    assert grid.camera[:2] == (250, 260)
    # The middle of pixel (row 100, column 40) at a depth of 2 m.
    x, y = (40 - 320) * 2 / 500, (100 - 240) * 2 / 520
    assert grid.camera.fx * x / 2 + grid.camera.cx == pytest.approx((40 + 1 + 0.5) / 2)
    assert grid.camera.fy * y / 2 + grid.camera.cy == pytest.approx((100 + 1 + 0.5) / 2)


def test_lens_is_taken_out(simple_frames):
    frame = simple_frames[0]
    lens = Lens(PLUMB_BOB, (0.2, -0.05))
    images = images_of(frame)
    assert pinhole_images(images) is images
    bent = images._replace(camera=frame.camera._replace(lens=lens))
    straight = pinhole_images(bent)
    assert straight.camera == frame.camera
    rows, columns = np.nonzero(straight.labels == 1)
    points = back_project(columns, rows, straight.depth[rows, columns], straight.camera)
    at = np.rint(project(points, bent.camera)).astype(int)
    np.testing.assert_array_equal(frame.labels[at[:, 1], at[:, 0]], 1)
    np.testing.assert_array_equal(frame.depth[at[:, 1], at[:, 0]], points[:, 2])
    assert len(rows) > 0.5 * (frame.labels == 1).sum()
