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

"""Tests inverse kinematics: hands and feet reach their targets."""

import numpy as np
import pytest

from lsc_pose_ros.synthetic.body.body_file import load_body
from lsc_pose_ros.synthetic.body.body_mesh import BodyShape, shape_body
from lsc_pose_ros.synthetic.body.bone_rotations import bone_heads, bone_orientations, rig_of
from lsc_pose_ros.synthetic.motion.inverse_kinematics import (
    REACH_TOLERANCE,
    FootTarget,
    align_palm,
    hand_position,
    pronation_towards,
    solve_arm,
    solve_leg,
)
from lsc_pose_ros.synthetic.motion.joint_angles import (
    ANGLE_NUMBERS,
    ANGLES,
    ARMS,
    LEGS,
    LOWER_LIMITS,
    UPPER_LIMITS,
    within_limits,
)

FIGURES = (BodyShape(30, 1.0), BodyShape(6, 0.5), BodyShape(60, 0.0, weight=0.8))
MIRROR = np.array([-1.0, 1.0, 1.0])
ELBOW_DOWN = 0.3


@pytest.fixture(scope='module', params=FIGURES)
def rig(request):
    body = load_body()
    return rig_of(body, shape_body(body, request.param))


def random_arms(count):
    random = np.random.default_rng(7)
    poses = within_limits(
        LOWER_LIMITS + (UPPER_LIMITS - LOWER_LIMITS) * random.random((count, len(ANGLES)))
    )
    arms = poses[:, ARMS[0]]
    arms[:, 5:7] = 0.0  # straight wrist
    return arms


def pose(rig, angles):
    orientations = bone_orientations(angles, rig.standing, rig.parts)
    return orientations, bone_heads(orientations, rig.parents, rig.heads)


def chest_and_hand(rig, angles, side):
    """Return the position of the middle of a hand in the chest's frame."""
    orientations, heads = pose(rig, angles)
    chest = rig.numbers['spine01']
    hand = 0.5 * (heads[rig.numbers[f'wrist.{side}']] + heads[rig.numbers[f'finger3-1.{side}']])
    return orientations[chest].T @ (hand - heads[chest])


def test_hand_position_agrees_with_the_body(rig):
    for arm in random_arms(30):
        angles = np.zeros(len(ANGLES))
        angles[ARMS[0]] = angles[ARMS[1]] = arm
        position = hand_position(arm, rig.shoulder, rig.arm)
        size = rig.arm.sum()
        np.testing.assert_allclose(chest_and_hand(rig, angles, 'L'), position, atol=0.02 * size)
        np.testing.assert_allclose(
            chest_and_hand(rig, angles, 'R'), MIRROR * position, atol=0.025 * size
        )


def test_hands_reach_the_positions_of_random_postures(rig):
    misses = []
    for arm in random_arms(200):
        position = hand_position(arm, rig.shoulder, rig.arm)
        reached, miss = solve_arm(rig, np.zeros(len(arm)), position, ELBOW_DOWN)
        gap = hand_position(reached, rig.shoulder, rig.arm) - position
        assert np.linalg.norm(gap) == pytest.approx(miss, abs=1e-9)
        assert (reached >= LOWER_LIMITS[ARMS[0]] - 1e-9).all()
        assert (reached <= UPPER_LIMITS[ARMS[0]] + 1e-9).all()
        misses.append(miss)
    assert np.mean(np.array(misses) < REACH_TOLERANCE) > 0.9


def test_swivel_raises_the_elbow(rig):
    ahead = rig.shoulder[2] + [0.0, 0.0, 0.6 * rig.arm.sum()]
    heights = []
    for swivel in (0.0, 90.0):
        angles = np.zeros(len(ANGLES))
        angles[ARMS[0]], miss = solve_arm(rig, angles[ARMS[0]], ahead, np.radians(swivel))
        assert miss < REACH_TOLERANCE
        heights.append(pose(rig, angles)[1][rig.numbers['lowerarm01.L']])
    assert heights[1][1] > heights[0][1] + 0.15 * rig.arm.sum()
    assert heights[1][0] > heights[0][0] + 0.1 * rig.arm.sum()


