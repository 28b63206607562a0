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

"""Real ROS messages to frames."""

import array

import numpy as np
import pytest

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.codecs.compressed_depth import encode_compressed_depth
from lsc_pose_ros.messages.codecs.png import write_png
from lsc_pose_ros.messages.parse import parse_image
from lsc_pose_ros.ros.health.stream_warnings import TopicNames
from lsc_pose_ros.ros.io.frame_messages import FrameMessages
from lsc_pose_ros.ros.io.frame_messages import frame_of as frame_of_maker
from lsc_pose_ros.settings.table import AUTO, NEAREST, FrameSettings
from lsc_pose_ros.synchronization.frame_maker import FrameMaker

TOPICS = TopicNames('/cam/depth', '/cam/info', '/seg/mask')
HEIGHT, WIDTH = 12, 16
STAMP = 1_700_000_000_123_456_789


def image(pixels: np.ndarray, encoding: str, padding: int = 0) -> Image:
    rows = np.zeros((len(pixels), pixels.shape[1] * pixels.itemsize + padding), np.uint8)
    rows[:, : rows.shape[1] - padding] = np.ascontiguousarray(pixels).view(np.uint8)
    message = Image(
        height=pixels.shape[0],
        width=pixels.shape[1],
        encoding=encoding,
        is_bigendian=int(pixels.dtype.byteorder == '>'),
        step=rows.shape[1],
        data=array.array('B', rows.tobytes()),
    )
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(STAMP, 10**9)
    message.header.frame_id = 'optical'
    return message


def camera_info(height: int = HEIGHT, width: int = WIDTH, focal: float = 20.0) -> CameraInfo:
    message = CameraInfo(height=height, width=width)
    message.k = np.array([focal, 0, 8, 0, focal, 6, 0, 0, 1 if focal else 0], np.float64)
    if not focal:
        message.k = np.zeros(9)
    return message


def frame_of(messages: FrameMessages, topics: TopicNames, background: int) -> Frame:
    settings = FrameSettings(mask_background=background)
    maker = FrameMaker(topics, settings)
    return frame_of_maker(messages, maker, topics, settings.rectified)


# From 0.1 m on: what is nearer is no depth.
MILLIMETRES = np.arange(10, HEIGHT * WIDTH + 10, dtype='<u2').reshape(HEIGHT, WIDTH) * 10
MASK = np.where(np.arange(WIDTH) > 7, 3, 0).astype('u1') * np.ones((HEIGHT, 1), 'u1')


def pair(depth: Image | CompressedImage, mask: Image | None = None) -> FrameMessages:
    return FrameMessages(depth, mask or image(MASK, 'mono8'), camera_info())


def test_frame_has_the_depth_images_header_and_the_camera() -> None:
    frame = frame_of(pair(image(MILLIMETRES, '16UC1')), TOPICS, 0)
    assert frame.stamp == STAMP
    assert frame.frame_id == 'optical'
    assert frame.camera == Intrinsics(20.0, 20.0, 8.0, 6.0)
    assert frame.ground_truth is None


@pytest.mark.parametrize('padding', [0, 6])
@pytest.mark.parametrize('order', ['<', '>'])
def test_millimetres_become_metres(order: str, padding: int) -> None:
    depth = image(MILLIMETRES.astype(f'{order}u2'), '16UC1', padding)
    frame = frame_of(pair(depth), TOPICS, 0)
    assert frame.depth.dtype == np.float32
    np.testing.assert_allclose(frame.depth, MILLIMETRES / 1000)


def test_metres_stay_metres_and_what_is_invalid_becomes_0() -> None:
    metres = (MILLIMETRES / 1000).astype('<f4')
    metres[0, :3] = np.nan, np.inf, -np.inf
    frame = frame_of(pair(image(metres, '32FC1')), TOPICS, 0)
    assert (frame.depth[0, :3] == 0).all()
    np.testing.assert_array_equal(frame.depth[1:], metres[1:])


@pytest.mark.parametrize('codec', ['png', 'rvl'])
def test_compressed_depth(codec: str) -> None:
    form, data = encode_compressed_depth(MILLIMETRES, codec)
    message = CompressedImage(format=form, data=array.array('B', data))
    frame = frame_of(pair(message), TOPICS, 0)
    np.testing.assert_allclose(frame.depth, MILLIMETRES / 1000)


