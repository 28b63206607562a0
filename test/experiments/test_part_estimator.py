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

"""Shotton et al. as a whole."""

import numpy as np
import pytest
from lsc_pose_experiments.sampled_frames import sample_frames
from lsc_pose_experiments.shotton.part_estimator import PartEstimator
from lsc_pose_experiments.shotton.part_model_training import PartModelSettings, train_part_model
from lsc_pose_experiments.shotton.part_tree_growth import PartGrowth

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import names_of, numbers_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation.evaluate import evaluate, summarise

JOINTS = numbers_of(['head', 'neck', 'l_shoulder', 'r_shoulder', 'l_knee', 'r_hand'])
SMALL = PartModelSettings(2, PartGrowth(14, features=60), 300, 100)


@pytest.fixture(scope='module')
def estimator(people):
    """An estimator that has learned from 120 frames."""
    frames = sample_frames(people[:120], 1000, (0,)).frames
    return PartEstimator(train_part_model(frames, JOINTS, SMALL, 0))


def test_joints_of_similar_people_are_found(estimator, people):
    summary = summarise(evaluate(estimator, people[120:150]), 0.1)
    assert list(summary.joints) == names_of(JOINTS)
    assert summary.joints['head'].ap > 0.9
    assert summary.map > 0.6


def test_training_is_repeatable(people):
    frames = sample_frames(people[:20], 1000, (0,)).frames
    models = [train_part_model(frames, JOINTS, SMALL, 4) for _ in range(2)]
    for first, second in zip(*(model.forest for model in models), strict=True):
        np.testing.assert_array_equal(first, second)
    assert models[0].proposals == models[1].proposals


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


def test_joints_that_are_never_labelled_are_left_out(people):
    frame = people[0]
    kept = [n for n, joint in enumerate(frame.ground_truth.joints) if joint != JOINTS[-1]]
    truth = frame.ground_truth
    less = truth._replace(
        joints=truth.joints[kept],
        positions=truth.positions[:, kept],
        confidence=truth.confidence[:, kept],
    )
    sample = sample_frames([frame._replace(ground_truth=less)], 1, (0,)).frames
    model = train_part_model(sample, JOINTS, SMALL, 0)
    assert model.joints.tolist() == JOINTS[:-1].tolist()
    assert len(model.proposals) == len(JOINTS) - 1


def test_frames_without_people_teach_nothing(people):
    nobody = people[0]._replace(labels=np.full_like(people[0].labels, NO_BODY))
    sample = sample_frames([nobody], 1, (0,)).frames
    with pytest.raises(InputError, match='no labelled person is visible'):
        train_part_model(sample, JOINTS, SMALL, 0)
