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

"""The body part at a point of a person whose joints are known."""

import numpy as np
import pytest
from lsc_pose_experiments.shotton.part_labels import (
    EXTENT,
    Bones,
    bones_of,
    nearest_bones,
    parts_at,
)

from lsc_pose_ros.body_parts.classes import NOT_A_PERSON
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS


def distance_to(point: np.ndarray, bones: Bones, bone: int, fraction: float) -> float:
    """Return the distance of a point from the surface of a bone around one of its points."""
    start, end = bones.positions[bone].astype(float)
    return np.linalg.norm(point - start - fraction * (end - start)) - bones.radii[bone]


def twin(point: np.ndarray, bones: Bones) -> float:
    """Return the distance of a point from the nearest surface of a bone."""
    distances = [np.inf]
    for bone, (start, end) in enumerate(bones.positions.astype(float)):
        direction = end - start
        squared = direction @ direction
        along = float(np.clip((point - start) @ direction / squared, 0, 1)) if squared else 0.0
        distances.append(distance_to(point, bones, bone, along))
    return min(distances)


def joints_at(**positions: tuple[float, float, float]) -> np.ndarray:
    """Return the positions of all joints, NaN for those without one."""
    joints = np.full((len(JOINT_NAMES), 3), np.nan, np.float32)
    for name, position in positions.items():
        joints[JOINT_NUMBERS[name]] = position
    return joints


@pytest.mark.parametrize('seed', range(6))
def test_nearest_bones_equal_the_plain_ones(seed):
    rng = np.random.default_rng(seed)
    joints = rng.normal(0, 0.5, (len(JOINT_NAMES), 3)).astype(np.float32)
    joints[rng.random(len(joints)) < 0.15 * seed] = np.nan  # the last have few bones
    if seed == 3:
        joints[5] = joints[4]  # a bone of length 0
    bones = bones_of(joints)
    points = rng.normal(0, 0.7, (200, 3)).astype(np.float32)
    points[:5], points[5] = np.nan_to_num(joints[:5]), 9.0
    nearest, fraction = nearest_bones(points, bones, 0.25)
    for n, point in enumerate(points.astype(float)):
        least = twin(point, bones)
        if nearest[n] < 0:
            assert least > 0.25 - 1e-5
        else:  # two bones may be equally near
            found = distance_to(point, bones, nearest[n], fraction[n])
            assert found == pytest.approx(least, abs=1e-5)
            assert found < 0.25
    assert nearest[5] == -1


def test_no_bone_is_near_without_labelled_joints():
    nothing = joints_at()
    points = np.zeros((3, 3), np.float32)
    assert len(bones_of(nothing).ends) == 0
    assert parts_at(points, nothing).tolist() == [NOT_A_PERSON] * 3
    assert parts_at(points[:0], joints_at(head=(0, 0, 0))).shape == (0,)


def test_single_joint_has_a_part():
    joints = joints_at(head=(0, 0, 2))
    points = np.array([[0, 0.1, 2], [0, 0.7, 2]], np.float32)
    assert parts_at(points, joints).tolist() == [1 + JOINT_NUMBERS['head'], NOT_A_PERSON]


def test_torso_and_pelvis_are_connected():
    ends = bones_of(joints_at(torso=(0, 0, 2), pelvis=(0, 0.2, 2))).ends
    assert ends.tolist() == [[JOINT_NUMBERS['torso'], JOINT_NUMBERS['pelvis']]]


def test_part_is_that_of_the_nearest_end_of_the_bone():
    joints = joints_at(l_elbow=(0, 0, 2), l_wrist=(0, 0.4, 2))
    heights = np.array([0.0, EXTENT - 0.01, 0.2, 0.41 - EXTENT, 0.45], np.float32)
    points = np.stack([np.full(5, 0.03), heights, np.full(5, 2.0)], axis=1).astype(np.float32)
    elbow, wrist = 1 + JOINT_NUMBERS['l_elbow'], 1 + JOINT_NUMBERS['l_wrist']
    assert parts_at(points, joints).tolist() == [elbow, elbow, NOT_A_PERSON, wrist, wrist]


def test_point_on_a_thigh_is_not_of_the_hand_beside_it():
    joints = joints_at(
        l_wrist=(0.15, 0, 2), l_hand=(0.15, 0.1, 2), l_hip=(0, -0.05, 2), l_knee=(0, 0.4, 2)
    )
    point = np.array(
        [[0.08, 0.02, 2.0]], np.float32
    )  # 8 cm from the thigh's bone, 7 from the hand's
    assert parts_at(point, joints).tolist() == [1 + JOINT_NUMBERS['l_hip']]