def test_mask_numbers_and_background() -> None:
    mask = image(MASK, 'mono8')
    depth = image(MILLIMETRES, '16UC1')
    expected = np.where(MASK == 3, 3, NO_BODY)
    np.testing.assert_array_equal(frame_of(pair(depth, mask), TOPICS, 0).labels, expected)
    turned = np.where(MASK == 0, 0, NO_BODY)
    np.testing.assert_array_equal(frame_of(pair(depth, mask), TOPICS, 3).labels, turned)


@pytest.mark.parametrize('pixel', ['u1', 'u2'])
def test_compressed_mask(pixel: str) -> None:
    message = CompressedImage(
        format='mono8; png compressed', data=array.array('B', write_png(MASK.astype(pixel)))
    )
    frame = frame_of(FrameMessages(image(MILLIMETRES, '16UC1'), message, camera_info()), TOPICS, 0)
    np.testing.assert_array_equal(frame.labels, np.where(MASK == 3, 3, NO_BODY))


def test_mask_compressed_with_loss_is_refused() -> None:
    message = CompressedImage(format='mono8; jpeg compressed', data=array.array('B', b'123'))
    whole = FrameMessages(image(MILLIMETRES, '16UC1'), message, camera_info())
    with pytest.raises(InputError, match=r'/seg/mask: a mask compressed as .*only PNG'):
        frame_of(whole, TOPICS, 0)


def test_without_a_mask_the_segmenter_finds_the_bodies() -> None:
    room = np.full((120, 160), 4000, '<u2')
    room[20:100, 60:90] = 2000
    info = camera_info(120, 160, focal=143.0)
    info.k[[2, 5]] = 80, 60
    whole = FrameMessages(image(room, '16UC1'), None, info)
    maker = FrameMaker(TOPICS, FrameSettings(segmentation=NEAREST, range_max=3.0))
    frame = frame_of_maker(whole, maker, TOPICS, AUTO)
    np.testing.assert_array_equal(frame.labels, np.where(room == 2000, 1, NO_BODY))
    unsegmented = frame_of_maker(whole, FrameMaker(TOPICS, FrameSettings()), TOPICS, AUTO)
    assert (unsegmented.labels == NO_BODY).all()


def test_pixels_are_not_copied_out_of_the_message() -> None:
    message = image(MILLIMETRES, '16UC1')
    data = parse_image(message).data
    message.data[5] = 77
    assert data[5] == 77


@pytest.mark.parametrize(
    ('bad', 'topic', 'remedy'),
    [
        (
            FrameMessages(image(MILLIMETRES, 'rgb8'), image(MASK, 'mono8'), camera_info()),
            0,
            '16UC1',
        ),
        (
            FrameMessages(image(MILLIMETRES, '16UC1'), image(MASK, 'bgr8'), camera_info()),
            2,
            'mono8',
        ),
        (
            FrameMessages(image(MILLIMETRES, '16UC1'), image(MASK[:6], 'mono8'), camera_info()),
            2,
            '16 x 6 pixels, but the images of /cam/depth have 16 x 12',
        ),
        (
            FrameMessages(image(MILLIMETRES, '16UC1'), image(MASK, 'mono8'), camera_info(6)),
            1,
            'pixels (no binning, no region of interest), but the images of',
        ),
        (
            FrameMessages(
                image(MILLIMETRES, '16UC1'), image(MASK, 'mono8'), camera_info(focal=0.0)
            ),
            1,
            'is all zero; the camera must be calibrated',
        ),
        (
            FrameMessages(Image(encoding='16UC1'), image(MASK, 'mono8'), camera_info()),
            0,
            'do not fill',
        ),
    ],
)
def test_message_that_cannot_be_used_is_named_with_a_remedy(
    bad: FrameMessages, topic: int, remedy: str
) -> None:
    with pytest.raises(InputError) as error:
        frame_of(bad, TOPICS, 0)
    assert str(error.value).startswith(f'{TOPICS[topic]}: ')
    assert remedy in str(error.value)


def test_camera_info_without_a_size_fits_every_image() -> None:
    whole = FrameMessages(image(MILLIMETRES, '16UC1'), image(MASK, 'mono8'), camera_info(0, 0))
    assert frame_of(whole, TOPICS, 0).depth.shape == (HEIGHT, WIDTH)
