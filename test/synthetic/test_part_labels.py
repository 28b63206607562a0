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

"""Tests the body parts of synthetic scenes."""

import numpy as np
import pytest

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.synthetic.body.body_file import load_body
from lsc_pose_ros.synthetic.body.skin_parts import NO_PART, skin_parts
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames, synthetic_scenes
from lsc_pose_ros.synthetic.scene.pixel_codes import pixel_codes, split_codes


def test_each_joint_has_a_part_of_the_skin_near_it() -> None:
    body = load_body()
    parts = skin_parts(body)
    assert set(parts.tolist()) == set(range(1, 1 + len(JOINT_NAMES)))
    points = body.mean.astype(np.float64)
    joints = points[len(points) - len(JOINT_NAMES) :]
    middles = points[body.triangles].mean(axis=1)
    distances = np.linalg.norm(middles - joints[parts - 1], axis=1)
    assert distances.max() < 0.3
    for part, joint in enumerate(joints, start=1):
        own = middles[parts == part]
        assert np.linalg.norm(own.mean(axis=0) - joint) < 0.12


def test_parts_of_the_left_and_of_the_right_side_mirror_each_other() -> None:
    body = load_body()
    parts = skin_parts(body)
    middles = body.mean[body.triangles].mean(axis=1)
    for name in JOINT_NAMES:
        if not name.startswith('l_'):
            continue
        left = parts == 1 + JOINT_NUMBERS[name]
        right = parts == 1 + JOINT_NUMBERS[f'r{name[1:]}']
        assert left.sum() == pytest.approx(right.sum(), rel=0.02)
        assert (middles[left, 0] > -0.01).all()
        assert (middles[right, 0] < 0.01).all()


def test_codes_are_split_into_body_and_part() -> None:
    codes = np.array([[NO_BODY, 0], [0, 0]], np.int32)
    codes[0, 1:] = pixel_codes(1, np.array([20], np.int32))
    codes[1] = pixel_codes(8, np.array([1, 20], np.int32))
    labels, parts = split_codes(codes)
    assert labels.tolist() == [[NO_BODY, 1], [8, 8]]
    assert parts.tolist() == [[NO_PART, 20], [1, 20]]


@pytest.mark.parametrize('sensor', ['kinect_v1', 'azure', 'realsense'])
def test_parts_agree_with_the_labels_of_the_frame(sensor: str) -> None:
    settings = SyntheticSettings(
        frames=6, clip_length=3, people=2, sensor=sensor, distance=(2.0, 5.0), background=True
    )
    for scene, frame in zip(synthetic_scenes(settings), synthetic_frames(settings), strict=True):
        np.testing.assert_array_equal(scene.frame.depth, frame.depth)
        np.testing.assert_array_equal(scene.frame.labels, frame.labels)
        assert scene.parts.dtype == np.uint8
        np.testing.assert_array_equal(scene.parts != NO_PART, frame.labels != NO_BODY)


def test_joints_project_to_their_parts() -> None:
    settings = SyntheticSettings(frames=30, clip_length=3, noise='none', yaw=180.0)
    hits = np.zeros(len(JOINT_NAMES))
    for scene in synthetic_scenes(settings):
        assert scene.frame.ground_truth is not None
        joints = scene.frame.ground_truth.positions[0]
        columns, rows = np.rint(project(joints, scene.frame.camera)).astype(int).T
        hits += scene.parts[rows, columns] == 1 + np.arange(len(JOINT_NAMES))
    assert hits.mean() > 0.6 * 30
    assert hits[JOINT_NUMBERS['head']] > 0.8 * 30
