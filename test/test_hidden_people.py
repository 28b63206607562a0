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

"""The card's figures of people who are hidden, cut off or seated."""

import sys
from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.data_types.visibility import HIDDEN, OUTSIDE, SEEN, UNKNOWN
from lsc_pose_ros.evaluation.evaluate import Evaluation

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'models'))

from hidden_people import hidden_people_scores, hip_angle_of


@pytest.mark.parametrize('angle', [0, 60, 90, 180])
def test_the_hip_angle_is_that_between_trunk_and_thighs(angle: float) -> None:
    positions = np.zeros((1, 20, 3), np.float32)
    positions[0, JOINT_NUMBERS['neck'], 1] = -0.5
    thigh = 0.4 * np.array([0, -np.cos(np.radians(angle)), -np.sin(np.radians(angle))])
    for side, x in (('l', 0.1), ('r', -0.1)):
        positions[0, JOINT_NUMBERS[f'{side}_hip']] = x, 0, 0
        positions[0, JOINT_NUMBERS[f'{side}_knee']] = np.add(thigh, (x, 0, 0))
    body = Skeletons(
        np.array([1], np.uint16),
        np.arange(20, dtype=np.uint16),
        positions,
        np.ones((1, 20), np.float32),
    )
    np.testing.assert_allclose(hip_angle_of(body), angle, atol=0.05)


def test_people_are_grouped_by_what_the_camera_sees_of_them() -> None:
    visibility = np.full((6, 20), SEEN, np.uint8)
    visibility[2, :10] = HIDDEN
    visibility[3, :10] = OUTSIDE
    visibility[4] = UNKNOWN
    visibility[5] = HIDDEN  # nothing of this one is seen
    hip_angle = np.array([170, 90, 170, 170, 170, 170.0])
    errors = np.full((6, 20), 0.05, np.float32)
    errors[2, :10] = 0.5
    errors[3, 5:15] = np.inf
    errors[0, 0] = np.nan
    confidence = np.linspace(0, 1, 120, dtype=np.float32).reshape(6, 20)
    evaluation = Evaluation(
        np.arange(len(JOINT_NAMES), dtype=np.uint16),
        errors,
        np.arange(6),
        np.ones(6, np.uint16),
        np.full(6, 0.01),
        confidence,
        np.full((6, 20, 3), np.nan, np.float32),
        visibility,
    )
    rows = hidden_people_scores(evaluation, hip_angle, 0.1)
    assert list(rows) == [
        'whole, standing',
        'whole, hips bent (seated, crouched)',
        'half hidden by something',
        'half cut off by the image',
    ]
    assert [row['people'] for row in rows.values()] == [1, 1, 1, 1]
    whole, _, hidden, cut = rows.values()
    assert (whole['seen'], whole['unseen']) == (1, None)
    assert whole['seen_confidence'] == pytest.approx(confidence[0, 1:].mean())
    assert (hidden['seen'], hidden['unseen'], hidden['all']) == (1, 0, 0.5)
    assert hidden['unseen_confidence'] == pytest.approx(confidence[2, :10].mean())
    assert (cut['seen'], cut['unseen']) == (0.5, 0.5)
