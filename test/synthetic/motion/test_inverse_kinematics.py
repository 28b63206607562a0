"""Inverse kinematics: hands and feet get where they should."""

import numpy as np
import pytest

from lsc_pose_ros.synthetic.body.body_file import load_body
from lsc_pose_ros.synthetic.body.body_mesh import Figure, shape_body
from lsc_pose_ros.synthetic.body.bone_rotations import bone_heads, bone_turns, rig_of
from lsc_pose_ros.synthetic.motion.inverse_kinematics import (
    REACHED,
    Foot,
    face_palm,
    hand_place,
    lay_palm,
    plant,
    reach,
)
from lsc_pose_ros.synthetic.motion.joint_angles import (
    ANGLE_NUMBERS,
    ANGLES,
    ARMS,
    HIGHEST,
    LEGS,
    LOWEST,
    within_limits,
)

FIGURES = (Figure(30, 1.0), Figure(6, 0.5), Figure(60, 0.0, weight=0.8))
MIRROR = np.array([-1.0, 1.0, 1.0])
ELBOW_DOWN = 0.3


@pytest.fixture(scope='module', params=FIGURES)
def rig(request):
    body = load_body()
    return rig_of(body, shape_body(body, request.param))


def random_arms(count):
    random = np.random.default_rng(7)
    poses = within_limits(LOWEST + (HIGHEST - LOWEST) * random.random((count, len(ANGLES))))
    arms = poses[:, ARMS[0]]
    arms[:, 5:7] = 0.0  # the wrist straight
    return arms


def pose(rig, angles):
    turns = bone_turns(angles, rig.straight, rig.parts)
    return turns, bone_heads(turns, rig.parents, rig.heads)


def chest_and_hand(rig, angles, side):
    """Where the middle of a hand is in the chest's axes, from the chest's bone."""
    turns, heads = pose(rig, angles)
    chest = rig.numbers['spine01']
    hand = 0.5 * (heads[rig.numbers[f'wrist.{side}']] + heads[rig.numbers[f'finger3-1.{side}']])
    return turns[chest].T @ (hand - heads[chest])


def test_the_hand_is_where_the_body_has_it(rig):
    for arm in random_arms(30):
        angles = np.zeros(len(ANGLES))
        angles[ARMS[0]] = angles[ARMS[1]] = arm
        place = hand_place(arm, rig.shoulder, rig.arm)
        size = rig.arm.sum()
        np.testing.assert_allclose(chest_and_hand(rig, angles, 'L'), place, atol=0.02 * size)
        np.testing.assert_allclose(
            chest_and_hand(rig, angles, 'R'), MIRROR * place, atol=0.025 * size
        )


def test_hands_reach_whatever_some_posture_reaches(rig):
    misses = []
    for arm in random_arms(200):
        place = hand_place(arm, rig.shoulder, rig.arm)
        reached, miss = reach(rig, np.zeros(len(arm)), place, ELBOW_DOWN)
        gap = hand_place(reached, rig.shoulder, rig.arm) - place
        assert np.linalg.norm(gap) == pytest.approx(miss, abs=1e-9)
        assert (reached >= LOWEST[ARMS[0]] - 1e-9).all()
        assert (reached <= HIGHEST[ARMS[0]] + 1e-9).all()
        misses.append(miss)
    assert np.mean(np.array(misses) < REACHED) > 0.9


def test_the_elbow_hangs_unless_it_is_to_be_raised(rig):
    ahead = rig.shoulder[2] + [0.0, 0.0, 0.6 * rig.arm.sum()]
    heights = []
    for swivel in (0.0, 90.0):
        angles = np.zeros(len(ANGLES))
        angles[ARMS[0]], miss = reach(rig, angles[ARMS[0]], ahead, np.radians(swivel))
        assert miss < REACHED
        heights.append(pose(rig, angles)[1][rig.numbers['lowerarm01.L']])
    assert heights[1][1] > heights[0][1] + 0.15 * rig.arm.sum()
    assert heights[1][0] > heights[0][0] + 0.1 * rig.arm.sum()


