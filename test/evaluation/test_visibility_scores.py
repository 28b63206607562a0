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

"""Scores by visibility, compared with plain sums."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS, numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.data_types.visibility import HIDDEN, OUTSIDE, SEEN, UNKNOWN, VISIBILITIES
from lsc_pose_ros.evaluation.evaluate import Evaluation, visibility_of
from lsc_pose_ros.evaluation.visibility_scores import score_by_visibility


def an_evaluation(visibility: np.ndarray, errors: np.ndarray) -> Evaluation:
    people = len(errors)
    return Evaluation(
        numbers_of(['head', 'neck', 'torso']),
        errors.astype(np.float32),
        np.arange(people),
        np.ones(people, np.uint16),
        np.full(people, 0.01),
        np.linspace(0, 1, errors.size, dtype=np.float32).reshape(errors.shape),
        np.full((*errors.shape, 3), np.nan, np.float32),
        visibility.astype(np.uint8),
    )


def test_each_visibility_has_its_score() -> None:
    rng = np.random.default_rng(0)
    visibility = rng.choice([*VISIBILITIES, UNKNOWN], (50, 3))
    errors = rng.uniform(0, 0.3, (50, 3))
    errors[rng.random(errors.shape) < 0.1] = np.nan
    errors[rng.random(errors.shape) < 0.1] = np.inf
    evaluation = an_evaluation(visibility, errors)
    scores = score_by_visibility(evaluation, 0.1)
    assert list(scores) == list(VISIBILITIES.values())
    for number, name in VISIBILITIES.items():
        kept, confident = [], []
        for v, error, confidence in zip(
            visibility.ravel(), errors.ravel(), evaluation.confidence.ravel(), strict=True
        ):
            if v == number and not np.isnan(error):
                kept.append(error)
                confident.append(float(confidence))
        score = scores[name]
        assert score.n == len(kept) > 0
        assert score.ap == pytest.approx(sum(error <= 0.1 for error in kept) / len(kept))
        finite = [error for error in kept if np.isfinite(error)]
        assert score.mean_error_m == pytest.approx(sum(finite) / len(finite), rel=1e-5)
        assert score.mean_confidence == pytest.approx(sum(confident) / len(confident), rel=1e-5)


def test_a_visibility_without_estimates_has_no_error() -> None:
    evaluation = an_evaluation(np.full((2, 3), HIDDEN), np.full((2, 3), np.inf))
    score = score_by_visibility(evaluation, 0.1)['hidden by something else']
    assert np.isnan(score.mean_error_m)
    assert (score.ap, score.n) == (0, 6)


def test_unknown_visibility_has_no_score() -> None:
    assert not score_by_visibility(an_evaluation(np.full((2, 3), UNKNOWN), np.ones((2, 3))), 0.1)


def test_visibility_follows_the_joints_of_the_model() -> None:
    joints = np.array([JOINT_NUMBERS['torso'], JOINT_NUMBERS['head']], np.uint16)
    truth = Skeletons(
        np.array([4], np.uint16),
        joints,
        np.zeros((1, 2, 3), np.float32),
        np.ones((1, 2), np.float32),
        np.array([[OUTSIDE, SEEN]], np.uint8),
    )
    wanted = numbers_of(['head', 'neck', 'torso'])
    assert visibility_of(truth, wanted).tolist() == [[SEEN, UNKNOWN, OUTSIDE]]
    assert (visibility_of(truth._replace(visibility=None), wanted) == UNKNOWN).all()
