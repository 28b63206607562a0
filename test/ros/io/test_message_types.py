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

"""The node publishes the same messages as a replay writes."""

import numpy as np
import pytest

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from rclpy.serialization import serialize_message

from lsc_pose_ros.bags.serialization.serialize import (
    camera_info_message,
    depth_message,
    markers_message,
    mask_message,
    serialize,
    skeletons_message,
    transforms_message,
)
from lsc_pose_ros.bags.serialization.type_store import typestore
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.joints import numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.messages.build.images import build_camera_info, build_depth_image, build_mask
from lsc_pose_ros.messages.build.markers import build_markers
from lsc_pose_ros.messages.build.skeletons import build_skeletons
from lsc_pose_ros.messages.build.transforms import build_transforms
from lsc_pose_ros.messages.markers import skeleton_markers
from lsc_pose_ros.messages.message_classes import MessageClasses
from lsc_pose_ros.messages.transforms import skeleton_transforms
from lsc_pose_ros.messages.type_names import (
    CAMERA_INFO,
    IMAGE,
    MARKER_ARRAY,
    POINT_CLOUD,
    TF_MESSAGE,
)
from lsc_pose_ros.ros.io.message_types import RCLPY_CLASSES

HEAD = (1_700_000_001_234_567_891, 'camera_optical')
JOINTS = ['head', 'neck', 'torso', 'l_hip', 'r_hip']
EDGES = np.array([[0, 1], [1, 2], [2, 3], [2, 4]], np.int32)


def skeletons_of(bodies: int) -> Skeletons:
    random = np.random.default_rng(bodies)
    positions = random.normal(size=(bodies, len(JOINTS), 3)).astype(np.float32)
    positions[:1, 1] = np.nan
    positions[1:2, 0] = (0.0, -0.0, 1.0)
    confidence = random.random((bodies, len(JOINTS))).astype(np.float32)
    numbers = np.arange(3, 3 + bodies, dtype=np.uint16)
    return Skeletons(numbers, numbers_of(JOINTS), positions, confidence)


def assert_same(live: object, offline: bytes, type_name: str) -> None:
    """Compare byte for byte, except for the padding: Fast CDR leaves its value undefined."""
    data = serialize_message(live)
    assert len(data) == len(offline)
    content = typestore().deserialize_cdr(data, type_name)
    assert serialize(content, type_name) == offline


@pytest.fixture(params=[False, True])
def classes(request: pytest.FixtureRequest) -> MessageClasses:
    """The classes of rclpy, without and with the checks of field types."""

    def find(type_name: str) -> object:
        found = RCLPY_CLASSES.find(type_name)
        return lambda **fields: found(check_fields=request.param, **fields)

    return RCLPY_CLASSES._replace(find=find)


@pytest.mark.parametrize('bodies', [0, 1, 3])
def test_skeletons_and_markers(classes: MessageClasses, bodies: int) -> None:
    skeletons = skeletons_of(bodies)
    cloud = build_skeletons(classes, *HEAD, skeletons)
    assert_same(cloud, skeletons_message(*HEAD, skeletons), POINT_CLOUD)
    shapes = skeleton_markers(skeletons, EDGES, minimum_confidence=0.2, gone={9})
    markers = build_markers(classes, *HEAD, shapes)
    assert_same(markers, markers_message(*HEAD, shapes), MARKER_ARRAY)


@pytest.mark.parametrize('largest', [3, 300])
def test_images_and_camera_info(largest: int) -> None:
    depth = np.linspace(0, 70, 35, dtype=np.float32).reshape(5, 7)
    depth[0, 3] = np.nan
    labels = np.where(depth > 20, largest, -1).astype(np.int32)
    camera = Intrinsics(500.5, 501.25, 3.5, 2.5)
    image = build_depth_image(RCLPY_CLASSES, *HEAD, depth)
    assert_same(image, depth_message(*HEAD, depth), IMAGE)
    mask = build_mask(RCLPY_CLASSES, *HEAD, labels, 255)
    assert_same(mask, mask_message(*HEAD, labels, 255), IMAGE)
    info = build_camera_info(RCLPY_CLASSES, *HEAD, camera, depth.shape)
    assert_same(info, camera_info_message(*HEAD, camera, depth.shape), CAMERA_INFO)


def test_transforms(classes: MessageClasses) -> None:
    """Without the package tf2_msgs: the class of the list alone comes from rosbags."""

    def find(type_name: str) -> object:
        if type_name == TF_MESSAGE:
            return typestore().types[type_name]
        return classes.find(type_name)

    transforms = skeleton_transforms(skeletons_of(2), HEAD[1])
    message = build_transforms(classes._replace(find=find), HEAD[0], transforms)
    expected = transforms_message(HEAD[0], transforms)
    assert serialize(message, TF_MESSAGE) == expected
    assert {type(each).__module__ for each in message.transforms} == {
        'geometry_msgs.msg._transform_stamped'
    }
