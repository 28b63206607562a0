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

"""The reliability of the confidence."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.data_types.visibility import UNKNOWN
from lsc_pose_ros.evaluation.confidence_reliability import (
    bin_by_confidence,
    expected_error,
    measure_reliability,
)
from lsc_pose_ros.evaluation.evaluate import Evaluation, joint_confidence

NAN, INF = float('nan'), float('inf')


def evaluation(errors, confidence):
    return Evaluation(
        numbers_of(['head', 'neck', 'torso'])[: np.shape(errors)[1]],
        np.array(errors, np.float32),
        np.arange(len(errors)),
        np.ones(len(errors), np.uint16),
        np.full(len(errors), 0.01),
        np.array(confidence, np.float32),
        np.full((*np.shape(errors), 3), NAN, np.float32),
        np.full(np.shape(errors), UNKNOWN, np.uint8),
    )


def test_bins_count_what_is_near():
    bins = bin_by_confidence(
        np.array([0.0, 0.05, 0.72, 0.78, 1.0]), np.array([False, True, True, False, True])
    )
    assert [(each.least, each.most, each.n) for each in bins] == [
        (0.0, 0.1, 2),
        (0.7, 0.8, 2),
        (0.9, 1.0, 1),
    ]
    assert [each.confidence for each in bins] == pytest.approx([0.025, 0.75, 1.0])
    assert [each.fraction for each in bins] == pytest.approx([0.5, 0.5, 1.0])
    assert expected_error(bins) == pytest.approx((2 * 0.475 + 2 * 0.25 + 0) / 5)


def test_errors_of_joints_add_up_and_unlabelled_ones_do_not_count():
    found = measure_reliability(
        evaluation(
            [[0.05, 0.3, NAN], [0.2, NAN, NAN], [INF, 0.01, NAN]],
            [[0.95, 0.95, 0.5], [0.95, 0.1, 0.5], [0.0, 0.95, 0.5]],
        )
    )
    assert found.within_m == 0.1
    assert found.joints == pytest.approx({'head': 0.9 / 3, 'neck': 0.45})
    assert found.ece == pytest.approx(4 / 5 * 0.45)
    assert found.brier == pytest.approx((2 * 0.05**2 + 2 * 0.95**2) / 5)
    assert sum(each.n for each in found.bins) == 5


def test_honest_confidence_has_no_error_and_an_overconfident_one_has():
    rng = np.random.default_rng(3)
    confidence = rng.random((20_000, 1))
    errors = np.where(rng.random(confidence.shape) < confidence, 0.05, 0.3)
    assert measure_reliability(evaluation(errors, confidence)).ece < 0.015
    assert measure_reliability(evaluation(errors, np.sqrt(confidence))).ece > 0.1


def test_confidences_are_matched_by_body():
    def skeletons(bodies, confidence):
        confidence = np.array(confidence, np.float32)
        return Skeletons(
            np.array(bodies, np.uint16),
            numbers_of(['head', 'neck']),
            np.zeros((*confidence.shape, 3), np.float32),
            confidence,
        )

    ground_truth = skeletons([3, 5, 8], np.ones((3, 2)))
    found = skeletons([5, 3], [[0.1, 0.2], [0.3, 0.4]])
    np.testing.assert_allclose(
        joint_confidence(found, ground_truth), [[0.3, 0.4], [0.1, 0.2], [0, 0]]
    )
