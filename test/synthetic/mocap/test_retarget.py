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

"""Tests the retargeting of motion to a body."""

import numpy as np
from captured_poses import possible_pose, turn
from scipy.spatial.transform import Rotation

from lsc_pose_ros.synthetic.body.body_mesh import (
    pose_body,
    standing_orientations,
)
from lsc_pose_ros.synthetic.geometry.rotations import from_quaternions
from lsc_pose_ros.synthetic.mocap.mocap_mapping import SEGMENTS
from lsc_pose_ros.synthetic.mocap.retarget import retarget_motion


def test_bones_share_the_rotation_of_segments(clip_of, body, rest):
    random = np.random.default_rng(5)
    clip = clip_of([possible_pose(random) for _ in range(10)], frame_time=1.0)
    segments = from_quaternions(clip.orientations.astype(float))
    poses = retarget_motion(body, rest, segments)
    standing = standing_orientations(body, rest)
    orientations = np.array(
        [pose_body(body, rest, pose, np.zeros(3)).orientations for pose in poses]
    )
    numbers = {str(name): number for number, name in enumerate(body.bones)}
    whole = {
        'root': 'pelvis', 'spine01': 'chest', 'head': 'head', 'upperarm02.L': 'l_upper_arm',
        'wrist.R': 'r_hand', 'finger2-3.R': 'r_hand', 'upperleg01.R': 'r_thigh',
        'lowerleg02.L': 'l_shank', 'toes.L': 'l_foot',
    }  # fmt: skip
    for bone, segment in whole.items():
        expected = segments[:, SEGMENTS.index(segment)] @ standing[numbers[bone]]
        np.testing.assert_allclose(orientations[:, numbers[bone]], expected, atol=1e-6)
    # The rotation of the trunk's bones increases from the pelvis to the chest.
    spine = [orientations[:, numbers[f'spine0{number}']] for number in (5, 4, 3, 2, 1)]
    away = [
        Rotation.from_matrix(segments[:, 0].transpose(0, 2, 1) @ bone).magnitude()
        for bone in spine
    ]
    assert away[0].max() < 0.6 * away[-1].max()


def test_shoulder_rises_by_a_third_of_the_elevation_beyond_30_degrees(body, rest):
    segments = np.tile(np.eye(3), (3, len(SEGMENTS), 1, 1))
    for number, degrees in enumerate((20, 90, 150)):
        raised = turn([0, 0, 1], degrees).as_matrix()
        for name in ('l_upper_arm', 'l_forearm', 'l_hand'):
            segments[number, SEGMENTS.index(name)] = raised
    rotations = retarget_motion(body, rest, segments)
    orientations = np.array(
        [pose_body(body, rest, pose, np.zeros(3)).orientations for pose in rotations]
    )
    blade = orientations[:, list(body.bones).index('shoulder01.L')]
    found = np.degrees(Rotation.from_matrix(blade).as_rotvec()[:, 2])
    np.testing.assert_allclose(found, [0, 20, 40], atol=1e-6)
    other = orientations[:, list(body.bones).index('shoulder01.R')]
    np.testing.assert_allclose(other, np.tile(np.eye(3), (3, 1, 1)), atol=1e-9)