def test_arm_is_stretched_towards_a_position_out_of_reach(rig):
    position = rig.shoulder[2] + [0.0, 0.0, 3.0]
    reached, miss = solve_arm(rig, np.zeros(9), position, ELBOW_DOWN)
    assert miss == pytest.approx(3.0 - rig.arm.sum(), abs=0.05)
    assert reached[3] < np.radians(5)


def test_pronation_turns_the_palm_towards_a_direction(rig):
    random = np.random.default_rng(3)
    number = ARMS[0].start + 4
    for arm in random_arms(40):
        wanted = random.normal(size=3)
        wanted /= np.linalg.norm(wanted)

        def towards(pronation, arm=arm, wanted=wanted):
            angles = np.zeros(len(ANGLES))
            angles[ARMS[0]] = arm
            angles[number] = pronation
            orientations, _ = pose(rig, angles)
            wrist, chest = rig.numbers['wrist.L'], rig.numbers['spine01']
            palm = orientations[wrist] @ rig.standing[wrist].T @ np.array([-1.0, 0, 0])
            return orientations[chest].T @ palm @ wanted

        tried = np.linspace(LOWER_LIMITS[number], UPPER_LIMITS[number], 50)
        best = max(towards(pronation) for pronation in tried)
        assert towards(pronation_towards(arm, wanted)) > best - 0.02


def test_hand_lies_flat_on_a_surface(rig):
    arm = np.zeros(9)
    position = np.array([0.0, rig.shoulder[2, 1] - 0.5 * rig.arm[0], 0.7 * rig.arm[0]])
    arm, miss = solve_arm(rig, arm, position, np.radians(40))
    assert miss < REACH_TOLERANCE
    inwards = np.array([0.0, 0.0, -1.0])  # hand on the chest
    align_palm(arm, inwards)
    angles = np.zeros(len(ANGLES))
    angles[ARMS[0]] = arm
    orientations, _ = pose(rig, angles)
    wrist = rig.numbers['wrist.L']
    along = orientations[wrist] @ rig.standing[wrist].T @ np.array([0.0, -1.0, 0.0])
    assert abs(along @ inwards) < 0.35


@pytest.mark.parametrize('right', [False, True])
def test_foot_is_on_its_target_and_level(rig, right):
    random = np.random.default_rng(5)
    length = rig.leg[0] + rig.leg[1]
    side, sign = ('R', -1.0) if right else ('L', 1.0)
    for _ in range(40):
        angles = np.zeros(len(ANGLES))
        angles[ANGLE_NUMBERS['lean']], angles[ANGLE_NUMBERS['list']] = random.normal(0, 0.15, 2)
        orientations, _ = pose(rig, angles)
        low, high = (0.05, -0.95, 0.0), (0.3, -0.6, 0.3)
        ankle = length * random.uniform(low, high) * [sign, 1.0, 1.0]
        foot = FootTarget(ankle, random.uniform(0.0, 0.3), random.choice([0.0, 0.4]))
        angles[LEGS[int(right)]] = solve_leg(rig, orientations[0], foot, right=right)
        orientations, heads = pose(rig, angles)
        number = rig.numbers[f'foot.{side}']
        np.testing.assert_allclose(heads[number], ankle, atol=0.012 * length)
        sole = orientations[number] @ rig.standing[number].T
        if angles[LEGS[int(right)]][4] > LOWER_LIMITS[LEGS[0]][4] + 1e-6:
            assert sole[1, 2] == pytest.approx(-np.sin(foot.pitch), abs=0.02)
        # The knee bends forwards, and the toes have the given heading.
        hip, knee = (heads[rig.numbers[f'{name}.{side}']] for name in ('upperleg01', 'lowerleg01'))
        assert (knee - 0.5 * (hip + heads[number]))[2] > -0.02 * length
        heading = np.arctan2(sign * sole[0, 2], sole[2, 2])
        assert heading == pytest.approx(foot.heading, abs=0.5)
