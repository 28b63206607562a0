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

"""The factor for the confidence in joints near a cut: the image's edge, or something nearer."""

import itertools

import numpy as np
import pytest

from lsc_pose_ros.camera.rays import image_rays
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS, names_of
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.inference.truncation import (
    FEWEST_CUTS,
    NO_CUTS,
    Cuts,
    distances_from_cuts,
    find_cuts,
    truncation_factor,
)
from lsc_pose_ros.pose.silhouette.preprocessing import Window
from lsc_pose_ros.pose.silhouette.silhouette import cut_out

CAMERA = Intrinsics(280.0, 250.0, 31.0, 22.0)
HEIGHT, WIDTH = 40, 60
RAYS = image_rays(CAMERA, HEIGHT, WIDTH)
NO_LEGS = np.full(200, JOINT_NUMBERS['head'], np.uint16)


def window_of(rows: slice, columns: slice) -> Window:
    depth = np.zeros((HEIGHT, WIDTH), np.float32)
    depth[rows, columns] = 2.0
    window = cut_out(depth, np.zeros(depth.shape, np.int32), 0)
    assert window is not None
    return window


def random_joints(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.uniform((-1, -1, 1), (1, 1, 4), (200, 3)).astype(np.float32)


def cuts_twin(window: Window) -> list[tuple[int, int, int, int]]:
    """Row and column in the image of each cut, and the step to its hidden side."""
    unknown = np.isnan(window.depth)
    found = []
    for i, j in np.argwhere(np.isfinite(window.depth)):
        above, below = unknown[i - 1, j], unknown[i + 1, j]
        left, right = unknown[i, j - 1], unknown[i, j + 1]
        if above or below or left or right:
            step = int(below) - int(above), int(right) - int(left)
            found.append((window.row + i, window.column + j, *step))
    return found


def factor_twin(joint: np.ndarray, cuts: list[tuple[int, int, int, int]]) -> float:
    """The factor by the distance, at the joint's depth, to the nearest cut."""
    x, y, z = (float(number) for number in joint)
    column, row = CAMERA.cx + CAMERA.fx * x / z, CAMERA.cy + CAMERA.fy * y / z
    found = []
    for cut_row, cut_column, down, right in cuts:
        across = (column - cut_column) * z / CAMERA.fx
        along = (row - cut_row) * z / CAMERA.fy
        found.append((np.hypot(across, along), across * right + along * down > 0))
    metres, hidden = min(found)
    return by_distance(0.0 if hidden else metres)


def by_distance(metres: float) -> float:
    return between(metres, [(0.1, 0.29), (0.2, 0.55), (0.4, 0.77), (0.9, 1.0)])


def between(value: float, knots: list[tuple[float, float]]) -> float:
    """Linear between the knots (x, y), constant outside."""
    if value <= knots[0][0]:
        return knots[0][1]
    for (x, y), (next_x, next_y) in itertools.pairwise(knots):
        if value <= next_x:
            return y + (next_y - y) * (value - x) / (next_x - x)
    return knots[-1][1]


@pytest.mark.parametrize(
    ('rows', 'columns'),
    [
        (slice(0, 20), slice(10, 30)),
        (slice(10, HEIGHT), slice(10, 30)),
        (slice(10, 30), slice(0, 30)),
        (slice(10, 30), slice(30, WIDTH)),
        (slice(0, HEIGHT), slice(0, WIDTH)),
        (slice(1, HEIGHT - 1), slice(20, WIDTH)),
    ],
)
def test_confidence_decreases_towards_a_cut(rows: slice, columns: slice) -> None:
    window = window_of(rows, columns)
    cuts, expected = find_cuts(window, RAYS), cuts_twin(window)
    assert len(cuts.rays) == len(expected)
    joints = random_joints(0)
    found = truncation_factor(joints, cuts, NO_LEGS)
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, [factor_twin(each, expected) for each in joints], atol=1e-4)
    assert found.min() == pytest.approx(0.29)
    assert found.max() > 0.4


def test_cut_by_something_nearer_counts_like_the_edge_of_the_image() -> None:
    window = window_of(slice(10, 30), slice(10, 30))
    window.depth[-1] = np.nan
    expected = cuts_twin(window)
    assert {(row, down) for row, _, down, _ in expected} == {(29, 1)}
    joints = random_joints(1)
    np.testing.assert_allclose(
        truncation_factor(joints, find_cuts(window, RAYS), NO_LEGS),
        [factor_twin(each, expected) for each in joints],
        atol=1e-4,
    )


def test_joint_beyond_a_cut_has_the_lowest_factor_at_any_distance() -> None:
    window = window_of(slice(10, HEIGHT), slice(10, 30))
    below = np.array([[-0.05, 0.2, 2.0], [-0.05, 3.0, 2.0]], np.float32)
    np.testing.assert_allclose(
        truncation_factor(below, find_cuts(window, RAYS), NO_LEGS), 0.29, atol=1e-6
    )


@pytest.mark.parametrize('count', [FEWEST_CUTS - 1, FEWEST_CUTS])
def test_few_cuts_are_noise(count: int) -> None:
    window = window_of(slice(10, 30), slice(10, 30))
    window.depth[-1, 5 : 5 + count] = np.nan
    assert len(cuts_twin(window)) == count
    assert len(find_cuts(window, RAYS).rays) == (count if count == FEWEST_CUTS else 0)


