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

"""Offsets between a model's joints and other labels, against plain numpy."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.data_types.visibility import UNKNOWN
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation.evaluate import (
    Evaluation,
    joint_differences,
    joint_errors,
    select,
    summarise,
)
from lsc_pose_ros.evaluation.offsets import apply_offsets, fit_offsets

JOINTS = numbers_of(['head', 'neck', 'l_hand', 'r_hand'])
PEOPLE = 51


def skeletons(positions):
    confidence = np.isfinite(positions[..., 0]).astype(np.float32)
    bodies = np.arange(1, len(positions) + 1, dtype=np.uint16)
    return Skeletons(bodies, JOINTS, positions.astype(np.float32), confidence)


def evaluation_of(ground_truth, estimate):
    return Evaluation(
        JOINTS,
        joint_errors(skeletons(estimate), skeletons(ground_truth)),
        np.arange(len(ground_truth)),
        np.ones(len(ground_truth), np.uint16),
        np.full(len(ground_truth), 0.01),
        np.ones(ground_truth.shape[:2], np.float32),
        joint_differences(skeletons(estimate), skeletons(ground_truth)),
        np.full(ground_truth.shape[:2], UNKNOWN, np.uint8),
    )


@pytest.fixture
def positions():
    """Ground truth, and estimates with a constant offset, noise, and some errors of a metre."""
    random = np.random.default_rng(8)
    ground_truth = random.normal(0, 1, (PEOPLE, len(JOINTS), 3))
    constant = random.normal(0, 0.1, (len(JOINTS), 3))
    estimate = ground_truth - constant + random.normal(0, 0.01, ground_truth.shape)
    estimate[::5] += 1.0
    ground_truth[3:9, 1] = np.nan  # not labelled
    estimate[7:20, 2] = np.nan  # not estimated
    return ground_truth, estimate, constant


def test_offsets_are_medians_of_ground_truth_minus_estimate(positions):
    ground_truth, estimate, constant = positions
    offsets = fit_offsets(evaluation_of(ground_truth, estimate))
    expected = np.nanmedian(ground_truth - estimate, axis=0)
    np.testing.assert_allclose(offsets, expected, atol=1e-6)
    np.testing.assert_allclose(offsets, constant, atol=0.02)  # whatever is off by a metre
    assert offsets.dtype == np.float32


def test_errors_are_those_of_moved_estimates(positions):
    ground_truth, estimate, _ = positions
    before = evaluation_of(ground_truth, estimate)
    offsets = fit_offsets(before)
    moved = apply_offsets(before, offsets)
    again = evaluation_of(ground_truth, estimate + offsets)
    np.testing.assert_allclose(moved.errors, again.errors, atol=1e-5)
    np.testing.assert_allclose(moved.differences, again.differences, atol=1e-5)
    assert np.isinf(moved.errors[7:20, 2]).all()
    assert np.isnan(moved.errors[3:9, 1]).all()
    assert summarise(moved, 0.1).map > summarise(before, 0.1).map
    np.testing.assert_allclose(fit_offsets(moved), 0, atol=1e-6)


def test_joint_that_is_never_seen_has_no_offset_and_stays(positions):
    ground_truth, estimate, _ = positions
    ground_truth[:, 0] = np.nan
    estimate[:, 3] = np.nan
    offsets = fit_offsets(evaluation_of(ground_truth, estimate))
    assert np.isnan(offsets[[0, 3]]).all()
    assert np.isfinite(offsets[[1, 2]]).all()
    ground_truth, estimate = np.zeros((2, 4, 3)), np.full((2, 4, 3), 0.03)
    moved = apply_offsets(evaluation_of(ground_truth, estimate), offsets)
    np.testing.assert_allclose(moved.errors[:, [0, 3]], np.sqrt(3) * 0.03, rtol=1e-5)


def test_some_joints_only(positions):
    ground_truth, estimate, _ = positions
    whole = evaluation_of(ground_truth, estimate)
    hands = select(whole, numbers_of(['r_hand', 'l_hand']))
    assert hands.joints.tolist() == numbers_of(['l_hand', 'r_hand']).tolist()
    for name in ('errors', 'confidence', 'differences'):
        np.testing.assert_array_equal(getattr(hands, name), getattr(whole, name)[:, 2:])
    assert set(summarise(hands, 0.1).joints) == {'l_hand', 'r_hand'}
    with pytest.raises(InputError, match='does not estimate pelvis, l_foot; its joints are head'):
        select(whole, numbers_of(['head', 'l_foot', 'pelvis']))
