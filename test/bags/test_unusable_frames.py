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

"""Single frames that cannot be used, and camera infos that come late."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ros_messages import camera_info, compressed_image, image

from lsc_pose_ros.bags import RecordingWriter, open_recording, read_messages
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.codecs.compressed_depth import encode_compressed_depth
from lsc_pose_ros.messages.type_names import CAMERA_INFO, COMPRESSED_IMAGE, IMAGE
from lsc_pose_ros.settings.table import FrameSettings

DEPTH = np.full((48, 64), 2000, np.uint16)
MASK = np.pad(np.ones((20, 20), np.uint8), ((10, 18), (20, 24)))
COUNT = 40

Message = tuple[str, str, int, bytes]


def frame(number: int, **changes: Any) -> list[Message]:
    """Return depth image, mask and camera info of a frame; `changes` name a part and its data."""
    stamp = number * 33_000_000
    parts = {
        'depth': image(stamp, DEPTH, '16UC1'),
        'mask': image(stamp, MASK, 'mono8'),
        'info': camera_info(stamp),
    } | changes
    return [
        ('/depth/image', IMAGE, stamp, parts['depth']),
        ('/mask', IMAGE, stamp, parts['mask']),
        ('/depth/camera_info', CAMERA_INFO, stamp, parts['info']),
    ]


def record(path: Path, messages: Iterable[Message]) -> Path:
    with RecordingWriter(path) as writer:
        for message in messages:
            writer.write(*message)
    return path


def empty(encoding: str) -> bytes:
    nothing = np.zeros(0, np.uint8)
    return image(0, np.zeros((1, 1), np.uint8), encoding, height=0, width=0, step=0, data=nothing)


BAD_PARTS = [
    ({'depth': empty('16UC1')}, '/depth/image: '),
    ({'depth': empty('')}, '/depth/image: '),
    ({'mask': empty('mono8')}, '/mask: '),
    ({'depth': image(0, DEPTH[:24], '16UC1')}, '64 x 24'),
    ({'mask': image(0, MASK[:, :32], 'mono8')}, '/mask: it is for 32 x 48'),
    ({'info': camera_info(0, shape=(96, 128))}, '/depth/camera_info: it is for 128 x 96'),
    ({'info': camera_info(0, k=[0] * 9)}, 'K of the camera info is all zero'),
    ({'depth': image(0, DEPTH, 'bgr8')}, "unknown encoding 'bgr8'"),
]


def with_stamp(data: bytes, number: int) -> bytes:
    """Return a serialized message with the stamp of a frame."""
    stamp = number * 33_000_000
    seconds = (stamp // 10**9).to_bytes(4, 'little', signed=True)
    return data[:4] + seconds + (stamp % 10**9).to_bytes(4, 'little') + data[12:]


@pytest.mark.parametrize(('bad', 'reason'), BAD_PARTS)
@pytest.mark.parametrize('position', [0, 17])
def test_one_unusable_frame_is_left_out_and_told(
    tmp_path: Path, bad: dict[str, bytes], reason: str, position: int
) -> None:
    changes = {name: with_stamp(data, position) for name, data in bad.items()}
    frames = [frame(number, **(changes if number == position else {})) for number in range(COUNT)]
    path = record(tmp_path / 'a.mcap', (each for messages in frames for each in messages))
    reader = open_recording(path)
    stamps = [each.stamp // 33_000_000 for each in reader]
    lost = {position} if 'K of' not in reason else set()  # the frame takes another info
    assert set(range(COUNT)) - set(stamps) == lost
    (warning,) = reader.warnings
    assert warning.startswith('1 of the frames was left out: ')
    assert reason in warning


@pytest.mark.parametrize('bad_frames', [COUNT, COUNT // 2 + 1])
def test_mostly_unusable_frames_are_an_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], bad_frames: int
) -> None:
    bad = image(0, DEPTH, 'bgr8')
    frames = (
        frame(number, **({'depth': with_stamp(bad, number)} if number < bad_frames else {}))
        for number in range(COUNT)
    )
    path = record(tmp_path / 'a.mcap', (each for messages in frames for each in messages))
    expected = f'{bad_frames} of {COUNT} frames cannot be used: topic /depth/image: depth image'
    with pytest.raises(InputError, match=expected):
        list(open_recording(path))
    output = tmp_path / 'out.mcap'
    assert main(['replay', str(path), '-o', str(output)]) == 2
    assert expected in capsys.readouterr().err
    assert not output.exists()


@pytest.mark.parametrize('count', [COUNT, 200])
@pytest.mark.parametrize('log_time', [0, 10**12])
def test_only_camera_info_may_stand_anywhere(tmp_path: Path, count: int, log_time: int) -> None:
    messages = [each for number in range(count) for each in frame(number)[:2]]
    info = '/depth/camera_info', CAMERA_INFO, log_time, camera_info(log_time)
    reader = open_recording(record(tmp_path / 'a.mcap', [*messages, info]))
    assert len(list(reader)) == count
    assert reader.warnings == []


def test_stamps_that_are_all_zero_are_told_once(tmp_path: Path) -> None:
    messages = []
    for number in range(COUNT):
        for topic, kind, log_time, data in frame(number):
            messages.append((topic, kind, log_time, with_stamp(data, 0)))
    reader = open_recording(record(tmp_path / 'a.mcap', messages))
    assert len(list(reader)) == 1
    assert reader.warnings == [
        f'{2 * (COUNT - 1)} of the images were left out: they repeat the stamp of another'
    ]


@pytest.mark.parametrize('kind', [np.int8, np.int16, np.int32])
def test_masks_with_minus_one_where_nobody_is(tmp_path: Path, kind: type) -> None:
    mask = np.where(MASK == 1, 0, -1).astype(kind)
    encoding = f'{8 * mask.itemsize}SC1'
    messages = [
        each for k in range(3) for each in frame(k, mask=image(33_000_000 * k, mask, encoding))
    ]
    settings = FrameSettings(mask_background=-1)
    for read in open_recording(record(tmp_path / 'a.mcap', messages), settings=settings):
        np.testing.assert_array_equal(read.labels, mask)


def test_log_times_before_1970_are_kept_in_order(tmp_path: Path) -> None:
    path = tmp_path / 'a.mcap'
    messages = [each for number in range(5) for each in frame(number)]
    shift = 10**9
    record(path, [(name, kind, time - shift, data) for name, kind, time, data in messages])
    assert [each.log_time for each in read_messages(path)] == [time for _, _, time, _ in messages]
    assert len(list(open_recording(path))) == 5


def test_depth_of_compressed_mono16(tmp_path: Path) -> None:

    _, data = encode_compressed_depth(DEPTH)
    packed = compressed_image(0, 'mono16; compressedDepth png', data)
    messages = frame(0)
    messages[0] = '/depth/image/compressedDepth', COMPRESSED_IMAGE, 0, packed
    (read,) = open_recording(record(tmp_path / 'a.mcap', messages))
    assert (read.depth == 2).all()
