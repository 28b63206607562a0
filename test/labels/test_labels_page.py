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

"""The examples of docs/labels.md: files that load, and commands that are understood."""

import argparse
import re
import shlex
import textwrap
from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros import open_recording
from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.main import COMMANDS, load, main
from lsc_pose_ros.datasets.image_folder import read_intrinsics
from lsc_pose_ros.labels.extrinsic import load_extrinsic
from lsc_pose_ros.labels.sources.tf_frames import load_joint_frames
from lsc_pose_ros.labels.vocabulary import load_vocabulary
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

PAGE = (Path(__file__).parents[2] / 'docs' / 'labels.md').read_text(encoding='utf-8')
EXAMPLES = [textwrap.dedent(block) for block in re.findall(r'^(?: {4}.*\n)+', PAGE, re.MULTILINE)]
LINES = [line for example in EXAMPLES for line in example.splitlines()]
COMMAND_LINES = [line for line in LINES if line.startswith('lsc_pose ')]


def example(start, tmp_path):
    """The only example that begins so, as a file."""
    (text,) = [each for each in EXAMPLES if each.startswith(start)]
    path = tmp_path / 'example.yaml'
    path.write_text(text)
    return path


def test_vocabulary(tmp_path):
    vocabulary = load_vocabulary(example('names:', tmp_path))
    assert vocabulary.joints_per_body == 100
    assert set(vocabulary.joints) == {'head', 'neck', 'l_hip'}


def test_frames_of_joints(tmp_path):
    own = load_vocabulary('lsc_pose')
    named = load_joint_frames(example('bodies:\n', tmp_path), own)
    assert {joint.frame_id for joint in named[1].values()} == {'alice/Head', 'alice/LeftForeArm'}
    by_pattern = load_joint_frames(example('bodies: [', tmp_path), own)
    assert by_pattern[2][0].frame_id == 'head_2'


def test_extrinsic(tmp_path):
    assert load_extrinsic(example('parent:', tmp_path)).parent == 'world'


def test_intrinsics(tmp_path):
    path = tmp_path / 'camera.json'
    path.write_text(re.search(r'{"fx".*?}', PAGE).group())
    assert read_intrinsics(path).cx == 319.5


def test_commands_are_found():
    sources = {word for line in COMMAND_LINES for word in re.findall(r'--from (\w+)', line)}
    assert sources == {'tf', 'markers', 'skeletons', 'keypoints', 'csv', 'bvh', 'c3d'}


@pytest.mark.parametrize('line', COMMAND_LINES)
def test_commands_are_understood(line):
    _, command, *words = shlex.split(line, comments=True)
    parser = argparse.ArgumentParser()
    load(COMMANDS[command]).add_arguments(parser)
    parser.parse_args(words)


def test_exported_bvh_comes_back_as_on_the_page(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    frames = list(synthetic_frames(SyntheticSettings(frames=8, seed=3, clip_length=8, rate=10.0)))
    with RecordingWriter(tmp_path / 'people.mcap') as writer:
        for frame in frames:
            writer.write_frame(frame)
    example('translation:', tmp_path).rename('bvh_camera.yaml')
    there, back = [line for line in COMMAND_LINES if 'body.bvh' in line]
    assert main(shlex.split(there)[1:]) == 0
    assert '8 skeletons of 1 body, 20 joints' in capsys.readouterr().out
    assert main([*shlex.split(back)[1:], '--no-check']) == 0
    errors = [
        np.linalg.norm(frame.ground_truth.positions - true.ground_truth.positions, axis=-1)
        for frame, true in zip(open_recording('back.mcap'), frames, strict=True)
    ]
    # Bones of the file are rigid, those of the synthetic spine and shoulders bend.
    assert np.nanmedian(errors) < 0.02
