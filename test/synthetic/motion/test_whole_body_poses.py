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

"""Tests poses: lower body, gestures and strides."""

import numpy as np
import pytest

from lsc_pose_ros.synthetic.body.body_file import load_body
from lsc_pose_ros.synthetic.body.body_mesh import BodyShape, shape_body
from lsc_pose_ros.synthetic.body.bone_rotations import bone_heads, bone_orientations
from lsc_pose_ros.synthetic.body.self_collision import (
    MAX_PENETRATION,
    deepest_penetration,
    fit_collision_body,
)
from lsc_pose_ros.synthetic.motion import body_touch, lower_body_poses
from lsc_pose_ros.synthetic.motion.body_touch import touch_body
from lsc_pose_ros.synthetic.motion.gait import stride_angles
from lsc_pose_ros.synthetic.motion.joint_angles import (
    ANGLE_NUMBERS,
    ANGLES,
    ARMS,
    LEGS,
    within_limits,
)
from lsc_pose_ros.synthetic.motion.lower_body_poses import let_arms_hang, sample_lower_body
from lsc_pose_ros.synthetic.motion.whole_body_poses import sample_gesture, sample_pose
from lsc_pose_ros.synthetic.sampling import RandomStream

FIGURES = (BodyShape(30, 1.0), BodyShape(6, 0.5), BodyShape(45, 0.0, weight=0.95, muscle=0.4))

# Winter's fractions of the body's mass, with the bones at the ends of each part.
LIMB_MASSES = (
    (0.028, 'upperarm01', 'lowerarm01'), (0.016, 'lowerarm01', 'wrist'),
    (0.006, 'wrist', 'finger3-1'), (0.100, 'upperleg01', 'lowerleg01'),
    (0.0465, 'lowerleg01', 'foot'), (0.0145, 'foot', 'toes'),
)  # fmt: skip
MASSES = [(0.497, 'root', 'neck01'), (0.081, 'head', 'head')]
MASSES += [(m, f'{a}.{side}', f'{b}.{side}') for m, a, b in LIMB_MASSES for side in ('L', 'R')]


def source(seed):
    return np.random.Generator(np.random.PCG64(seed))


@pytest.fixture(scope='module', params=FIGURES)
def collision_body(request):
    body = load_body()
    return fit_collision_body(body, shape_body(body, request.param))


def heads_of(collision_body, angles):
    rig = collision_body.rig
    orientations = bone_orientations(angles, rig.standing, rig.parts)
    heads = bone_heads(orientations, rig.parents, rig.heads)
    return {name: heads[number] for name, number in rig.numbers.items()}


def sample_only(monkeypatch, *names):
    """Restrict the sampling of the lower body to the functions `names`."""
    kept = tuple(
        each for each in lower_body_poses._LOWER_BODY_KINDS if each[1][1].__name__ in names
    )
    assert len(kept) == len(names)
    monkeypatch.setattr(lower_body_poses, '_LOWER_BODY_KINDS', kept)


def test_poses_are_within_limits_and_rarely_collide(collision_body):
    random, depths = source(0), []
    for _ in range(200):
        angles = sample_pose(collision_body, RandomStream(random)).angles
        np.testing.assert_allclose(within_limits(angles), angles, atol=1e-12)
        depths.append(deepest_penetration(collision_body, angles[None])[0])
    # The others are rejected and sampled again.
    assert np.mean(np.array(depths) <= MAX_PENETRATION) > 0.8


def test_standing_people_have_both_feet_down_and_are_balanced(collision_body, monkeypatch):
    names = ('_stand_at_ease', '_stand_apart', '_stand_in_stride', '_squat', '_stoop')
    sample_only(monkeypatch, *names)
    random = source(1)
    length = collision_body.rig.leg[0] + collision_body.rig.leg[1]
    level, off, planted = [], [], []
    for _ in range(200):
        angles = within_limits(sample_lower_body(collision_body.rig, RandomStream(random)).angles)
        at = heads_of(collision_body, angles)
        mass = sum(fraction * 0.5 * (at[first] + at[last]) for fraction, first, last in MASSES)
        soles = np.array(
            [at[f'{bone}.{side}'] for side in ('L', 'R') for bone in ('foot', 'toes')]
        )
        middle, reach = soles.mean(axis=0), np.abs(soles - soles.mean(axis=0)).max(axis=0)
        off.append(np.abs(mass - middle)[[0, 2]] / length - 0.5 * reach[[0, 2]] / length)
        balls = [at[f'toes.{side}'][1] for side in ('L', 'R')]
        level.append(abs(balls[0] - balls[1]) / length)
        planted.append(soles[:, 1].max() < -0.2 * length)
    assert np.mean(np.array(level) < 0.05) > 0.9
    assert np.mean(np.max(off, axis=1) < 0.08) > 0.9
    assert all(planted)


def test_sitting_people_have_bent_hips_and_feet_ahead_or_below(collision_body, monkeypatch):
    sample_only(monkeypatch, '_sit')
    random = source(2)
    for _ in range(60):
        lower_body = sample_lower_body(collision_body.rig, RandomStream(random))
        assert lower_body.kind == 'sit'
        angles = within_limits(lower_body.angles)
        at = heads_of(collision_body, angles)
        trunk = at['neck01'] - at['root']
        length = collision_body.rig.leg[1]
        assert (
            min(at['foot.L'][1], at['foot.R'][1]) < -0.5 * length
        )  # the other foot can be on the knee
        for side in ('L', 'R'):
            thigh = at[f'lowerleg01.{side}'] - at[f'upperleg01.{side}']
            assert thigh[2] > 0.5 * collision_body.rig.leg[0]
            assert thigh @ trunk > -0.75 * np.linalg.norm(thigh) * np.linalg.norm(trunk)