def test_an_arm_is_stretched_towards_what_is_too_far_away(rig):
    place = rig.shoulder[2] + [0.0, 0.0, 3.0]
    reached, miss = reach(rig, np.zeros(9), place, ELBOW_DOWN)
    assert miss == pytest.approx(3.0 - rig.arm.sum(), abs=0.05)
    assert reached[3] < np.radians(5)


def test_palms_face_what_they_lie_on(rig):
    random = np.random.default_rng(3)
    number = ARMS[0].start + 4
    for arm in random_arms(40):
        wanted = random.normal(size=3)
        wanted /= np.linalg.norm(wanted)

        def towards(pronation, arm=arm, wanted=wanted):
            angles = np.zeros(len(ANGLES))
            angles[ARMS[0]] = arm
            angles[number] = pronation
            turns, _ = pose(rig, angles)
            wrist, chest = rig.numbers['wrist.L'], rig.numbers['spine01']
            palm = turns[wrist] @ rig.straight[wrist].T @ np.array([-1.0, 0, 0])
            return turns[chest].T @ palm @ wanted

        tried = np.linspace(LOWEST[number], HIGHEST[number], 50)
        best = max(towards(pronation) for pronation in tried)
        assert towards(face_palm(arm, wanted)) > best - 0.02


def test_a_hand_lies_level_on_what_is_before_it(rig):
    arm = np.zeros(9)
    place = np.array([0.0, rig.shoulder[2, 1] - 0.5 * rig.arm[0], 0.7 * rig.arm[0]])
    arm, miss = reach(rig, arm, place, np.radians(40))
    assert miss < REACHED
    inwards = np.array([0.0, 0.0, -1.0])  # a hand on the chest
    lay_palm(arm, inwards)
    angles = np.zeros(len(ANGLES))
    angles[ARMS[0]] = arm
    turns, _ = pose(rig, angles)
    wrist = rig.numbers['wrist.L']
    along = turns[wrist] @ rig.straight[wrist].T @ np.array([0.0, -1.0, 0.0])
    assert abs(along @ inwards) < 0.35


@pytest.mark.parametrize('right', [False, True])
def test_a_foot_is_put_down_where_it_should_and_level(rig, right):
    random = np.random.default_rng(5)
    length = rig.leg[0] + rig.leg[1]
    side, sign = ('R', -1.0) if right else ('L', 1.0)
    for _ in range(40):
        angles = np.zeros(len(ANGLES))
        angles[ANGLE_NUMBERS['lean']], angles[ANGLE_NUMBERS['list']] = random.normal(0, 0.15, 2)
        turns, _ = pose(rig, angles)
        low, high = (0.05, -0.95, 0.0), (0.3, -0.6, 0.3)
        ankle = length * random.uniform(low, high) * [sign, 1.0, 1.0]
        foot = Foot(ankle, random.uniform(0.0, 0.3), random.choice([0.0, 0.4]))
        angles[LEGS[int(right)]] = plant(rig, turns[0], foot, right=right)
        turns, heads = pose(rig, angles)
        number = rig.numbers[f'foot.{side}']
        np.testing.assert_allclose(heads[number], ankle, atol=0.012 * length)
        sole = turns[number] @ rig.straight[number].T
        if angles[LEGS[int(right)]][4] > LOWEST[LEGS[0]][4] + 1e-6:
            assert sole[1, 2] == pytest.approx(-np.sin(foot.pitch), abs=0.02)
        # The knee bends forwards, the toes point where they should.
        hip, knee = (heads[rig.numbers[f'{name}.{side}']] for name in ('upperleg01', 'lowerleg01'))
        assert (knee - 0.5 * (hip + heads[number]))[2] > -0.02 * length
        heading = np.arctan2(sign * sole[0, 2], sole[2, 2])
        assert heading == pytest.approx(foot.heading, abs=0.5)
