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

"""The rivals that are built here, each as a whole: training and estimator."""

import numpy as np
import pytest
from lsc_pose_experiments.rivals import RIVALS
from lsc_pose_experiments.sampled_frames import sample_frames
from lsc_pose_experiments.shotton.part_model_training import PartModelSettings
from lsc_pose_experiments.shotton.part_tree_growth import PartGrowth
from lsc_pose_experiments.walks.direction_tree_growth import DirectionGrowth
from lsc_pose_experiments.walks.walk_training import WalkModelSettings

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import names_of, numbers_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation.evaluate import evaluate, summarise

JOINTS = numbers_of(['head', 'neck', 'torso', 'l_shoulder', 'r_shoulder', 'l_knee', 'r_hand'])
# Settings that train in seconds, and the mean average precision that they reach at least.
SMALL = {
    'Shotton et al.': (PartModelSettings(2, PartGrowth(14, features=60), 300, 100), 0.6),
    'Random Tree Walks': (WalkModelSettings(points=60, growth=DirectionGrowth(depth=16)), 0.7),
}


@pytest.fixture(scope='module', params=SMALL)
def rival(request):
    """A rival, its settings, and the precision that it reaches at least."""
    settings, precision = SMALL[request.param]
    return RIVALS[type(settings)], settings, precision


@pytest.fixture(scope='module')
def estimator(rival, people):
    """An estimator that has learned from 120 frames."""
    system, settings, _ = rival
    frames = sample_frames(people[:120], 1000, (0,)).frames
    return system.make(system.train(frames, JOINTS, settings, 0))


def arrays_of(model):
    """Return the arrays and numbers of a model, in order."""
    if not isinstance(model, tuple):
        return [model]
    return [leaf for part in model for leaf in arrays_of(part)]


def test_every_rival_is_tested():
    assert {type(settings) for settings, _ in SMALL.values()} == set(RIVALS)


def test_joints_of_similar_people_are_found(rival, estimator, people):
    summary = summarise(evaluate(estimator, people[120:150]), 0.1)
    assert list(summary.joints) == names_of(JOINTS)
    assert summary.joints['head'].ap > 0.9
    assert summary.map > rival[2]


def test_confidence_is_a_fraction_and_the_estimate_repeatable(estimator, people):
    frame = people[130]
    first = estimator.estimate(frame.depth, frame.labels, frame.camera)
    again = estimator.estimate(frame.depth, frame.labels, frame.camera)
    np.testing.assert_array_equal(first.positions, again.positions)
    assert ((first.confidence >= 0) & (first.confidence <= 1)).all()


def test_training_is_repeatable(rival, people):
    system, settings, _ = rival
    frames = sample_frames(people[:20], 1000, (0,)).frames
    first, second = (system.train(frames, JOINTS, settings, 4) for _ in range(2))
    for one, other in zip(arrays_of(first), arrays_of(second), strict=True):
        np.testing.assert_array_equal(one, other)


def test_body_without_depth_has_no_joints(estimator, people):
    frame = people[0]
    found = estimator.estimate(np.zeros_like(frame.depth), frame.labels, frame.camera)
    assert len(found.bodies) == 1
    assert np.isnan(found.positions).all()
    assert (found.confidence == 0).all()


def test_image_without_bodies_has_no_skeletons(estimator, people):
    frame = people[0]
    found = estimator.estimate(frame.depth, np.full_like(frame.labels, NO_BODY), frame.camera)
    assert found.positions.shape == (0, len(JOINTS), 3)


def test_joints_that_are_never_labelled_are_left_out(rival, people):
    system, settings, _ = rival
    truth = people[0].ground_truth
    kept = [n for n, joint in enumerate(truth.joints) if joint != JOINTS[-1]]
    less = truth._replace(
        joints=truth.joints[kept],
        positions=truth.positions[:, kept],
        confidence=truth.confidence[:, kept],
    )
    sample = sample_frames([people[0]._replace(ground_truth=less)], 1, (0,)).frames
    model = system.train(sample, JOINTS, settings, 0)
    assert model.joints.tolist() == JOINTS[:-1].tolist()
    assert system.make(model).joints.tolist() == JOINTS[:-1].tolist()


def test_frames_without_people_teach_nothing(rival, people):
    system, settings, _ = rival
    nobody = people[0]._replace(labels=np.full_like(people[0].labels, NO_BODY))
    sample = sample_frames([nobody], 1, (0,)).frames
    with pytest.raises(InputError, match='no labelled person is visible'):
        system.train(sample, JOINTS, settings, 0)
