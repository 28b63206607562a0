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

"""The command that writes synthetic people."""

import argparse
from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros.bags import open_recording
from lsc_pose_ros.cli.commands import synth_command
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames


def run_command(*words: object) -> int:
    parser = argparse.ArgumentParser()
    synth_command.add_arguments(parser)
    return synth_command.run(parser.parse_args([str(word) for word in words]))


def test_command_writes_what_is_generated(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / 'people.mcap'
    words = ('--frames', 4, '--people', 2, '--size', '160x120', '--clip-length', 2, '--seed', 5)
    assert run_command(output, *words) == 0
    assert '4 frames, 4 people' in capsys.readouterr().out
    settings = SyntheticSettings(frames=4, people=2, width=160, height=120, clip_length=2, seed=5)
    read = list(open_recording(output))
    for frame, original in zip(read, synthetic_frames(settings), strict=True):
        assert frame.ground_truth is not None
        assert original.ground_truth is not None
        assert frame.stamp == original.stamp
        assert frame.camera == pytest.approx(original.camera)
        np.testing.assert_array_equal(frame.labels, original.labels)
        np.testing.assert_allclose(frame.depth, original.depth, atol=1e-6)
        np.testing.assert_array_equal(
            frame.ground_truth.positions, original.ground_truth.positions
        )
        np.testing.assert_array_equal(frame.ground_truth.bodies, original.ground_truth.bodies)


def test_command_passes_every_argument_on(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    asked: list[SyntheticSettings] = []

    def remember(settings: SyntheticSettings) -> list[Frame]:
        asked.append(settings)
        return []

    monkeypatch.setattr(synth_command, 'synthetic_frames', remember)
    run_command(tmp_path / 'a.mcap')
    run_command(
        *(tmp_path / 'b.mcap', '--frames', 7, '--seed', 8, '--people', 2, '--size', '100x90'),
        *('--fov', 70, '--noise', 'none', '--yaw', 30, '--distance', 2, 3, '--stature', 1.2, 1.4),
        *('--clip-length', 9, '--fps', 15, '--cropped', '--background', '--sensor', 'azure'),
        *('--height', 1, 1.5, '--tilt', -5, 5, '--age', 8, 12, '--mocap', tmp_path),
        *(
            '--mocap-mapping',
            tmp_path / 'm.yaml',
            '--mocap-fraction',
            0.25,
            '--mocap-only',
            'a',
            'b',
        ),
        *('--mocap-without', 'c_*'),
    )
    assert asked[0] == SyntheticSettings()
    assert asked[1] == SyntheticSettings(
        frames=7,
        seed=8,
        people=2,
        sensor='azure',
        width=100,
        height=90,
        field_of_view=70.0,
        noise='none',
        yaw=30.0,
        distance=(2.0, 3.0),
        camera_height=(1.0, 1.5),
        camera_tilt=(-5.0, 5.0),
        age=(8.0, 12.0),
        stature=(1.2, 1.4),
        clip_length=9,
        rate=15.0,
        cropped=True,
        background=True,
        mocap=tmp_path,
        mocap_mapping=tmp_path / 'm.yaml',
        mocap_fraction=0.25,
        mocap_only=('a', 'b'),
        mocap_without=('c_*',),
    )


def test_command_leaves_no_file_when_it_fails(tmp_path: Path) -> None:
    output = tmp_path / 'people.mcap'
    with pytest.raises(InputError, match='no placement found'):
        run_command(output, '--distance', 0.5, 0.6)
    with pytest.raises(InputError, match='frames is 0'):
        run_command(output, '--frames', 0)
    with pytest.raises(InputError, match='no BVH file'):
        run_command(output, '--mocap', tmp_path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('size', ['320', '320x', 'x240', '3.5x2', '-3x4', '320x240x3'])
def test_command_refuses_a_size_that_is_none(
    tmp_path: Path, size: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        run_command(tmp_path / 'a.mcap', f'--size={size}')
    assert 'is no size; write it as 320x240' in capsys.readouterr().err


def test_help_names_sensors_and_defaults(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        run_command('--help')
    said = ' '.join(capsys.readouterr().out.split())
    for words in ('kinect_v2', 'realsense', '(1.5 4)', '180: all sides (60)', 'DIR'):
        assert words in said
