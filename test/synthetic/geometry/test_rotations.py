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

"""Tests rotations against scipy."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from lsc_pose_ros.synthetic.geometry.rotations import (
    axis_rotation,
    continuous_signs,
    from_quaternions,
    from_rotation_vectors,
    half_turns,
    interpolate_rotations,
    limb_frames,
    normalised,
    rotation_vectors,
    shortest_rotation,
    signed_slerp,
    slerp,
    to_quaternions,
)

RANDOM = np.random.default_rng(21)
ROTATIONS = Rotation.concatenate(
    [
        Rotation.from_rotvec(RANDOM.normal(0, 2, (200, 3))),
        Rotation.from_rotvec(RANDOM.normal(0, 1e-9, (5, 3))),
        Rotation.from_rotvec(
            np.pi * np.eye(3)
        ),  # half turns, with a zero component of the quaternion
        Rotation.identity(1),
    ]
)
MATRICES = ROTATIONS.as_matrix()
DIRECTIONS = normalised(RANDOM.normal(size=(100, 3)))


def test_quaternion_round_trip():
    theirs = ROTATIONS.as_quat()[:, [3, 0, 1, 2]]
    ours = to_quaternions(MATRICES)
    assert (ours[:, 0] >= 0).all()
    np.testing.assert_allclose(abs((ours * theirs).sum(axis=1)), 1, atol=1e-12)
    np.testing.assert_allclose(from_quaternions(ours), MATRICES, atol=1e-12)


def test_rotation_vector_round_trip():
    vectors = rotation_vectors(MATRICES)
    np.testing.assert_allclose(Rotation.from_rotvec(vectors).as_matrix(), MATRICES, atol=1e-9)
    assert np.linalg.norm(vectors, axis=1).max() <= np.pi + 1e-9
    np.testing.assert_allclose(from_rotation_vectors(vectors), MATRICES, atol=1e-9)


@pytest.mark.parametrize(('axis', 'name'), [(0, 'x'), (1, 'y'), (2, 'z')])
def test_rotation_about_an_axis(axis, name):
    angles = np.linspace(-4, 4, 9)
    np.testing.assert_allclose(
        axis_rotation(axis, angles),
        Rotation.from_euler(name, angles[:, None]).as_matrix(),
        atol=1e-12,
    )


def test_half_turns():
    expected = Rotation.from_rotvec(np.pi * DIRECTIONS).as_matrix()
    np.testing.assert_allclose(half_turns(DIRECTIONS), expected, atol=1e-12)


def test_shortest_rotation_between_directions():
    ends = np.concatenate([DIRECTIONS[1:], DIRECTIONS[:1]])
    ends[:10] = -DIRECTIONS[:10]
    ends[10:20] = DIRECTIONS[10:20]
    starts = np.concatenate([DIRECTIONS, np.eye(3), -np.eye(3)])
    ends = np.concatenate([ends, -np.eye(3), np.eye(3)])
    found = shortest_rotation(starts, ends)
    np.testing.assert_allclose(np.einsum('nij,nj->ni', found, starts), ends, atol=1e-9)
    np.testing.assert_allclose(found @ found.transpose(0, 2, 1), [np.eye(3)] * 106, atol=1e-9)
    np.testing.assert_allclose(np.linalg.det(found), 1, atol=1e-9)
    angles = np.arccos(np.clip((starts * ends).sum(axis=1), -1, 1))
    np.testing.assert_allclose(Rotation.from_matrix(found).magnitude(), angles, atol=1e-6)


def test_limb_frames_point_along_and_face_ahead():
    along, ahead = DIRECTIONS[:50], DIRECTIONS[50:]
    frames = limb_frames(along, ahead)
    np.testing.assert_allclose(frames @ [0, -1, 0], along, atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(frames), 1, atol=1e-12)
    assert ((frames[:, :, 2] * ahead).sum(axis=1) > 0).all()
    np.testing.assert_allclose((frames[:, :, 0] * ahead).sum(axis=1), 0, atol=1e-12)


@pytest.mark.parametrize('fraction', [0.0, 0.3, 1.0])
def test_interpolated_rotations(fraction):
    for first, last in pairwise(MATRICES):
        pair = Rotation.from_matrix([first, last])
        if (pair[0].inv() * pair[1]).magnitude() > np.pi - 1e-3:
            continue  # both ways are equally short
        expected = Slerp([0, 1], pair)(fraction).as_matrix()
        np.testing.assert_allclose(
            interpolate_rotations(first, last, fraction), expected, atol=1e-6
        )


def test_continuous_signs_remove_jumps_and_keep_the_rotations():
    angles = np.linspace(0, 15, 60)
    quaternions = to_quaternions(axis_rotation(1, angles))
    assert np.abs(np.diff(quaternions, axis=0)).max() > 0.5
    smooth = continuous_signs(quaternions)
    assert np.abs(np.diff(smooth, axis=0)).max() < 0.2
    np.testing.assert_allclose(from_quaternions(smooth), axis_rotation(1, angles), atol=1e-12)


def test_signed_slerp_follows_the_given_signs():
    start, end = to_quaternions(axis_rotation(1, np.array([0.0, 1.0])))
    short, long = signed_slerp(start, end, 0.5), signed_slerp(start, -end, 0.5)
    np.testing.assert_allclose(
        from_quaternions(short), axis_rotation(1, np.array(0.5)), atol=1e-12
    )
    np.testing.assert_allclose(
        from_quaternions(long), axis_rotation(1, np.array(0.5 - np.pi)), atol=1e-12
    )
    np.testing.assert_allclose(slerp(start, -end, 0.5), short, atol=1e-12)
