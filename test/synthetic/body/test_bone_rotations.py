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

"""Tests that each clinical angle rotates the right part in the right direction."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.synthetic.body.body_file import load_body
from lsc_pose_ros.synthetic.body.body_mesh import (
    BodyShape,
    pose_body,
    relative_rotations,
    shape_body,
    standing_orientations,
)
from lsc_pose_ros.synthetic.body.bone_rotations import (
    bone_heads,
    bone_orientations,
    pose_rotations,
    rig_of,
)
from lsc_pose_ros.synthetic.motion.joint_angles import (
    ANGLE_NUMBERS,
    ANGLES,
    LOWER_LIMITS,
    UPPER_LIMITS,
    arms_to_cartesian,
    arms_to_polar,
    max_elevation,
    mirrored,
    within_limits,
)

FIGURES = (BodyShape(30, 1.0), BodyShape(5, 0.5), BodyShape(50, 0.0, weight=0.9))


@pytest.fixture(scope='module')
def body():
    return load_body()


@pytest.fixture(scope='module', params=FIGURES)
def rest(request, body):
    return shape_body(body, request.param)


def pose_of(**degrees):
    angles = np.zeros(len(ANGLES))
    for name, value in degrees.items():
        angles[ANGLE_NUMBERS[name]] = np.radians(value)
    return angles


def random_poses(count):
    random = np.random.default_rng(4)
    return within_limits(
        LOWER_LIMITS + (UPPER_LIMITS - LOWER_LIMITS) * random.random((count, len(ANGLES)))
    )


def joints_of(body, rest, **degrees):
    rotations = pose_rotations(rig_of(body, rest), pose_of(**degrees))[0]
    joints = pose_body(body, rest, rotations, np.zeros(3)).joints
    return dict(zip(JOINT_NAMES, joints, strict=True))


def direction(joints, start, end):
    way = joints[end] - joints[start]
    return way / np.linalg.norm(way)


def test_zero_angles_give_the_standing_pose(body, rest):
    rotations = pose_rotations(rig_of(body, rest), np.zeros((1, len(ANGLES))))[0]
    expected = relative_rotations(body, standing_orientations(body, rest))
    shoulders = [
        number
        for number, name in enumerate(map(str, body.bones))
        if name.startswith(('clavicle', 'shoulder', 'upperarm01'))
    ]
    others = np.setdiff1d(np.arange(len(body.bones)), shoulders)
    np.testing.assert_allclose(rotations[others], expected[others], atol=1e-12)
    # Shoulders are slightly lower than with half raised arms.
    cosine = (np.trace(rotations[shoulders[0]]) - 1) / 2
    assert 1 < np.degrees(np.arccos(cosine)) < 6


@pytest.mark.parametrize(
    ('angles', 'start', 'end', 'expected'),
    [
        ({'l_elevation': 90}, 'l_shoulder', 'l_elbow', (1, 0, 0)),
        ({'r_elevation': 90}, 'r_shoulder', 'r_elbow', (-1, 0, 0)),
        ({'r_plane': 90, 'r_elevation': 90}, 'r_shoulder', 'r_elbow', (0, 0, 1)),
        ({'l_plane': -90, 'l_elevation': 45}, 'l_shoulder', 'l_elbow', (0, -0.7071, -0.7071)),
        ({'l_elbow': 90}, 'l_elbow', 'l_wrist', (0, 0, 1)),
        ({'l_elbow': 90, 'l_axial': 90}, 'l_elbow', 'l_wrist', (1, 0, 0)),
        ({'r_elbow': 90, 'r_axial': -70}, 'r_elbow', 'r_wrist', (0.9397, 0, 0.3420)),
        ({'r_wrist_flexion': 90}, 'r_wrist', 'r_hand', (1, 0, 0)),
        ({'l_wrist_deviation': 90}, 'l_wrist', 'l_hand', (0, 0, 1)),
        ({'l_hip_flexion': 90}, 'l_hip', 'l_knee', (0, 0, 1)),
        ({'r_hip_abduction': 30}, 'r_hip', 'r_knee', (-0.5, -0.8660, 0)),
        ({'r_knee': 90}, 'r_knee', 'r_ankle', (0, 0, -1)),
        ({'l_hip_flexion': 90, 'l_knee': 90, 'l_hip_rotation': 30}, 'l_knee', 'l_ankle',
         (-0.5, -0.8660, 0)),
    ],
)  # fmt: skip
def test_each_angle_rotates_its_limb(body, rest, angles, start, end, expected):
    joints = joints_of(body, rest, **angles)
    np.testing.assert_allclose(direction(joints, start, end), expected, atol=0.15)


@pytest.mark.parametrize(
    ('name', 'joint', 'axis', 'sign'),
    [
        ('lean', 'head', 2, 1), ('bend', 'head', 2, 1), ('nod', 'head', 2, 1),
        ('list', 'head', 0, 1), ('side', 'head', 0, 1), ('tilt', 'head', 0, 1),
        ('twist', 'l_shoulder', 2, -1), ('l_shrug', 'l_shoulder', 1, 1),
        ('l_ankle', 'l_foot', 1, -1), ('r_pronation', 'r_wrist', 0, 0),
    ],
)  # fmt: skip
def test_trunk_angles_move_head_and_shoulders_in_the_right_direction(
    body, rest, name, joint, axis, sign
):
    before, after = joints_of(body, rest), joints_of(body, rest, **{name: 15})
    moved = (after[joint] - before[joint])[axis]
    assert abs(moved) < 1e-3 if sign == 0 else sign * moved > 0.005


def test_shoulder_rises_with_the_arm(body, rest):
    height = [joints_of(body, rest, l_elevation=up)['l_shoulder'][1] for up in (0, 30, 90, 170)]
    assert height[0] == pytest.approx(height[1], abs=1e-6)
    reach = np.linalg.norm(rest.joints[JOINT_NUMBERS['l_shoulder']] - rest.joints[1])
    assert 0.15 * reach < height[2] - height[1] < 0.5 * reach
    assert height[3] > height[2] + 0.1 * reach


def test_fingers_close_towards_the_palm(body, rest):
    rig = rig_of(body, rest)
    heads = {}
    for degrees in (0, 45):
        orientations = bone_orientations(pose_of(l_fingers=degrees), rig.standing, rig.parts)
        heads[degrees] = bone_heads(orientations, rig.parents, rig.heads)[
            rig.numbers['finger3-3.L']
        ]
    moved = heads[45] - heads[0]
    length = np.linalg.norm(rest.heads[rig.numbers['finger3-3.L']]
                            - rest.heads[rig.numbers['finger3-1.L']])  # fmt: skip
    assert moved[0] < -0.2 * length  # the left palm faces right
    assert moved[1] > 0.4 * length


def test_orientations_and_heads_agree_with_pose_body(body, rest):
    rig = rig_of(body, rest)
    for angles in random_poses(20):
        orientations = bone_orientations(angles, rig.standing, rig.parts)
        np.testing.assert_allclose(
            orientations @ orientations.transpose(0, 2, 1),
            np.tile(np.eye(3), (len(orientations), 1, 1)),
            atol=1e-9,
        )
        posed = pose_body(body, rest, pose_rotations(rig, angles)[0], np.zeros(3))
        np.testing.assert_allclose(posed.orientations, orientations, atol=1e-9)
        heads = bone_heads(orientations, rig.parents, rig.heads)
        np.testing.assert_allclose(posed.heads, heads, atol=1e-9)


def test_mirrored_angles_give_the_mirror_image(body, rest):
    rig = rig_of(body, rest)
    sides = {'l_': 'r_', 'r_': 'l_'}
    swapped = [JOINT_NUMBERS[sides.get(name[:2], name[:2]) + name[2:]] for name in JOINT_NAMES]
    for angles in random_poses(10):
        one, other = pose_rotations(rig, np.stack([angles, mirrored(angles)]))
        joints = pose_body(body, rest, one, np.zeros(3)).joints
        mirror = pose_body(body, rest, other, np.zeros(3)).joints
        # The body itself is almost symmetric.
        np.testing.assert_allclose(mirror, joints[swapped] * [-1, 1, 1], atol=0.004)
        np.testing.assert_array_equal(mirrored(mirrored(angles)), angles)


def test_cartesian_and_polar_arm_angles_are_equivalent():
    for angles in random_poses(20):
        np.testing.assert_allclose(arms_to_polar(arms_to_cartesian(angles)), angles, atol=1e-12)
    up = pose_of(l_plane=60, l_elevation=40)
    swing = arms_to_cartesian(up)[ANGLE_NUMBERS['l_plane'] : ANGLE_NUMBERS['l_plane'] + 2]
    np.testing.assert_allclose(np.degrees(swing), [20, 40 * np.sqrt(0.75)])


def test_limit_of_the_elevation_depends_on_the_plane():
    anywhere = np.linspace(-90, 125, 60)
    poses = np.array([pose_of(r_plane=plane, r_elevation=500, l_elbow=-20) for plane in anywhere])
    kept = within_limits(poses)
    highest = [max_elevation(np.radians(plane), UPPER_LIMITS[ANGLE_NUMBERS['r_elevation']])
               for plane in anywhere]  # fmt: skip
    np.testing.assert_allclose(kept[:, ANGLE_NUMBERS['r_elevation']], highest, atol=1e-12)
    np.testing.assert_allclose(np.degrees([highest[0], max(highest)]), [60, 172], atol=1e-9)
    assert (kept[:, ANGLE_NUMBERS['l_elbow']] == 0).all()
