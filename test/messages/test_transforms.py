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

"""Skeletons as TF frames."""

from typing import Any

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from lsc_pose_ros.bags.serialization.serialize import transforms_message
from lsc_pose_ros.data_types.joints import numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons, no_skeletons
from lsc_pose_ros.messages.transforms import skeleton_transforms

NAMES = ['head', 'neck', 'l_hip', 'r_hip']
CAMERA = 'camera_optical'


@pytest.fixture
def skeletons():
    """Body 3 faces the camera; of body 12 the hips are unknown."""
    standing = [(0.1, -0.7, 3.0), (0.0, -0.5, 3.0), (0.12, 0.0, 3.0), (-0.12, 0.0, 3.0)]
    positions = np.array([standing, standing], np.float32)
    positions[1, 2] = np.nan
    confidence = np.array([[0.3, 0.9, 0.9, 0.9], [0.9, 0.9, 0.0, 0.9]], np.float32)
    return Skeletons(np.array([3, 12], np.uint16), numbers_of(NAMES), positions, confidence)


def test_names_and_parents(skeletons):
    pairs = [(each.parent, each.child) for each in skeleton_transforms(skeletons, CAMERA)]
    assert pairs == [
        (CAMERA, 'body_3'),
        ('body_3', 'head_3'),
        ('body_3', 'neck_3'),
        ('body_3', 'l_hip_3'),
        ('body_3', 'r_hip_3'),
        (CAMERA, 'head_12'),
        (CAMERA, 'neck_12'),
        (CAMERA, 'r_hip_12'),
    ]


def test_places(skeletons):
    found = {each.child: each for each in skeleton_transforms(skeletons, CAMERA)}
    body = found['body_3']
    np.testing.assert_allclose(body.translation, (0, 0, 3), atol=1e-6)
    # x towards the camera, y to the image's right, z up.
    np.testing.assert_allclose(body.rotation, (0.5, 0.5, -0.5, 0.5), atol=1e-6)
    np.testing.assert_allclose(found['head_3'].translation, (0, 0.1, 0.7), atol=1e-6)
    np.testing.assert_allclose(found['r_hip_3'].translation, (0, -0.12, 0), atol=1e-6)
    np.testing.assert_allclose(found['head_12'].translation, (0.1, -0.7, 3), atol=1e-6)
    assert found['head_3'].rotation == found['head_12'].rotation == (0, 0, 0, 1)


def test_unsure_joints_are_left_out(skeletons):
    children = [each.child for each in skeleton_transforms(skeletons, CAMERA, 0.5)]
    assert 'head_3' not in children
    assert {'head_12', 'body_3'} <= set(children)


def test_message_that_others_can_read(skeletons):
    transforms = skeleton_transforms(skeletons, CAMERA)
    stamp = 1_700_000_000_123_456_789
    store = get_typestore(Stores.ROS2_JAZZY)
    message: Any = store.deserialize_cdr(
        transforms_message(stamp, transforms), 'tf2_msgs/msg/TFMessage'
    )
    assert len(message.transforms) == len(transforms)
    for found, expected in zip(message.transforms, transforms, strict=True):
        assert (found.header.stamp.sec, found.header.stamp.nanosec) == (1_700_000_000, 123_456_789)
        assert (found.header.frame_id, found.child_frame_id) == expected[:2]
        place, turn = found.transform.translation, found.transform.rotation
        assert (place.x, place.y, place.z) == expected.translation
        assert (turn.x, turn.y, turn.z, turn.w) == expected.rotation


def test_nobody(skeletons):
    assert skeleton_transforms(no_skeletons(skeletons.joints), CAMERA) == []
