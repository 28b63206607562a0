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

"""Absurd depths, cameras and point clouds: nothing is read or written past an array."""

from types import SimpleNamespace

import numpy as np
import pytest
from tiny_model import tiny_model

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.image_arguments import check_images
from lsc_pose_ros.data_types.skeletons import POINT_DTYPE
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.camera_info import image_camera
from lsc_pose_ros.messages.codecs.compressed_depth import encode_compressed_depth
from lsc_pose_ros.messages.codecs.image_encodings import ImageLayout
from lsc_pose_ros.messages.parse import (
    StampedCamera,
    StampedCompressedImage,
    StampedImage,
    parse_skeletons,
)
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.features.nearest_bin import describe_by_nearest_bin
from lsc_pose_ros.pose.features.shape_context_2d import describe_in_image
from lsc_pose_ros.pose.features.shape_context_3d import describe
from lsc_pose_ros.settings.table import FrameSettings
from lsc_pose_ros.synchronization.frame_maker import FrameMaker

LARGEST = float(np.finfo(np.float32).max)
CAMERA = Intrinsics(140.0, 140.0, 80.0, 60.0)
TOPICS = SimpleNamespace(depth='/depth', camera_info='/info', mask='/mask')


def depth_of_frame(image, **settings):
    maker = FrameMaker(TOPICS, FrameSettings(segmentation='mask', **settings))
    return maker.make(image, None, StampedCamera(0, 0, 0, CAMERA)).depth


def float_image(values, *, big_endian=False):
    pixels = np.array([values], '<f4')
    layout = ImageLayout('32FC1', 1, len(values), 4 * len(values), big_endian)
    return StampedImage(0, 'optical', layout, np.frombuffer(pixels.tobytes(), np.uint8))


def test_depth_outside_of_the_range_is_no_depth():
    image = float_image([2.0, LARGEST, 0.09, -1.0, 20.5, 20.0, np.nan, np.inf, 1e-40])
    assert depth_of_frame(image).tolist() == [[2, 0, 0, 0, 0, 20, 0, 0, 0]]


def test_depth_range_is_a_setting():
    image = float_image([0.5, 2.0, 6.0])
    settings = {'minimum_depth': 1.0, 'maximum_depth': 5.0}
    assert depth_of_frame(image, **settings).tolist() == [[0, 2, 0]]
    with pytest.raises(InputError, match='minimum_depth must be the smaller'):
        depth_of_frame(image, minimum_depth=5.0, maximum_depth=1.0)


def test_floats_in_the_wrong_order_of_bytes_stay_in_the_range():
    values = np.random.default_rng(0).uniform(0.5, 8.0, 1000).tolist()
    depth = depth_of_frame(float_image(values, big_endian=True))
    assert ((depth == 0) | ((depth >= 0.1) & (depth <= 20))).all()


@pytest.mark.parametrize(('scale', 'offset'), [(1e38, 1.0), (-1e38, 1.0), (np.nan, np.inf)])
def test_absurd_quantisation_of_compressed_depth_stays_in_the_range(scale, offset):
    depth = np.full((6, 8), 2.0, np.float32)
    text, data = encode_compressed_depth(depth)
    damaged = np.frombuffer(data, np.uint8).copy()
    damaged[4:12] = np.frombuffer(np.array([scale, offset], '<f4').tobytes(), np.uint8)
    assert not depth_of_frame(StampedCompressedImage(0, 'optical', text, damaged)).any()


ABSURD = [(1e20, 60.0), (1e-17, 60.0), (140.0, 1e20), (140.0, -1e300)]


@pytest.mark.parametrize(('focal_length', 'centre'), ABSURD)
def test_absurd_camera_infos_are_refused(focal_length, centre):
    k = [focal_length, 0.0, centre, 0.0, focal_length, centre, 0.0, 0.0, 1.0]
    region = SimpleNamespace(x_offset=0, y_offset=0, width=0, height=0)
    info = SimpleNamespace(
        height=480, width=640, distortion_model='', d=[], k=k, p=[0.0] * 12,
        binning_x=0, binning_y=0, roi=region,
    )  # fmt: skip
    with pytest.raises(InputError, match='focal lengths from 1 to'):
        image_camera(info)