def test_stride_is_symmetric_and_periodic():
    size = (0.0, 1.0, 0.0)
    for running in (0.0, 1.0):
        start, half = (stride_angles(phase, running, 1.0) for phase in (0.0, 0.5))
        np.testing.assert_allclose(start[LEGS[0]], half[LEGS[1]], atol=1e-12)
        np.testing.assert_allclose(start[ARMS[0]], half[ARMS[1]], atol=1e-12)
        nearly = stride_angles(1 - 1e-9, running, 1.0)
        np.testing.assert_allclose(start, nearly, atol=1e-6)
        knees = [stride_angles(phase, running, 1.0)[ANGLE_NUMBERS['l_knee']]
                 for phase in np.arange(100) / 100]  # fmt: skip
        assert np.degrees(max(knees)) == pytest.approx(100 if running else 60, abs=5)
        assert np.abs(np.diff(knees)).max() < np.radians(8)
    walking = stride_angles(0.0, *size[:2])
    # Left leg and right arm are in front.
    assert walking[ANGLE_NUMBERS['l_hip_flexion']] > walking[ANGLE_NUMBERS['r_hip_flexion']]
    forwards = {side: np.sin(walking[ANGLE_NUMBERS[f'{side}_plane']]) for side in ('l', 'r')}
    assert forwards['r'] > 0 > forwards['l']


@pytest.mark.parametrize('side', [0, 1])
@pytest.mark.parametrize('touch', [touch for _, touch in body_touch.TOUCH_TARGETS],
                         ids=lambda touch: f'{touch.part}{touch.which}')  # fmt: skip
def test_touching_hands_are_on_the_body_without_penetration(collision_body, side, touch):
    random, near = source(4), []
    rig, capsules = collision_body
    for _ in range(12):
        angles = np.zeros(len(ANGLES))
        let_arms_hang(angles)
        before = angles.copy()
        touch_body(collision_body, angles, side, touch, RandomStream(random))
        assert deepest_penetration(collision_body, angles[None])[0] <= MAX_PENETRATION
        others = np.ones(len(ANGLES), bool)
        others[ARMS[side]] = False
        np.testing.assert_array_equal(angles[others], before[others])
        if np.array_equal(angles, before):
            continue  # out of reach
        at = heads_of(collision_body, angles)
        letter = 'LR'[side]
        palm = 0.5 * (at[f'wrist.{letter}'] + at[f'finger3-1.{letter}'])
        number = body_touch.capsule_number(capsules.names, touch, side)
        orientations = bone_orientations(angles, rig.standing, rig.parts)
        bone = capsules.bones[number]
        name = next(name for name, each in rig.numbers.items() if each == bone)
        start, end = at[name] + capsules.ends[number] @ orientations[bone].T
        along = end - start
        fraction = np.clip((palm - start) @ along / max(along @ along, 1e-9), 0, 1)
        off = np.linalg.norm(palm - start - fraction * along) - capsules.radii[number]
        near.append(off / rig.arm.sum())
    if near:
        assert np.median(near) < 0.12
    assert near or touch.part.startswith(('own_', 'other_', 'neck'))


def test_gestures_keep_the_legs_and_sometimes_an_arm(collision_body):
    random, kept = source(5), 0
    before = sample_pose(collision_body, RandomStream(random))
    for _ in range(40):
        after = sample_gesture(collision_body, before, RandomStream(random))
        for side in (0, 1):
            np.testing.assert_allclose(after.angles[LEGS[side]], before.angles[LEGS[side]])
            kept += np.array_equal(after.angles[ARMS[side]], before.angles[ARMS[side]])
    assert 8 < kept < 35


def test_random_stream_has_the_stated_distributions():
    random = source(6)
    drawn = [RandomStream(random, 16) for _ in range(4000)]
    bell = np.array([stream.normal(3.0, 2.0) for stream in drawn])
    assert bell.mean() == pytest.approx(3.0, abs=0.1)
    assert bell.std() == pytest.approx(2.0, abs=0.1)
    assert np.mean([stream.bernoulli(0.3) for stream in drawn]) == pytest.approx(0.3, abs=0.03)
    between = [stream.between(-1.0, 3.0) for stream in drawn]
    assert min(between) >= -1.0
    assert max(between) < 3.0
    names = [stream.choose(((1.0, 'rare'), (3.0, 'often'))) for stream in drawn]
    assert names.count('often') == pytest.approx(3000, abs=120)
    # The next stream does not depend on the use of the previous one.
    one, other = source(7), source(7)
    RandomStream(one).uniform()
    RandomStream(other)
    assert RandomStream(one).uniform() == RandomStream(other).uniform()


def test_pose_never_exhausts_its_random_stream(collision_body, monkeypatch):
    """All tries of the arms fail, so the largest number of random numbers is used."""
    monkeypatch.setattr('lsc_pose_ros.synthetic.motion.whole_body_poses.MAX_PENETRATION', -1.0)
    random = source(8)
    for _ in range(300):
        sample_pose(collision_body, RandomStream(random))
