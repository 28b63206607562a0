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

"""The option --camera of the commands that read recordings."""

from pathlib import Path

import pytest

from lsc_pose_ros.bags import RecordingWriter, Topics, read_messages
from lsc_pose_ros.bags.serialization.serialize import (
    camera_info_message,
    depth_message,
    mask_message,
)
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.cli.options.camera_preset import camera_names, preset_defaults
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.messages.type_names import CAMERA_INFO, IMAGE
from lsc_pose_ros.settings.table import SETTINGS

AZURE = Topics('/depth/image_raw', '/depth/camera_info', '/body_index_map/image_raw')

# The stamps of an Azure Kinect's body index map differ a little from those of the depth images.
LAG = 3_000_000


@pytest.fixture
def azure_recording(tmp_path: Path, people: list[Frame]) -> Path:
    """A recording as the driver of the Azure Kinect gives it, and another mask beside it."""
    path = tmp_path / 'azure.mcap'
    with RecordingWriter(path) as writer:
        for frame in people[:10]:
            stamp, name = frame.stamp, frame.frame_id
            info = camera_info_message(stamp, name, frame.camera, frame.depth.shape)
            mask = mask_message(stamp + LAG, name, frame.labels, 255)
            depth = depth_message(stamp, name, frame.depth)
            writer.write(AZURE.depth, IMAGE, stamp, depth)
            writer.write(AZURE.camera_info, CAMERA_INFO, stamp, info)
            writer.write(AZURE.mask, IMAGE, stamp + LAG, mask)
            other = mask_message(stamp, name, frame.labels, 255)
            writer.write('/other/mask', IMAGE, stamp, other)
    return path


def test_presets_name_options_only() -> None:
    options = {'depth_topic', 'camera_info_topic', 'mask_topic', *SETTINGS}
    for name in camera_names():
        assert set(preset_defaults(name)) <= options
    assert camera_names() == ['azure', 'kinect', 'orbbec', 'realsense', 'zed']


def test_recording_of_a_camera_is_read_with_its_preset(
    azure_recording: Path,
    small_model_file: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    output = tmp_path / 'out.mcap'
    words = ['replay', str(azure_recording), '-o', str(output), '--model', str(small_model_file)]
    assert main(words) == 2
    assert 'several topics could be the mask' in capsys.readouterr().err
    assert main([*words, '--camera', 'azure']) == 0
    assert '10 frames, 10 bodies' in capsys.readouterr().out


@pytest.mark.parametrize('order', [1, -1])
def test_options_have_precedence(
    azure_recording: Path,
    small_model_file: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    order: int,
) -> None:
    output = tmp_path / 'out.mcap'
    words = ['replay', str(azure_recording), '-o', str(output), '--model', str(small_model_file)]
    options = [['--camera=azure'], ['--sync-slop', '0'], ['--mask-background', '255']][::order]
    assert main([*words, *(word for option in options for word in option)]) == 2
    assert 'no mask of /body_index_map/image_raw has the stamp' in capsys.readouterr().err


@pytest.mark.parametrize(
    'command',
    [
        ['info', 'RECORDING'],
        ['view', 'RECORDING', '-o', 'OUT.png', '--frames', '2'],
        ['view', 'RECORDING', '-o', 'OUT.png', '--stages', '1', '--model', 'MODEL'],
        ['bench', 'RECORDING', '--frames', '2', '--model', 'MODEL'],
    ],
)
def test_commands_that_read_recordings_take_it(
    azure_recording: Path, small_model_file: Path, tmp_path: Path, command: list[str]
) -> None:
    given = {
        'RECORDING': str(azure_recording),
        'OUT.png': str(tmp_path / 'out.png'),
        'MODEL': str(small_model_file),
    }
    assert main([given.get(word, word) for word in command] + ['--camera', 'azure']) == 0


def test_mask_that_is_named_is_used(
    azure_recording: Path, small_model_file: Path, tmp_path: Path
) -> None:
    """The preset of a camera without masks finds the nearest person."""
    words = [
        *('replay', str(azure_recording), '-o', str(tmp_path / 'out.mcap')),
        *('--model', str(small_model_file), '--camera', 'zed', '--mask-background', '255'),
        *('--depth-topic', AZURE.depth, '--camera-info-topic', AZURE.camera_info),
    ]
    assert main([*words, '--mask-topic', '/other/mask']) == 0
    assert '/other/mask' in read_messages(tmp_path / 'out.mcap').topics


def test_masks_are_not_missed_if_they_are_not_used(
    tmp_path: Path,
    people: list[Frame],
    small_model_file: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / 'azure.mcap'
    with RecordingWriter(path) as writer:
        for frame in people[:3]:
            writer.write_frame(frame, AZURE._replace(mask=''))
    words = ['replay', str(path), '-o', str(tmp_path / 'out.mcap'), '--camera', 'azure']
    words += ['--model', str(small_model_file)]
    assert main(words) == 2
    told = capsys.readouterr().err
    assert 'no topic /body_index_map/image_raw was recorded; find the people without' in told
    assert main([*words, '--segmentation', 'nearest']) == 0


def test_unknown_cameras_are_refused_with_the_list(
    azure_recording: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(['info', str(azure_recording), '--camera', 'webcam']) == 2
    assert '--camera webcam: there is no such camera; there are azure, ' in capsys.readouterr().err
