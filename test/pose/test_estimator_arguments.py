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

"""What the estimator accepts, and what it refuses."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.conversion import labels_from_mask, metres_from_millimetres
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.estimation.temporal import TemporalEstimator
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.settings.table import TemporalSettings


@pytest.fixture(scope='module')
def estimator(small_model):
    return Estimator(small_model)


def test_model_must_be_a_model():
    with pytest.raises(InputError, match=r'model is of type str.*load_model'):
        Estimator('default')


def test_other_layouts_give_the_same_joints(estimator, people):
    frame = people[20]
    expected = estimator.estimate(*frame[2:5])
    for depth, labels in (
        (frame.depth.astype(np.float64), frame.labels.astype(np.int64)),
        (np.asfortranarray(frame.depth), np.asfortranarray(frame.labels)),
    ):
        found = estimator.estimate(depth, labels, frame.camera)
        np.testing.assert_array_equal(found.positions, expected.positions)
        np.testing.assert_array_equal(found.confidence, expected.confidence)
        body = estimator.estimate_body(depth, labels, frame.camera, 1)
        np.testing.assert_array_equal(body.joints, expected.positions[0])


def test_converted_millimetres_and_mask_give_the_same_joints(estimator, people):
    frame = people[20]
    millimetres = np.rint(frame.depth * 1000).astype(np.uint16)
    mask = np.where(frame.labels == NO_BODY, 0, 1).astype(np.uint8)
    found = estimator.estimate(
        metres_from_millimetres(millimetres), labels_from_mask(mask), frame.camera
    )
    expected = estimator.estimate(*frame[2:5])
    assert found.bodies.tolist() == [1]
    np.testing.assert_allclose(found.positions, expected.positions, atol=0.02)


def test_millimetres_are_refused(estimator, people):
    frame = people[20]
    for millimetres in (np.rint(frame.depth * 1000).astype(np.uint16), frame.depth * 1000):
        with pytest.raises(InputError, match=r'depth .*metres_from_millimetres'):
            estimator.estimate(millimetres, frame.labels, frame.camera)


@pytest.mark.parametrize('kind', [np.bool_, np.uint8, np.int32, np.int64])
def test_mask_with_background_zero_is_refused(estimator, people, kind):
    frame = people[20]
    mask = (frame.labels != NO_BODY).astype(kind)
    with pytest.raises(InputError, match=r'labels .*labels_from_mask'):
        estimator.estimate(frame.depth, mask, frame.camera)


def test_body_zero_is_a_body(estimator, people):
    frame = people[20]
    labels = np.where(frame.labels == NO_BODY, NO_BODY, 0)
    found = estimator.estimate(frame.depth, labels, frame.camera)
    assert found.bodies.tolist() == [0]
    np.testing.assert_array_equal(found.positions, estimator.estimate(*frame[2:5]).positions)


def test_body_number_must_fit_the_message(estimator, people):
    frame = people[20]
    labels = np.where(frame.labels == NO_BODY, NO_BODY, 2**31 - 1)
    with pytest.raises(InputError, match='body number 2147483647'):
        estimator.estimate(frame.depth, labels, frame.camera)


@pytest.mark.parametrize('invalid', [np.nan, np.inf, -np.inf, -1.0])
def test_invalid_depth_is_no_depth(estimator, people, invalid):
    frame = people[20]
    body = frame.labels != NO_BODY
    holes = body & (np.random.default_rng(0).random(body.shape) < 0.05)
    zero, other = frame.depth.copy(), frame.depth.copy()
    zero[holes], other[holes] = 0, invalid
    found, expected = (
        estimator.estimate(depth, frame.labels, frame.camera) for depth in (other, zero)
    )
    np.testing.assert_array_equal(found.positions, expected.positions)


def test_successive_frames_are_checked_likewise(estimator, people):
    frame = people[20]
    temporal = TemporalEstimator(estimator, TemporalSettings())
    with pytest.raises(InputError, match='metres_from_millimetres'):
        temporal.estimate(0, frame.depth.astype(np.uint16), frame.labels, frame.camera)