def test_confidence_of_a_body_that_is_not_cut_off_is_unchanged() -> None:
    window = window_of(slice(1, HEIGHT - 1), slice(1, WIDTH - 1))
    cuts = find_cuts(window, RAYS)
    assert cuts is NO_CUTS
    joints = np.random.default_rng(1).uniform((-9, -9, 1), (9, 9, 4), (50, 3)).astype(np.float32)
    assert (truncation_factor(joints, cuts, NO_LEGS[:50]) == 1).all()


def test_joint_that_is_not_estimated_has_factor_1() -> None:
    joints = np.full((2, 3), np.nan, np.float32)
    joints[1] = (0.0, 5.0, 2.0)
    cuts = find_cuts(window_of(slice(10, HEIGHT), slice(10, 30)), RAYS)
    np.testing.assert_allclose(truncation_factor(joints, cuts, NO_LEGS[:2]), [1, 0.29], rtol=1e-6)


def test_ray_that_does_not_exist_is_ignored() -> None:
    rays = np.array([[np.nan, np.nan], [0.0, 0.1]], np.float32)
    hidden = np.array([[0, -1], [0, 1]], np.float32)
    joint = np.array([[0.0, 0.0, 2.0]], np.float32)
    found = truncation_factor(joint, Cuts(rays, hidden), NO_LEGS[:1])
    np.testing.assert_allclose(found, by_distance(0.2), rtol=1e-5)


@pytest.mark.parametrize(('nearer', 'largest'), [(False, 0.5), (True, 0.6)])
def test_confidence_falls_where_the_body_is_cut_off_at_the_hips(
    nearer, largest, small_model, people
) -> None:
    """The same body in an image that continues below it, and cut off.

    It is cut off by the edge of the image, or by something nearer.
    """
    frame, estimator = people[5], Estimator(small_model)
    rows = np.flatnonzero((frame.labels >= 0).any(axis=1))
    end = int(rows[0] + 0.6 * len(rows))
    depth, labels = frame.depth.copy(), frame.labels.copy()
    labels[end:] = NO_BODY
    whole = estimator.estimate(depth, labels, frame.camera)
    if nearer:
        depth[end:] = 0.8 * depth[labels >= 0].min()
    else:
        depth, labels = np.ascontiguousarray(depth[:end]), np.ascontiguousarray(labels[:end])
    cut = estimator.estimate(depth, labels, frame.camera)
    assert np.isfinite(cut.positions).all()
    knee = names_of(small_model.joints).index('l_knee')
    assert cut.confidence[0, knee] < largest * whole.confidence[0, knee]


LEG = ('hip', 'knee', 'ankle', 'foot')


def a_leg(thigh: float, shank: float, away: float = 0.0) -> np.ndarray:
    """Return hip, knee, ankle and foot; the foot is `away` from the cut at (-0.05, 0.1, 2)."""
    y = 0.05 - away - np.cumsum([0.02, shank, thigh])[::-1]
    return np.array([[-0.05, value, 2.0] for value in [*y, 0.05 - away]], np.float32)


@pytest.mark.parametrize('thigh', [0.05, 0.24, 0.31, 0.5])
@pytest.mark.parametrize('shank', [0.1, 0.25, 0.3, 0.42, 0.6])
@pytest.mark.parametrize('side', ['l', 'r'])
def test_short_legs_at_a_cut_are_hidden_ones(thigh: float, shank: float, side: str) -> None:
    cuts = find_cuts(window_of(slice(10, HEIGHT), slice(10, 30)), RAYS)
    numbers = np.array([JOINT_NUMBERS[f'{side}_{name}'] for name in LEG], np.uint16)
    leg = a_leg(thigh, shank)
    near = distances_from_cuts(leg, cuts)
    expected = [by_distance(metres) for metres in near]
    if near[1] < 0.4:
        expected[1] = between(thigh, [(0.2, 0.05), (0.27, 0.2), (0.35, 0.62)])
    low = between(min(thigh, shank), [(0.22, 0.07), (0.27, 0.2), (0.35, 0.52), (0.45, 0.82)])
    assert near[3] < 0.4
    expected[2:] = [low if metres < 0.4 else e for metres, e in zip(near, expected, strict=True)][
        2:
    ]
    np.testing.assert_allclose(truncation_factor(leg, cuts, numbers), expected, atol=1e-5)
    order = np.array([3, 1, 0, 2])
    np.testing.assert_allclose(
        truncation_factor(leg[order], cuts, numbers[order]), np.array(expected)[order], atol=1e-5
    )


@pytest.mark.parametrize('missing', LEG)
@pytest.mark.parametrize('unknown', [True, False])
def test_legs_that_are_not_estimated_are_judged_by_distance(missing: str, unknown: bool) -> None:  # noqa: FBT001
    """Without a hip or knee there is no thigh, without an ankle no shank."""
    cuts = find_cuts(window_of(slice(10, HEIGHT), slice(10, 30)), RAYS)
    leg = a_leg(0.1, 0.1)
    names = list(LEG)
    if unknown:
        leg[names.index(missing)] = np.nan
    else:
        leg = np.delete(leg, names.index(missing), axis=0)
        names.remove(missing)
    numbers = np.array([JOINT_NUMBERS[f'l_{name}'] for name in names], np.uint16)
    found = dict(zip(names, truncation_factor(leg, cuts, numbers), strict=True))
    near = dict(zip(names, distances_from_cuts(leg, cuts), strict=True))
    for name in names:
        expected = 1.0 if np.isnan(near[name]) else by_distance(near[name])
        if name == 'knee' and missing not in ('hip', 'knee'):
            expected = 0.05
        if name in ('ankle', 'foot') and missing not in ('hip', 'knee', 'ankle', name):
            expected = 0.07
        assert found[name] == pytest.approx(expected, abs=1e-5), name
