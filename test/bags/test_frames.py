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

"""Recordings as frames: unusual but valid ones, wrong ones, and the memory that reading takes."""

import gc
import tracemalloc

import numpy as np
import pytest
from ros_messages import (
    CAMERA_INFO,
    COMPRESSED_IMAGE,
    IMAGE,
    camera_info,
    compressed_image,
    image,
)

from lsc_pose_ros.bags import RecordingWriter, Topics, open_recording
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.codecs.compressed_depth import encode_compressed_depth
from lsc_pose_ros.messages.codecs.png import write_png
from lsc_pose_ros.segmentation.segmenter import make_segmenter
from lsc_pose_ros.settings.table import FrameSettings, SegmentationSettings

SHAPE = (48, 64)
DEPTH = np.random.default_rng(0).integers(500, 5000, SHAPE, dtype=np.uint16)
MASK = np.zeros(SHAPE, np.uint8)
MASK[10:30, 20:40] = 1
MASK[10:30, 45:60] = 7
LABELS = np.where(MASK == 0, NO_BODY, MASK.astype(np.int32))


def write(path, messages):
    """Write (topic, type, stamp, data), by default one frame of DEPTH and MASK."""
    with RecordingWriter(path) as writer:
        for message in messages:
            writer.write(*message)
    return path


def depth_image(stamp=1, **changes):
    return '/depth/image', IMAGE, stamp, image(stamp, DEPTH, **{'encoding': '16UC1', **changes})


def mask_image(stamp=1, **changes):
    return '/mask', IMAGE, stamp, image(stamp, MASK, **{'encoding': 'mono8', **changes})


def info(stamp=1, **changes):
    return '/depth/camera_info', CAMERA_INFO, stamp, camera_info(stamp, **changes)


def the_frame(path, **options):
    (frame,) = open_recording(path, **options)
    np.testing.assert_allclose(frame.depth, DEPTH * 1e-3, rtol=1e-6)
    np.testing.assert_array_equal(frame.labels, LABELS)
    return frame


def test_plain_frame(tmp_path):
    frame = the_frame(write(tmp_path / 'a.mcap', [depth_image(), mask_image(), info()]))
    assert (frame.stamp, frame.frame_id, frame.camera[:4]) == (1, 'camera', (60, 61, 31.5, 23.5))
    assert frame.ground_truth is None


def test_rows_with_padding_and_big_endian_pixels(tmp_path):
    padded = np.full((48, 140), 255, np.uint8)
    padded[:, :128] = DEPTH.astype('>u2').view(np.uint8)
    depth = '/depth/image', IMAGE, 1, image(
        1, padded, '16UC1', width=64, step=140, is_bigendian=1
    )  # fmt: skip
    wide = np.full((48, 70), 9, np.uint8)
    wide[:, :64] = MASK
    mask = '/mask', IMAGE, 1, image(1, wide, 'mono8', width=64, step=70)
    the_frame(write(tmp_path / 'a.mcap', [depth, mask, info()]))


def test_metres(tmp_path):
    metres = (DEPTH * 1e-3).astype(np.float32)
    depth = '/depth/image', IMAGE, 1, image(1, metres, '32FC1')
    the_frame(write(tmp_path / 'a.mcap', [depth, mask_image(), info()]))


@pytest.mark.parametrize('codec', ['png', 'rvl'])
def test_compressed_images(tmp_path, codec):
    depth = compressed_image(1, *encode_compressed_depth(DEPTH, codec))
    mask = compressed_image(1, 'mono8; png compressed ', write_png(MASK))
    path = write(
        tmp_path / 'a.mcap',
        [
            ('/cam/depth/image/compressedDepth', COMPRESSED_IMAGE, 1, depth),
            ('/cam/mask/compressed', COMPRESSED_IMAGE, 1, mask),
            ('/cam/depth/camera_info', CAMERA_INFO, 1, camera_info(1)),
        ],
    )
    the_frame(path)


