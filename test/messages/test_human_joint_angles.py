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

"""The angles of the human model of REP-155, against the forward kinematics of its URDF."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.messages.human_joint_angles import STRAIGHT, joint_angles

JOINTS = np.arange(len(JOINT_NAMES), dtype=np.uint16)

# The axes of the joints in human_description/urdf/human-tpl.xacro, from the torso outwards, and
# the point at the end of each link: each limb hangs along -z.
ARM = [('y_shoulder', (0, 0, -1)), ('p_shoulder', (1, 0, 0)), ('r_shoulder', (0, 0, 1))]
LEG = [('y_hip', (0, 0, -1)), ('p_hip', (1, 0, 0)), ('r_hip', (0, -1, 0))]
BENT = {'elbow': (0, -1, 0), 'knee': (0, -1, 0)}
# `reflect` of the URDF, -1 on the right, multiplies the axes of these joints.
REFLECTED = {'y_shoulder', 'p_shoulder', 'r_shoulder', 'p_hip'}


def rotation(axis, angle):
    """Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def limb(side, upper, lower, angles):
    """Return the directions of both links of a limb in the torso."""
    reflect = -1 if side == 'r' else 1
    turn = np.eye(3)
    for name, axis in upper:
        factor = reflect if name in REFLECTED else 1
        turn = turn @ rotation(np.array(axis) * factor, angles[f'{side}_{name}'])
    first = turn @ (0, 0, -1)
    turn = turn @ rotation(BENT[lower], angles[f'{side}_{lower}'])
    return first, turn @ (0, 0, -1)


def body(directions, turn):
    """Return positions of a person with these limbs, in the camera; `turn` are the body's axes."""
    heights = {'neck': 0.5, 'head': 0.7, 'torso': 0.3, 'pelvis': 0.0}
    places = {name: (0.0, 0.0, height) for name, height in heights.items()}
    for side, sign in (('l', 1), ('r', -1)):
        places[f'{side}_shoulder'] = (0.0, 0.2 * sign, 0.45)
        places[f'{side}_hip'] = (0.0, 0.1 * sign, 0.0)
        for chain in (('shoulder', 'elbow', 'wrist', 'hand'), ('hip', 'knee', 'ankle', 'foot')):
            first, second = directions[f'{side}_{chain[1]}']
            start = np.array(places[f'{side}_{chain[0]}'])
            places[f'{side}_{chain[1]}'] = start + 0.3 * first
            places[f'{side}_{chain[2]}'] = start + 0.3 * first + 0.25 * second
            places[f'{side}_{chain[3]}'] = start + 0.3 * first + 0.35 * second
    inside = np.array([places[name] for name in JOINT_NAMES])
    return (inside @ turn.T + (0.3, 0.2, 2.5)).astype(np.float32)


def random_turn(random):
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    return turn * np.sign(np.linalg.det(turn))


def unit(vector):
    return vector / np.linalg.norm(vector)


@pytest.mark.parametrize('seed', range(200))
def test_the_model_with_these_angles_has_the_limbs_of_the_person(seed):
    random = np.random.default_rng(seed)
    directions = {
        f'{side}_{lower}': (unit(random.normal(size=3)), unit(random.normal(size=3)))
        for side in 'lr'
        for lower in BENT
    }
    angles = joint_angles(JOINTS, body(directions, random_turn(random)))
    assert angles is not None
    assert set(angles) == {'waist'} | {
        f'{side}_{name}' for side in 'lr' for name in (*dict(ARM), 'elbow', *dict(LEG), 'knee')
    }
    assert angles['waist'] == 0
    for side in 'lr':
        for upper, lower in ((ARM, 'elbow'), (LEG, 'knee')):
            found = limb(side, upper, lower, angles)
            expected = directions[f'{side}_{lower}']
            # Positions are float32: 2e-7 m of 0.25 m.
            np.testing.assert_allclose(found[0], expected[0], atol=1e-5)
            bend = np.arccos(np.clip(expected[0] @ expected[1], -1, 1))
            if bend > STRAIGHT:
                np.testing.assert_allclose(found[1], expected[1], atol=1e-5)
            # A bend of less than STRAIGHT to the wrong side.
            assert found[1] @ expected[1] > np.cos(2 * STRAIGHT)


