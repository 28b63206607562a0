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

"""Serialized messages to values and back."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from ros_messages import CAMERA_INFO, POINT_CLOUD, camera_info, header, image, serialise

from lsc_pose_ros.bags.serialization.deserialize import (
    DamagedMessageError,
    read_camera_info,
    read_image,
    read_skeletons,
)
from lsc_pose_ros.bags.serialization.serialize import (
    camera_info_message,
    depth_message,
    markers_message,
    mask_message,
    skeletons_message,
)
from lsc_pose_ros.bags.serialization.type_store import message_class, typestore
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.codecs.image_encodings import decode_depth
from lsc_pose_ros.messages.markers import skeleton_markers

STAMP = 1_700_000_001_234_567_891


@pytest.fixture
def skeletons():
    random = np.random.default_rng(0)
    positions = random.normal(size=(3, 5, 3)).astype(np.float32)
    positions[1, 2] = np.nan
    confidence = random.random((3, 5)).astype(np.float32)
    return Skeletons(
        np.array([1, 2, 300], np.uint16),
        np.array([0, 1, 2, 6, 19], np.uint16),
        positions,
        confidence,
    )


def test_depth_in_millimetres_and_what_is_invalid():
    depth = np.array([[0, 1.0, 2.0004], [np.nan, np.inf, 65.6], [-1, 65.535, 0.0006]], np.float32)
    message = read_image(depth_message(STAMP, 'optical', depth))
    assert (message.stamp, message.frame_id) == (STAMP, 'optical')
    decoded = decode_depth(message.data, message.layout)
    wanted = [[0, 1.0, 2.0], [0, 0, 0], [0, 65.535, 0.001]]
    assert decoded == pytest.approx(np.array(wanted), abs=1e-5)


def test_masks_take_16_bits_only_when_they_must():
    labels = np.array([[-1, 1, 255]], np.int32)
    assert read_image(mask_message(0, '', labels)).layout.encoding == 'mono8'
    labels[0, 2] = 256
    message = read_image(mask_message(0, '', labels))
    assert message.layout.encoding == '16UC1'
    assert message.data.view('<u2').tolist() == [0, 1, 256]


def test_body_must_not_have_the_backgrounds_number():
    labels = np.array([[-1, 0, 1]], np.int32)
    with pytest.raises(InputError, match='body number 0'):
        mask_message(0, '', labels)
    assert read_image(mask_message(0, '', labels, background=255)).data.tolist() == [255, 0, 1]
    with pytest.raises(InputError, match='70000'):
        mask_message(0, '', np.array([[70000]], np.int32))


def test_camera_info_there_and_back():
    camera = Intrinsics(500.5, 501.25, 319.5, 239.5)
    message = read_camera_info(camera_info_message(STAMP, 'optical', camera, (480, 640)))
    assert message[:4] == (STAMP, 480, 640, camera)


def test_camera_info_with_binning_and_region():
    roi = SimpleNamespace(x_offset=40, y_offset=20, height=400, width=560, do_rectify=False)
    data = camera_info(0, shape=(480, 640), binning_x=2, binning_y=4, roi=roi)
    assert read_camera_info(data)[1:4] == (100, 280, Intrinsics(30, 15.25, -4.25, 0.875))


@pytest.mark.parametrize(
    ('k', 'words'),
    [
        ([0] * 9, 'all zero'),
        ([1, 0, 1, 0, 0, 1, 0, 0, 1], 'focal'),
        ([np.nan, 0, 1, 0, 1, 1, 0, 0, 1], 'focal'),
        ([-5, 0, 1, 0, 5, 1, 0, 0, 1], 'focal'),
    ],
)
def test_camera_info_of_no_camera(k, words):
    with pytest.raises(InputError, match=words):
        read_camera_info(camera_info(0, k=k))


def test_skeletons_there_and_back(skeletons):
    message = read_skeletons(skeletons_message(STAMP, 'optical', skeletons))
    assert message.stamp == STAMP
    for name, values in skeletons._asdict().items():
        np.testing.assert_array_equal(getattr(message.skeletons, name), values)


def test_cloud_has_the_documented_layout(skeletons):
    cloud: Any = typestore().deserialize_cdr(skeletons_message(STAMP, 'f', skeletons), POINT_CLOUD)
    fields = [(field.name, field.offset, field.datatype, field.count) for field in cloud.fields]
    assert fields == [
        ('x', 0, 7, 1),
        ('y', 4, 7, 1),
        ('z', 8, 7, 1),
        ('confidence', 12, 7, 1),
        ('body', 16, 4, 1),
        ('joint', 18, 4, 1),
    ]
    assert (cloud.height, cloud.width, cloud.point_step, cloud.row_step) == (3, 5, 20, 100)
    assert len(cloud.data) == 300
    assert not cloud.is_dense


def test_skeletons_of_nobody():
    joints = np.arange(4, dtype=np.uint16)
    nobody = Skeletons(
        np.zeros(0, np.uint16),
        joints,
        np.zeros((0, 4, 3), np.float32),
        np.zeros((0, 4), np.float32),
    )
    read = read_skeletons(skeletons_message(0, '', nobody)).skeletons
    assert read.positions.shape == (0, 4, 3)


def test_clouds_of_another_layout_are_read(skeletons):
    """Big endian, float64, other offsets, and rows with padding."""
    names = ['joint', 'body', 'confidence', 'z', 'y', 'x']
    point = np.dtype(
        {
            'names': names,
            'formats': ['>u2', '>u2', '>f4', '>f8', '>f8', '>f8'],
            'offsets': [2, 6, 8, 16, 24, 32],
            'itemsize': 44,
        }
    )
    points = np.zeros((3, 5), point)
    points['joint'], points['body'] = skeletons.joints, skeletons.bodies[:, None]
    points['confidence'] = skeletons.confidence
    for axis, name in enumerate('xyz'):
        points[name] = skeletons.positions[..., axis]
    rows = np.zeros((3, 5 * 44 + 7), np.uint8)
    rows[:, : 5 * 44] = np.frombuffer(points.tobytes(), np.uint8).reshape(3, -1)
    field = message_class('sensor_msgs/msg/PointField')
    numbers = {'u2': 4, 'f4': 7, 'f8': 8}
    fields = [
        field(name=name, offset=point.fields[name][1], count=1,
              datatype=numbers[point.fields[name][0].str[1:]])
        for name in names
    ]  # fmt: skip
    cloud = message_class(POINT_CLOUD)(
        header=header(STAMP), height=3, width=5, fields=fields, is_bigendian=True,
        point_step=44, row_step=227, data=rows.reshape(-1), is_dense=False,
    )  # fmt: skip
    read = read_skeletons(serialise(cloud, POINT_CLOUD)).skeletons
    np.testing.assert_array_equal(read.positions, skeletons.positions)
    np.testing.assert_array_equal(read.bodies, skeletons.bodies)
    np.testing.assert_array_equal(read.joints, skeletons.joints)


def test_cloud_without_skeletons():
    cloud = message_class(POINT_CLOUD)(
        header=header(0), height=1, width=0, fields=[], is_bigendian=False,
        point_step=12, row_step=0, data=np.zeros(0, np.uint8), is_dense=True,
    )  # fmt: skip
    with pytest.raises(InputError, match='no field x, y, z, confidence, body, joint'):
        read_skeletons(serialise(cloud, POINT_CLOUD))


def test_big_endian_serialisation_is_read():
    info = typestore().deserialize_cdr(camera_info(STAMP), CAMERA_INFO)
    data = serialise(info, CAMERA_INFO, little_endian=False)
    assert read_camera_info(data) == read_camera_info(camera_info(STAMP))


def test_images_pixels_are_not_copied():
    data = image(0, np.ones((40, 50), np.uint16), '16UC1')
    pixels = read_image(data).data
    assert np.shares_memory(pixels, np.frombuffer(data, np.uint8))


@pytest.mark.parametrize('data', [b'', b'\0\1\0', b'\0\1\0\0', b'\7\7\7\7' + bytes(99)])
def test_what_is_no_message(data):
    for read in (read_image, read_camera_info, read_skeletons):
        with pytest.raises(DamagedMessageError, match='no readable sensor_msgs'):
            read(data)


def test_random_damage_never_does_worse_than_an_input_error(skeletons):
    random = np.random.default_rng(4)
    messages: dict[Any, bytes] = {
        read_image: image(0, np.ones((4, 5), np.uint16), '16UC1'),
        read_camera_info: camera_info(0),
        read_skeletons: skeletons_message(0, 'f', skeletons),
    }
    for read, data in messages.items():
        for _ in range(300):
            damaged = bytearray(data[: int(random.integers(1, len(data) + 1))])
            damaged[int(random.integers(min(len(damaged), 200)))] ^= 1 << int(random.integers(8))
            try:
                read(bytes(damaged))
            except InputError:
                continue


def test_markers_are_what_rviz_draws(skeletons):
    edges = np.array([[0, 1], [1, 2]], np.int32)
    shapes = skeleton_markers(skeletons, edges, gone={9})
    array: Any = typestore().deserialize_cdr(
        markers_message(STAMP, 'optical', shapes), 'visualization_msgs/msg/MarkerArray'
    )
    assert len(array.markers) == len(shapes) == 8
    for marker, shape in zip(array.markers, shapes, strict=True):
        assert (marker.ns, marker.id) == (shape.namespace, shape.identifier)
        assert marker.type == {'spheres': 7, 'lines': 5}[shape.kind]
        assert marker.action == {'add': 0, 'delete': 2}[shape.action]
        assert len(marker.points) == len(marker.colors) == len(shape.points)
        assert marker.pose.orientation.w == 1
        assert marker.scale.x == pytest.approx(shape.size)
        assert marker.header.frame_id == 'optical'
        assert marker.lifetime.sec * 10**9 + marker.lifetime.nanosec == shape.lifetime_ns
    point = array.markers[2].points[1]
    assert [point.x, point.y, point.z] == pytest.approx(skeletons.positions[0, 1].tolist())


def test_image_that_claims_more_than_it_has():
    data = image(0, np.ones((4, 5), np.uint16), '16UC1', height=1 << 31, step=1 << 31)
    message = read_image(data)
    with pytest.raises(InputError, match='do not fill'):
        decode_depth(message.data, message.layout)
    assert message.data.dtype == np.uint8
