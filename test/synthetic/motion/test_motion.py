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

"""Tests the sampled motion."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.synthetic.body.body_file import load_body
from lsc_pose_ros.synthetic.body.body_mesh import BodyShape, pose_body, shape_body
from lsc_pose_ros.synthetic.geometry.rotations import rotation_vectors
from lsc_pose_ros.synthetic.motion.motion import interpolate_keys, sample_motion

RATE = 30.0


def source(seed):
    return np.random.Generator(np.random.PCG64(seed))


@pytest.fixture(scope='module')
def body():
    return load_body()


@pytest.fixture(scope='module')
def rest(body):
    return shape_body(body, BodyShape(30, 1.0))


def joints_of(body, rest, motion):
    some = rest._replace(vertices=rest.vertices[:1])
    bare = body._replace(skin_bones=body.skin_bones[:1], skin_weights=body.skin_weights[:1])
    return np.array([pose_body(bare, some, each, np.zeros(3)).joints for each in motion.rotations])


@pytest.mark.parametrize('rate', [None, RATE])
def test_motion_consists_of_rotations_and_a_limited_yaw(body, rest, rate):
    for seed in range(3):
        motion = sample_motion(body, rest, 40, rate, 0.4, source(seed))
        assert motion.rotations.shape == (40, len(body.bones), 3, 3)
        assert motion.yaw.shape == (40,)
        squared = motion.rotations @ motion.rotations.swapaxes(2, 3)
        np.testing.assert_allclose(squared, np.broadcast_to(np.eye(3), squared.shape), atol=1e-9)
        assert np.abs(motion.yaw).max() <= 0.4
        assert np.abs(motion.yaw).max() > 0.02


@pytest.mark.parametrize('rate', [None, RATE])
def test_motion_is_the_same_for_the_same_seed(body, rest, rate):
    first = sample_motion(body, rest, 20, rate, 1.0, source(9))
    again = sample_motion(body, rest, 20, rate, 1.0, source(9))
    other = sample_motion(body, rest, 20, rate, 1.0, source(10))
    np.testing.assert_array_equal(first.rotations, again.rotations)
    np.testing.assert_array_equal(first.yaw, again.yaw)
    assert np.abs(first.rotations - other.rotations).max() > 0.1


def test_motion_is_smooth(body, rest):
    for seed in range(6):
        motion = sample_motion(body, rest, 90, RATE, 1.0, source(seed))
        joints = joints_of(body, rest, motion)
        secants = np.linalg.norm(np.diff(joints, axis=0), axis=2)
        # The fastest strikes of trained people have about 10 m/s.
        assert secants.max() * RATE < 10
        assert secants.mean() * RATE > 0.03
        between = motion.rotations[1:] @ motion.rotations[:-1].swapaxes(2, 3)
        assert np.degrees(np.linalg.norm(rotation_vectors(between), axis=-1)).max() < 35
        assert np.degrees(np.abs(np.diff(motion.yaw))).max() < 3


def test_video_can_have_a_single_frame(body, rest):
    assert sample_motion(body, rest, 1, RATE, 0.0, source(0)).rotations.shape[0] == 1


def test_poses_without_a_rate_are_independent(body, rest):
    motion = sample_motion(body, rest, 60, None, np.pi, source(3))
    joints = joints_of(body, rest, motion)
    hands = joints[:, JOINT_NUMBERS['l_hand']]
    assert np.median(np.linalg.norm(np.diff(hands, axis=0), axis=1)) > 0.3
    assert np.abs(np.diff(motion.yaw)).mean() > 1.2


def test_hands_and_feet_reach_all_regions_on_both_sides(body, rest):
    """A training set needs variety, and both sides are equally frequent."""
    joints = joints_of(body, rest, sample_motion(body, rest, 800, None, 0.0, source(1)))
    at = {name: joints[:, number] for name, number in JOINT_NUMBERS.items()}
    for side in ('l', 'r'):
        hand = at[f'{side}_hand'] - at[f'{side}_shoulder']
        assert 0.08 < (hand[:, 1] > 0).mean() < 0.4  # above the shoulder
        assert 0.15 < (hand[:, 2] > 0.3).mean() < 0.7  # well in front of it
        assert (hand[:, 2] < -0.1).mean() > 0.05  # behind it
        near_head = np.linalg.norm(at[f'{side}_hand'] - at['head'], axis=1) < 0.25
        assert 0.02 < near_head.mean() < 0.2
        assert (at[f'{side}_ankle'][:, 1] > at['pelvis'][:, 1] - 0.55).mean() > 0.1
        across = hand[:, 0] < -0.2 if side == 'l' else hand[:, 0] > 0.2
        assert 0.05 < across.mean() < 0.3
    upright = at['neck'][:, 1] - at['pelvis'][:, 1]
    assert 0.03 < (upright < 0.35).mean() < 0.2
    mean = {side: at[f'{side}_hand'].mean(axis=0) for side in ('l', 'r')}
    np.testing.assert_allclose(mean['l'] * [-1, 1, 1], mean['r'], atol=0.06)


def naive_interpolate(time, key_times, keys):
    """Interpolate one value by the equations of Fritsch and Butland."""
    spans = np.diff(key_times)
    secants = np.diff(keys) / spans
    slopes = np.zeros(len(keys))
    for key in range(1, len(keys) - 1):
        before, after = secants[key - 1], secants[key]
        if before * after > 0:
            blend = (spans[key - 1] + 2 * spans[key]) / (3 * (spans[key - 1] + spans[key]))
            slopes[key] = before * after / (blend * after + (1 - blend) * before)
    for first in range(len(spans)):
        if key_times[first] <= time <= key_times[first + 1]:
            u = (time - key_times[first]) / spans[first]
            return (
                (1 + 2 * u) * (1 - u) ** 2 * keys[first]
                + u * (1 - u) ** 2 * spans[first] * slopes[first]
                + u * u * (3 - 2 * u) * keys[first + 1]
                + u * u * (u - 1) * spans[first] * slopes[first + 1]
            )
    return keys[-1]


def test_interpolation_agrees_with_the_equation_and_never_overshoots():
    random = source(2)
    key_times = np.cumsum(random.random(9) + 0.1) - 0.1
    keys = random.standard_normal((9, 3))
    keys[4] = keys[3]
    times = np.sort(np.concatenate([key_times, random.random(80) * (key_times[-1] + 0.5)]))
    times = np.maximum(times, key_times[0])
    values = interpolate_keys(times, key_times, keys)
    for column in range(3):
        expected = [naive_interpolate(time, key_times, keys[:, column]) for time in times]
        np.testing.assert_allclose(values[:, column], expected, atol=1e-9)
    for first, last in zip(range(8), range(1, 9), strict=True):
        inside = (times >= key_times[first]) & (times <= key_times[last])
        low, high = np.sort([keys[first], keys[last]], axis=0)
        assert (values[inside] >= low - 1e-9).all()
        assert (values[inside] <= high + 1e-9).all()
    # The velocity is continuous at the keys.
    inner, seconds_per_key = key_times[1:-1], 1e-6
    before, at, after = (
        interpolate_keys(inner + d, key_times, keys)
        for d in (-seconds_per_key, 0.0, seconds_per_key)
    )
    np.testing.assert_allclose(
        (at - before) / seconds_per_key, (after - at) / seconds_per_key, atol=1e-3
    )