def test_depth_by_the_transport_compressed(tmp_path):
    depth = compressed_image(1, '16UC1; png compressed ', write_png(DEPTH))
    depth_topic = '/depth/image/compressed', COMPRESSED_IMAGE, 1, depth
    the_frame(write(tmp_path / 'a.mcap', [depth_topic, mask_image(), info()]))


def test_mask_with_the_background_255(tmp_path):
    mask = np.where(MASK == 0, 255, MASK).astype(np.uint8)
    path = write(
        tmp_path / 'a.mcap',
        [depth_image(), ('/mask', IMAGE, 1, image(1, mask, 'mono8')), info()],
    )
    the_frame(path, settings=FrameSettings(mask_background=255))


def test_without_masks_where_none_are_needed(tmp_path):
    path = write(tmp_path / 'a.mcap', [depth_image(), info()])
    masks = FrameSettings(segmentation='mask')
    (frame,) = open_recording(path, settings=masks, need_mask=False)
    assert (frame.labels == NO_BODY).all()
    with pytest.raises(InputError, match='no mask topic was recorded'):
        open_recording(path, settings=masks)


def test_auto_uses_masks_if_there_are_any(tmp_path):
    with_masks = open_recording(write(tmp_path / 'a.mcap', [depth_image(), mask_image(), info()]))
    (frame,) = with_masks
    np.testing.assert_array_equal(frame.labels, LABELS)
    assert with_masks.bodies == 'bodies are the masks of /mask'
    without = open_recording(write(tmp_path / 'b.mcap', [depth_image(), info()]))
    (frame,) = without
    segmenter = make_segmenter(SegmentationSettings('people'))
    expected = segmenter.labels(frame.depth, frame.camera)
    np.testing.assert_array_equal(frame.labels, expected)
    assert 'found by segmentation people, because there is no mask' in without.bodies


def test_topics_by_their_encoding(tmp_path):
    colour = image(1, np.zeros((48, 192), np.uint8), 'bgr8', width=64)
    path = write(
        tmp_path / 'a.mcap',
        [
            ('/a/depth/colour_map', IMAGE, 1, colour),
            ('/a/depth/image', IMAGE, 1, image(1, DEPTH, '16UC1')),
            ('/a/depth/camera_info', CAMERA_INFO, 1, camera_info(1)),
            mask_image(),
        ],
    )
    the_frame(path)


def test_camera_info_may_come_once_and_late(tmp_path):
    messages = [message(stamp) for stamp in range(5) for message in (depth_image, mask_image)]
    path = write(tmp_path / 'a.mcap', [*messages, info(3)])
    assert [frame.stamp for frame in open_recording(path)] == list(range(5))


def test_what_has_no_partner_is_counted(tmp_path):
    messages = [
        depth_image(1),
        mask_image(1),
        depth_image(2),
        mask_image(3),
        mask_image(1),
        info(),
    ]
    reader = open_recording(write(tmp_path / 'a.mcap', messages))
    assert [frame.stamp for frame in reader] == [1]
    assert reader.warnings == [
        '1 of /depth/image were left out: they have no mask in /mask',
        '1 of /mask were left out: they have no image in /depth/image',
        '1 of the images were left out: they repeat the stamp of another',
    ]


def test_damaged_message_is_left_out(tmp_path):
    broken = '/depth/image', IMAGE, 2, depth_image(2)[3][:50]
    messages = [depth_image(1), mask_image(1), broken, mask_image(2), info()]
    reader = open_recording(write(tmp_path / 'a.mcap', messages))
    assert len(list(reader)) == 1
    assert '1 damaged messages of /depth/image were left out' in reader.warnings


