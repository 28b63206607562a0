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

"""The whole estimator, with a small model."""

import numpy as np
import pytest

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types import image_arguments
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.pose.estimator import Estimator, bodies_in, largest_bodies
from lsc_pose_ros.pose.stages import FEWEST_POINTS


@pytest.fixture(scope='module')
def estimator(small_model):
    return Estimator(small_model)


def test_empty_mask_has_no_skeleton(estimator, people):
    frame = people[0]
    found = estimator.estimate(frame.depth, np.full_like(frame.labels, NO_BODY), frame.camera)
    assert found.positions.shape == (0, len(estimator.joints), 3)
    assert found.confidence.shape == (0, len(estimator.joints))


@pytest.mark.parametrize('seen', ['speck', 'no depth'])
def test_too_little_of_a_body_is_unknown_with_confidence_zero(estimator, people, seen):
    frame = people[0]
    labels = np.full_like(frame.labels, NO_BODY)
    depth = frame.depth
    if seen == 'speck':
        labels[10:14, 10:14] = 4
        depth = np.full_like(depth, 2)
        assert FEWEST_POINTS > 16
    else:
        labels[:] = 4
        depth = np.zeros_like(depth)
    found = estimator.estimate(depth, labels, frame.camera)
    assert found.bodies.tolist() == [4]
    assert np.isnan(found.positions).all()
    assert (found.confidence == 0).all()


def test_bodies_are_estimated_each_by_itself_in_the_order_of_their_numbers(estimator, people):
    """Two people side by side in one image have the same joints as each by itself."""
    near, far = people[0], people[200]
    depth = np.concatenate([near.depth, far.depth], axis=1)
    labels = np.concatenate(
        [np.where(near.labels >= 0, 9, NO_BODY), np.where(far.labels >= 0, 2, NO_BODY)], axis=1
    ).astype(np.int32)
    together = estimator.estimate(depth, labels, near.camera)
    assert together.bodies.tolist() == [2, 9]
    alone = estimator.estimate(near.depth, near.labels, near.camera)
    np.testing.assert_array_equal(together.positions[1], alone.positions[0])
    other = np.concatenate([np.zeros_like(near.depth), far.depth], axis=1)
    alone = estimator.estimate(other, np.where(labels == 2, 2, NO_BODY), near.camera)
    np.testing.assert_array_equal(together.positions[0], alone.positions[0])


def test_only_the_largest_bodies_are_estimated_and_the_others_are_counted(estimator, people):
    frame = people[20]
    labels = np.where(frame.labels >= 0, 7, NO_BODY).astype(np.int32)
    labels[:2, ::4], labels[:2, 1::4] = np.arange(40) + 100, 3
    limited = Estimator(estimator.model, maximum_bodies=2)
    found, beyond = limited.estimate_largest(frame.depth, labels, frame.camera)
    assert found.bodies.tolist() == [3, 7]
    assert beyond == 40
    every = estimator.estimate(frame.depth, labels, frame.camera)
    assert len(every.bodies) == 42
    np.testing.assert_array_equal(found.positions[1], every.positions[every.bodies == 7][0])


@pytest.mark.parametrize('most', [None, 1, 3, 50])
def test_largest_bodies_are_those_with_the_most_pixels(most):
    labels = np.random.default_rng(1).integers(-1, 9, (12, 12)).astype(np.int32)
    sizes = {number: int((labels == number).sum()) for number in range(9)}
    ordered = sorted(sizes, key=lambda number: (-sizes[number], number))[:most]
    bodies, beyond = largest_bodies(labels, most)
    assert bodies.tolist() == sorted(ordered)
    assert beyond == 9 - len(ordered)


def test_pixels_behind_the_body_do_not_matter(estimator, people):
    frame = people[10]
    rng = np.random.default_rng(0)
    noisy = np.where(
        frame.labels >= 0, frame.depth, rng.choice([0.0, 6.0, 9.0], frame.depth.shape)
    ).astype(np.float32)
    before = estimator.estimate(frame.depth, frame.labels, frame.camera)
    after = estimator.estimate(noisy, frame.labels, frame.camera)
    np.testing.assert_array_equal(after.positions, before.positions)


def test_joints_lie_on_the_person_and_are_confident(estimator, people):
    frame = people[20]
    found = estimator.estimate(frame.depth, frame.labels, frame.camera)
    pixels = np.rint(project(found.positions[0], frame.camera)).astype(int)
    on_body = frame.labels[pixels[:, 1], pixels[:, 0]] >= 0
    assert on_body.mean() >= 0.75
    assert ((found.confidence > 0) & (found.confidence <= 1)).all()


def test_stages_lead_to_the_estimate(estimator, people):
    frame = people[20]
    stages = estimator.estimate_body(frame.depth, frame.labels, frame.camera, 1)
    found = estimator.estimate(frame.depth, frame.labels, frame.camera)
    np.testing.assert_array_equal(stages.joints, found.positions[0])
    alone = Estimator(estimator.model, graph=False)
    np.testing.assert_array_equal(
        stages.unary, alone.estimate(frame.depth, frame.labels, frame.camera).positions[0]
    )
    chosen_is_candidate = [
        (
            np.abs(stages.candidates.positions[j, : stages.candidates.counts[j]] - position).max(1)
            == 0
        ).any()
        for j, position in enumerate(stages.chosen)
    ]
    assert all(chosen_is_candidate)


def test_confidence_is_interpolated_at_the_vote_fraction_of_the_joint(estimator, people):
    frame = people[20]
    calibration = estimator.model.calibration
    knots = np.linspace(0, 1, calibration.shape[1])
    stages = estimator.estimate_body(frame.depth, frame.labels, frame.camera, 1)
    found = estimator.estimate(frame.depth, frame.labels, frame.camera)
    votes = stages.joint_votes
    for joint, position in enumerate(stages.joints):
        mine = slice(votes.start[joint], votes.start[joint + 1])
        squared = ((votes.position[mine] - position) ** 2).sum(axis=1)
        h = estimator.model.settings.joint_bandwidth
        support = (votes.weight[mine] * np.exp(-squared / h**2)).sum() / votes.weight[mine].sum()
        expected = np.interp(support, knots, calibration[joint])
        assert found.confidence[0, joint] == pytest.approx(expected, abs=1e-3)


def test_large_images_are_estimated_from_some_of_their_pixels(estimator, people, monkeypatch):
    frame = people[0]
    small = estimator.estimate(frame.depth, frame.labels, frame.camera)
    monkeypatch.setattr(image_arguments, 'MOST_PIXELS', frame.depth.size)
    # Three times as large, with pixels between those of the frame that would change everything.
    height, width = frame.depth.shape
    depth = np.full((3 * height, 3 * width), 0.5, np.float32)
    labels = np.zeros(depth.shape, np.int32)
    depth[::3, ::3], labels[::3, ::3] = frame.depth, frame.labels
    camera = Intrinsics(*(3 * each for each in frame.camera[:4]))
    large = estimator.estimate(depth, labels, camera)
    np.testing.assert_allclose(large.positions, small.positions, atol=1e-6)


def test_bodies_in_a_mask():
    labels = np.array([[NO_BODY, 7, 0], [7, 300, NO_BODY]], np.int32)
    assert bodies_in(labels).tolist() == [0, 7, 300]
    assert bodies_in(np.full((2, 2), NO_BODY, np.int32)).tolist() == []