@pytest.mark.parametrize(
    ('name', 'upper', 'lower', 'expected'),
    [
        # In the torso: x forward, y left, z up.
        ('hanging', (0, 0, -1), (0, 0, -1), (0, 0, 0, 0)),
        ('sideways', (0, 1, 0), (0, 1, 0), (0, np.pi / 2, 0, 0)),
        ('forward', (1, 0, 0), (1, 0, 0), (np.pi / 2, np.pi / 2, 0, 0)),
        ('up', (0, 0.01, 1), (0, 0.01, 1), (0, np.pi - 0.01, 0, 0)),
        ('forearm forward', (0, 0, -1), (1, 0, 0), (0, 0, 0, np.pi / 2)),
        # Hanging and a little across the body: the pitch is negative, not the yaw a half turn.
        ('across', (0, -0.1, -0.995), (0, -0.1, -0.995), (0, -0.1, 0, 0)),
    ],
)
@pytest.mark.parametrize('side', 'lr')
def test_angles_of_arms(name, upper, lower, expected, side):
    mirror = np.array([1, 1 if side == 'l' else -1, 1])
    still = (np.array([0.0, 0, -1]),) * 2
    directions = {f'{each}_{bent}': still for each in 'lr' for bent in BENT}
    directions[f'{side}_elbow'] = (unit(upper) * mirror, unit(lower) * mirror)
    angles = joint_angles(JOINTS, body(directions, np.eye(3)))
    found = [angles[f'{side}_{each}'] for each in (*dict(ARM), 'elbow')]
    np.testing.assert_allclose(found, expected, atol=2e-3, err_msg=name)


@pytest.mark.parametrize(
    ('thigh', 'shin', 'expected'),
    [
        ((0, 0, -1), (0, 0, -1), (0, 0, 0, 0)),
        ((1, 0, 0), (0, 0, -1), (0, 0, np.pi / 2, -np.pi / 2)),  # sitting
        ((0, 1, -1), (0, 1, -1), (0, np.pi / 4, 0, 0)),  # spread outwards
        ((0, 0, -1), (1, 0, -1), (0, 0, 0, np.pi / 4)),  # what a knee cannot do
    ],
)
@pytest.mark.parametrize('side', 'lr')
def test_angles_of_legs(thigh, shin, expected, side):
    mirror = np.array([1, 1 if side == 'l' else -1, 1])
    still = (np.array([0.0, 0, -1]),) * 2
    directions = {f'{each}_{bent}': still for each in 'lr' for bent in BENT}
    directions[f'{side}_knee'] = (unit(thigh) * mirror, unit(shin) * mirror)
    angles = joint_angles(JOINTS, body(directions, np.eye(3)))
    found = [angles[f'{side}_{each}'] for each in (*dict(LEG), 'knee')]
    np.testing.assert_allclose(found, expected, atol=1e-5)


def test_only_angles_that_follow():
    random = np.random.default_rng(5)
    still = (np.array([0.0, 0, -1]), unit(np.array([0.2, 0, -1])))
    directions = {f'{side}_{bent}': still for side in 'lr' for bent in BENT}
    positions = body(directions, random_turn(random))
    positions[JOINT_NUMBERS['l_wrist']] = np.nan
    positions[JOINT_NUMBERS['r_knee']] = positions[JOINT_NUMBERS['r_hip']]
    angles = joint_angles(JOINTS, positions)
    limbs = {name.partition('_')[0] + name.rpartition('_')[2] for name in angles} - {'waistwaist'}
    assert limbs == {'rshoulder', 'relbow', 'lhip', 'lknee'}
    positions[JOINT_NUMBERS['l_hip']] = positions[JOINT_NUMBERS['pelvis']] = np.nan
    assert joint_angles(JOINTS, positions) is None
    few = [JOINT_NUMBERS[name] for name in ('neck', 'l_hip', 'r_hip')]
    still_standing = body(directions, np.eye(3))
    assert joint_angles(JOINTS[few], still_standing[few]) == {'waist': 0}
