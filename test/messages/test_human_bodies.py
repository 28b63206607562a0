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

"""Regions, keypoints and messages of ROS4HRI, against the published definitions of hri_msgs."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rolled_frame import rolled
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from lsc_pose_ros.bags.serialization.type_store import ROSBAGS_CLASSES
from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.camera.roll import in_camera_frame, upright
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES, names_of, numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons, no_skeletons
from lsc_pose_ros.messages.build.humans import (
    build_ids,
    build_joint_state,
    build_region,
    build_skeleton2d,
)
from lsc_pose_ros.messages.human_bodies import (
    KEYPOINTS,
    BodyImage,
    Region,
    body_id,
    body_region,
    keypoints,
)

DEFINITIONS = Path(__file__).parents[1] / 'ros' / 'hri_definitions'
HEAD = (1_700_000_000_123_456_789, 'camera_optical')
CAMERA = Intrinsics(200.0, 210.0, 79.5, 59.5)


def frame_of_two() -> Frame:
    """Body 3 in columns 20 to 49 and rows 10 to 99; body 7 in the lower half of the last one."""
    labels = np.full((120, 160), NO_BODY, np.int32)
    labels[10:100, 20:50] = 3
    labels[60:, 159] = 7
    positions = np.full((1, 20, 3), np.nan, np.float32)
    positions[0, :, 0] = np.linspace(-0.6, 0.2, 20)
    positions[0, :, 1] = np.linspace(-0.5, 0.5, 20)
    positions[0, :, 2] = 2.0
    positions[0, 19, 0] = 1.0  # outside of the image
    truth = Skeletons(
        np.array([3], np.uint16),
        numbers_of(JOINT_NAMES),
        positions,
        np.linspace(0.1, 1, 20, dtype=np.float32)[None],
    )
    depth = np.full((120, 160), 2, np.float32)
    return Frame(HEAD[0], HEAD[1], depth, labels, CAMERA, truth)


@pytest.mark.parametrize('roll', [0, 90, 180, 270])
def test_regions_are_those_of_the_camera_image(roll: int) -> None:
    seen = rolled(frame_of_two(), roll)
    image = BodyImage.of(upright(seen, roll), {1: 3, 2: 7, 5: 9})
    np.testing.assert_array_equal(image.labels, seen.labels)
    assert image.camera == seen.camera
    height, width = seen.labels.shape
    for number, label in ((1, 3), (2, 7)):
        region = body_region(image, number)
        assert region is not None
        inside = np.zeros_like(seen.labels, bool)
        columns = slice(round(region.xmin * width), round(region.xmax * width))
        inside[round(region.ymin * height) : round(region.ymax * height), columns] = True
        np.testing.assert_array_equal(inside, seen.labels == label)  # both are rectangles
    assert body_region(image, 5) is None  # no pixel has its label
    assert body_region(image, 6) is None


def test_region_in_numbers() -> None:
    image = BodyImage.of(frame_of_two(), {3: 3, 7: 7})
    assert body_region(image, 3) == Region(20 / 160, 10 / 120, 50 / 160, 100 / 120)
    assert body_region(image, 7) == Region(159 / 160, 0.5, 1.0, 1.0)


@pytest.mark.parametrize('roll', [0, 90, 180, 270])
def test_keypoints_are_those_of_the_camera_image(roll: int) -> None:
    seen = rolled(frame_of_two(), roll)
    frame = upright(seen, roll)
    assert seen.ground_truth is not None
    assert frame.ground_truth is not None
    skeletons = in_camera_frame(frame.ground_truth, roll)
    points = keypoints(skeletons, BodyImage.of(frame, {3: 3}))
    assert points.shape == (1, 18, 3)
    names = names_of(skeletons.joints)
    height, width = seen.labels.shape
    pixels = project(seen.ground_truth.positions[0], seen.camera)
    for name, (x, y, confidence) in zip(KEYPOINTS, points[0].tolist(), strict=True):
        if name not in names:
            assert (x, y, confidence) == (0, 0, 0), name
            continue
        joint = names.index(name)
        # A pixel has the width 1, and its centre a whole number.
        assert x * width - 0.5 == pytest.approx(pixels[joint, 0], abs=1e-3), name
        assert y * height - 0.5 == pytest.approx(pixels[joint, 1], abs=1e-3), name
        assert confidence == skeletons.confidence[0, joint]
    assert {'nose', 'l_eye', 'r_ear'} < set(KEYPOINTS) - set(names)


def test_unknown_points_and_points_outside_of_the_image_are_zero() -> None:
    frame = frame_of_two()
    assert frame.ground_truth is not None
    positions = frame.ground_truth.positions.copy()
    positions[0, numbers_of(['l_wrist'])] = np.nan
    positions[0, numbers_of(['r_wrist'])] = (3, 0, 2)
    positions[0, numbers_of(['r_knee'])] = (0, 0, -2)
    # The corner of the image, half a pixel from the centre of its first pixel.
    positions[0, numbers_of(['l_knee'])] = (-79.999 / 200 * 2, -59.999 / 210 * 2, 2)
    points = keypoints(
        frame.ground_truth._replace(positions=positions), BodyImage.of(frame, {3: 3})
    )[0]
    for name in ('l_wrist', 'r_wrist', 'r_knee'):
        assert points[KEYPOINTS.index(name)].tolist() == [0, 0, 0]
    assert points[KEYPOINTS.index('l_knee')] == pytest.approx(
        [0, 0, frame.ground_truth.confidence[0, numbers_of(['l_knee'])[0]]], abs=1e-5
    )
    assert ((points >= 0) & (points <= 1)).all()


def test_a_model_of_few_joints_and_nobody() -> None:
    frame = frame_of_two()
    assert frame.ground_truth is not None
    joints = numbers_of(['head', 'neck', 'l_hip'])
    few = Skeletons(
        frame.ground_truth.bodies,
        joints,
        frame.ground_truth.positions[:, joints],
        frame.ground_truth.confidence[:, joints],
    )
    image = BodyImage.of(frame, {3: 3})
    points = keypoints(few, image)[0]
    known = [name for name, point in zip(KEYPOINTS, points, strict=True) if point[2]]
    assert known == ['neck', 'l_hip']
    assert keypoints(no_skeletons(joints), image).shape == (0, 18, 3)


def test_ids_begin_with_a_letter() -> None:
    """A part of a topic's name must not begin with a digit (design.ros2.org: topic names)."""
    assert [body_id(number) for number in (0, 1, 65535)] == ['b0', 'b1', 'b65535']