def test_message_about_many_coefficients_is_short():
    k = [140.0, 0.0, 80.0, 0.0, 140.0, 60.0, 0.0, 0.0, 1.0]
    region = SimpleNamespace(x_offset=0, y_offset=0, width=0, height=0)
    info = SimpleNamespace(
        height=480, width=640, distortion_model='', d=[np.nan] * 10_000, k=k, p=[0.0] * 12,
        binning_x=0, binning_y=0, roi=region,
    )  # fmt: skip
    with pytest.raises(InputError, match='D of the camera info is not finite') as caught:
        image_camera(info)
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize(('focal_length', 'centre'), ABSURD)
def test_absurd_intrinsics_are_refused(focal_length, centre):
    depth, labels = np.zeros((2, 2), np.float32), np.full((2, 2), NO_BODY, np.int32)
    with pytest.raises(InputError, match='focal lengths must be from 1 to'):
        check_images(depth, labels, Intrinsics(focal_length, focal_length, centre, centre))


def test_camera_infos_that_are_wrong_in_other_ways_each_time_are_told_a_few_times():
    maker = FrameMaker(TOPICS, FrameSettings(segmentation='mask'))
    for number in range(100):
        camera = StampedCamera(0, 0, 0, CAMERA, warning=f'model {number} is not known')
        maker.make(float_image([2.0]), None, camera)
        maker.make(float_image([2.0]), None, camera)
    assert maker.warnings == [f'/info: model {number} is not known' for number in range(3)]


@pytest.mark.parametrize('value', [LARGEST, 1e19, 1e-30, -3.0, np.nan, np.inf, -np.inf])
def test_absurd_depth_on_a_body_does_no_harm(value):
    depth = np.full((120, 160), 4.0, np.float32)
    labels = np.full(depth.shape, NO_BODY, np.int32)
    depth[20:100, 60:100], labels[20:100, 60:100] = 2.0, 1
    depth[20:100:2, 60:100:2] = value
    try:
        skeletons = Estimator(tiny_model()).estimate(depth, labels, CAMERA)
    except InputError as error:
        assert 'metres' in str(error)  # noqa: PT017 - either is right
    else:
        assert skeletons.bodies.tolist() == [1]


@pytest.mark.parametrize('value', [LARGEST, np.nan, np.inf, 1e19])
@pytest.mark.parametrize('function', [describe, describe_by_nearest_bin, describe_in_image])
def test_absurd_points_have_a_descriptor(function, value):
    dimensions = 2 if function is describe_in_image else 3
    points = np.random.default_rng(0).uniform(-1, 1, (50, dimensions)).astype(np.float32)
    points[::3, -1] = value
    for radius in (1.0, np.nan, np.inf, 1e30):
        found = function(points, np.arange(50), radius, 0.1)
        assert len(found) == 50


@pytest.mark.parametrize('offset', [2147483647, 1 << 32, 17])
def test_point_field_outside_of_its_point_is_refused(offset):
    kinds = {'f4': 7, 'u2': 4}
    fields = [
        SimpleNamespace(name=name, offset=place, datatype=kinds[kind.str[1:]], count=1)
        for name, (kind, place, *_) in (POINT_DTYPE.fields or {}).items()
    ]
    fields[0].offset = offset
    cloud = SimpleNamespace(
        header=SimpleNamespace(stamp=SimpleNamespace(sec=0, nanosec=0), frame_id=''),
        height=1, width=1, fields=fields, is_bigendian=False, point_step=20, row_step=20,
        data=np.zeros(20, np.uint8),
    )  # fmt: skip
    with pytest.raises(InputError, match='does not fit a point of 20 bytes'):
        parse_skeletons(cloud)


@pytest.mark.parametrize(
    ('height', 'width', 'row_step'), [(0, 117_440_512, 40), (117_440_512, 0, 0), (3, 1, 20)]
)
def test_cloud_that_claims_more_than_it_holds_is_refused(height, width, row_step):
    fields = [
        SimpleNamespace(name=name, offset=place, datatype={'f4': 7, 'u2': 4}[kind.str[1:]])
        for name, (kind, place, *_) in (POINT_DTYPE.fields or {}).items()
    ]
    cloud = SimpleNamespace(
        header=SimpleNamespace(stamp=SimpleNamespace(sec=0, nanosec=0), frame_id=''),
        height=height, width=width, fields=fields, is_bigendian=False, point_step=20,
        row_step=row_step, data=np.zeros(40, np.uint8),
    )  # fmt: skip
    with pytest.raises(InputError, match='has 40 bytes, but claims'):
        parse_skeletons(cloud)