@pytest.mark.parametrize(
    ('messages', 'words'),
    [
        ([mask_image(), info()], 'no depth topic'),
        ([depth_image(), mask_image()], 'no camera info'),
        ([depth_image(), mask_image(), info(k=[0] * 9)], 'K of the camera info is all zero'),
        (
            [depth_image(), mask_image(height=24, step=64), info()],
            'topic /mask: it is for 64 x 24 pixels, but the images of /depth/image have 64 x 48',
        ),
        (
            [depth_image(), mask_image(), info(shape=(480, 640))],
            'topic /depth/camera_info: it is for 640 x',
        ),
        ([depth_image(encoding='bgr8'), mask_image(), info()], "unknown encoding 'bgr8'"),
        ([depth_image(), mask_image(encoding='rgb8'), info()], "unknown encoding 'rgb8'"),
        ([depth_image(height=4000), mask_image(), info()], 'do not fill 64 x 4000'),
        ([depth_image(1), mask_image(2), info()], 'no mask of /mask has the stamp of a depth'),
        (
            [('/depth/image', IMAGE, 1, b'\0\1\0\0'), mask_image(), info()],
            'there is no usable message of /depth/image',
        ),
    ],
)
def test_recordings_that_cannot_be_used(tmp_path, messages, words):
    path = write(tmp_path / 'bad.mcap', messages)
    with pytest.raises(InputError) as caught:
        list(open_recording(path))
    assert words in str(caught.value)
    assert 'bad.mcap' in str(caught.value)
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize(
    ('topic', 'text', 'words'),
    [
        ('/depth/image', 'jpeg', 'unknown depth format'),
        ('/depth/image', '16UC1; compressedDepth webp', "unknown codec 'webp'"),
        ('/mask', 'rgb8; jpeg compressed bgr8', 'only PNG keeps the numbers'),
        ('/mask', 'png', 'no readable PNG'),
    ],
)
def test_compressions_that_cannot_be_used(tmp_path, topic, text, words):
    messages = [m for m in (depth_image(), mask_image(), info()) if m[0] != topic]
    messages.append((topic, COMPRESSED_IMAGE, 1, compressed_image(1, text, bytes(99))))
    path = write(tmp_path / 'bad.mcap', messages)
    with pytest.raises(InputError, match=words) as caught:
        list(open_recording(path))
    assert f'topic {topic}' in str(caught.value)


def test_ground_truth_topic_that_is_none(tmp_path):
    path = write(tmp_path / 'a.mcap', [depth_image(), mask_image(), info()])
    with pytest.raises(InputError, match='no topic /truth'):
        open_recording(path, Topics(ground_truth='/truth'))


def peak_memory(path):
    """The most bytes that reading all frames of `path` takes at any time."""
    gc.collect()
    tracemalloc.start()
    try:
        for _ in open_recording(path):
            pass
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize('name', ['one.mcap', 'bag'])
def test_memory_does_not_grow_with_the_length(tmp_path, simple_frames, name):
    peaks = []
    for count in (150, 1500):
        folder = tmp_path / str(count)
        folder.mkdir()
        with RecordingWriter(folder / name) as writer:
            for number in range(count):
                frame = simple_frames[number % 10]._replace(stamp=number * 1_000_000)
                writer.write_frame(frame)
        peaks.append(peak_memory(folder / name))
    # 1500 frames are 14 MB of images; the index of ten times as many chunks is all that may grow.
    assert peaks[1] < peaks[0] + 1_000_000
    assert peaks[1] < 10_000_000


def test_writing_takes_no_memory_for_what_is_written(tmp_path, simple_frames):
    with RecordingWriter(tmp_path / 'one.mcap') as writer:
        for number in range(300):
            writer.write_frame(simple_frames[number % 10])
        tracemalloc.start()
        before = tracemalloc.get_traced_memory()[0]
        for number in range(600):
            writer.write_frame(simple_frames[number % 10])
        grown = tracemalloc.get_traced_memory()[0] - before
        tracemalloc.stop()
    assert grown < 2_500_000  # at most a chunk of 1 MB that was not yet written, and its index