def test_messages_that_others_can_read() -> None:
    store = get_typestore(Stores.ROS2_JAZZY)
    for file in DEFINITIONS.glob('*.msg'):
        name = f'hri_msgs/msg/{file.stem}'
        store.register(get_types_from_msg(file.read_text(encoding='utf-8'), name))
    classes = ROSBAGS_CLASSES._replace(find=lambda name: store.types[name])
    points = np.random.default_rng(0).random((18, 3)).astype(np.float32)
    angles = {'waist_b1': 0.0, 'l_elbow_b1': 1.25}
    messages = {
        'hri_msgs/msg/IdsList': build_ids(classes, *HEAD, ['b1', 'b20']),
        'hri_msgs/msg/NormalizedRegionOfInterest2D': build_region(
            classes, *HEAD, Region(0.25, 0.5, 0.75, 1.0), 0.125
        ),
        'hri_msgs/msg/Skeleton2D': build_skeleton2d(classes, *HEAD, points),
        'sensor_msgs/msg/JointState': build_joint_state(classes, *HEAD, angles),
    }
    read: dict[str, Any] = {
        name: store.deserialize_cdr(store.serialize_cdr(message, name), name)
        for name, message in messages.items()
    }
    for message in read.values():
        stamp = message.header.stamp
        assert (stamp.sec, stamp.nanosec, message.header.frame_id) == (
            1_700_000_000,
            123_456_789,
            'camera_optical',
        )
    ids, region, skeleton, state = read.values()
    assert ids.ids == ['b1', 'b20']
    assert (region.xmin, region.ymin, region.xmax, region.ymax, region.c) == (
        0.25, 0.5, 0.75, 1.0, 0.125,
    )  # fmt: skip
    assert [(point.x, point.y, point.c) for point in skeleton.skeleton] == [
        tuple(point) for point in points.tolist()
    ]
    assert dict(zip(state.name, state.position.tolist(), strict=True)) == angles
    assert len(state.velocity) == len(state.effort) == 0
    # The constants of the message, by which its readers find the points.
    constants = {
        name.lower(): getattr(store.types['hri_msgs/msg/Skeleton2D'], name)
        for name in dir(store.types['hri_msgs/msg/Skeleton2D'])
        if name.isupper() and not name.startswith('_')
    }
    sides = {'left_': 'l_', 'right_': 'r_'}
    for name, place in constants.items():
        short = next((name.replace(k, v) for k, v in sides.items() if name.startswith(k)), name)
        assert KEYPOINTS[place] == short
    assert len(constants) == len(KEYPOINTS)
