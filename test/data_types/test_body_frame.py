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

"""The body frame of REP-155: x out of the body, y to its left, z towards the head."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.body_frame import body_frame, quaternion
from lsc_pose_ros.data_types.joints import JOINT_NAMES, names_of, numbers_of

# A person who stands 3 m away and faces the camera; optical frame: x right, y down, z forward.
BODY_YAW = {
    'head': (0.0, -0.7, 3.0),
    'neck': (0.0, -0.5, 3.0),
    'torso': (0.0, -0.25, 3.0),
    'pelvis': (0.0, 0.02, 3.0),
    'l_shoulder': (0.2, -0.45, 3.0),
    'r_shoulder': (-0.2, -0.45, 3.0),
    'l_hip': (0.12, 0.0, 3.0),
    'r_hip': (-0.12, 0.0, 3.0),
    'l_hand': (0.5, -0.1, 2.8),
}
# x towards the camera, y to the image's right, z up.
BODY_YAW_AXES = np.array([[0, 1, 0], [0, 0, -1], [-1, 0, 0]], float)


def joints_of(places):
    numbers = numbers_of(places)
    positions = np.array([places[name] for name in names_of(numbers)], np.float32)
    return numbers, positions


def turned(places, rotation):
    return {name: tuple(rotation @ place) for name, place in places.items()}


def random_rotation(random):
    rotation, triangle = np.linalg.qr(random.normal(size=(3, 3)))
    rotation = rotation * np.sign(np.diag(triangle))
    return rotation if np.linalg.det(rotation) > 0 else -rotation


def test_person_who_faces_the_camera():
    frame = body_frame(*joints_of(BODY_YAW))
    np.testing.assert_allclose(frame.origin, (0, 0, 3), atol=1e-6)
    np.testing.assert_allclose(frame.axes, BODY_YAW_AXES, atol=1e-6)
    places = np.array([BODY_YAW['head'], BODY_YAW['l_hand']], np.float32)
    np.testing.assert_allclose(frame.inside(places), [(0, 0, 0.7), (0.2, 0.5, 0.1)], atol=1e-6)


def test_frame_turns_with_the_body():
    random = np.random.default_rng(1)
    for _ in range(20):
        rotation = random_rotation(random)
        frame = body_frame(*joints_of(turned(BODY_YAW, rotation)))
        np.testing.assert_allclose(frame.axes, rotation @ BODY_YAW_AXES, atol=1e-5)
        np.testing.assert_allclose(frame.origin, rotation @ (0, 0, 3), atol=1e-5)


@pytest.mark.parametrize(
    'missing',
    [
        ['neck'],
        ['neck', 'l_shoulder', 'head'],
        ['l_hip'],
        ['l_hip', 'l_shoulder'],
        ['neck', 'l_shoulder', 'head', 'torso'],
        ['neck', 'l_shoulder', 'head', 'torso', 'r_hip'],
    ],
)
@pytest.mark.parametrize('unknown', ['not in the model', 'not seen'])
def test_other_joints_replace_missing_ones(missing, unknown):
    if unknown == 'not in the model':
        places = {name: place for name, place in BODY_YAW.items() if name not in missing}
    else:
        places = {**BODY_YAW, **dict.fromkeys(missing, (np.nan,) * 3)}
    frame = body_frame(*joints_of(places))
    np.testing.assert_allclose(frame.axes, BODY_YAW_AXES, atol=1e-6)
    middle = BODY_YAW['pelvis'] if {'l_hip', 'r_hip'} & set(missing) else (0, 0, 3)
    np.testing.assert_allclose(frame.origin, middle, atol=1e-6)


def test_no_frame_without_hips_and_pelvis():
    places = {name: place for name, place in BODY_YAW.items() if name not in {'pelvis', 'r_hip'}}
    assert body_frame(*joints_of(places)) is None


def test_axes_are_a_rotation_for_any_joints():
    random = np.random.default_rng(5)
    numbers = numbers_of(JOINT_NAMES)
    for trial in range(200):
        positions = random.normal(size=(len(numbers), 3)).astype(np.float32)
        positions[random.random(len(numbers)) < 0.4] = np.nan
        if trial % 4 == 0:  # all at one position
            positions[:] = positions[0]
        frame = body_frame(numbers, positions)
        if frame is not None:
            np.testing.assert_allclose(frame.axes.T @ frame.axes, np.eye(3), atol=1e-9)
            assert np.linalg.det(frame.axes) == pytest.approx(1)


def matrix(x, y, z, w):
    """The rotation matrix of a unit quaternion, as in textbooks."""
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def test_quaternion_of_any_rotation():
    random = np.random.default_rng(8)
    half_turns = [np.diag(signs) for signs in ((1, -1, -1), (-1, 1, -1), (-1, -1, 1), (1, 1, 1))]
    for rotation in [*half_turns, *(random_rotation(random) for _ in range(50))]:
        found = quaternion(np.asarray(rotation, float))
        assert np.linalg.norm(found) == pytest.approx(1)
        assert found[3] >= 0
        np.testing.assert_allclose(matrix(*found), rotation, atol=1e-9)
