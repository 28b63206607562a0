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

"""No command replaces what it reads, or a file of another kind, and `-` is standard output."""

import json
import os
import shutil
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from lsc_pose_ros.bags import read_messages
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.resources.package_files import default_model


@pytest.fixture
def recording(labelled_recording, tmp_path, monkeypatch):
    """A recording in the current folder, beside a model and another recording."""
    shutil.copy(default_model(), tmp_path / 'm.npz')
    shutil.copy(labelled_recording, tmp_path / 'o.mcap')
    monkeypatch.chdir(tmp_path)
    return Path(shutil.copy(labelled_recording, tmp_path / 'k.mcap'))


Words = Callable[[Path], list[str]]
"""The words of a command that writes to a path and reads `k.mcap`, and perhaps `m.npz`."""

COMMANDS: dict[str, Words] = {
    'train': lambda path: ['train', 'k.mcap', '-o', str(path)],
    'train --calibrate': lambda path: [
        'train',
        'o.mcap',
        '--calibrate',
        'k.mcap',
        '-o',
        f'{path}',
    ],
    'train --json': lambda path: ['train', 'k.mcap', '-o', 'new.npz', '--json', str(path)],
    'evaluate': lambda path: ['evaluate', 'm.npz', 'k.mcap', '--json', str(path)],
    'evaluate --offsets-from': lambda path: [
        *('evaluate', 'm.npz', 'o.mcap', '--offsets-from', 'k.mcap', '--json', str(path)),
    ],
    'replay': lambda path: ['replay', 'k.mcap', '-o', str(path), '--model', 'm.npz'],
    'view': lambda path: ['view', 'k.mcap', '-o', str(path)],
    'info': lambda path: ['info', 'k.mcap', '--json', str(path)],
    'bench': lambda path: ['bench', 'k.mcap', '--model', 'm.npz', '--json', str(path)],
}


def refuse(capsys: pytest.CaptureFixture[str], words: list[str]) -> str:
    assert main(words) == 2
    printed = capsys.readouterr()
    assert printed.out == ''
    (line,) = printed.err.splitlines()
    return line


@pytest.mark.parametrize('name', COMMANDS)
def test_output_that_is_the_recording(name, recording, tmp_path, capsys):
    # A picture must have this suffix.
    (tmp_path / 'link.png').symlink_to(recording)
    os.link(recording, 'hard.png')
    before = recording.read_bytes()
    for output in ('link.png', 'hard.png'):
        assert 'is the input k.mcap' in refuse(capsys, COMMANDS[name](Path(output)))
    assert recording.read_bytes() == before
    assert (tmp_path / 'link.png').is_symlink()
    assert not (tmp_path / 'new.npz').exists()


@pytest.mark.parametrize('name', ['evaluate', 'replay', 'bench'])
def test_output_that_is_the_model(name, recording, capsys):
    model = recording.with_name('m.npz')
    before = model.read_bytes()
    assert 'is the input m.npz' in refuse(capsys, COMMANDS[name](Path('m.npz')))
    assert model.read_bytes() == before


@pytest.mark.parametrize('name', COMMANDS)
def test_file_of_another_kind(name, recording, capsys):
    other = recording.parent / ('notes.mcap' if name == 'replay' else 'notes.png')
    other.write_text('precious')
    assert 'exists and is not a' in refuse(capsys, COMMANDS[name](Path(other.name)))
    assert other.read_text() == 'precious'


def test_generated_recording_does_not_replace_the_motion_capture(tmp_path, capsys):
    clip = tmp_path / 'clips' / 'walk.bvh'
    clip.parent.mkdir()
    clip.write_text('HIERARCHY')
    (tmp_path / 'out.mcap').symlink_to(clip)
    words = ['synth', str(tmp_path / 'out.mcap'), '--mocap', str(clip.parent)]
    refuse(capsys, words)
    assert clip.read_text() == 'HIERARCHY'


def test_imported_recording_does_not_replace_the_data_set(recording, tmp_path, capsys):
    (tmp_path / 'Depth').mkdir()
    os.link(recording, tmp_path / 'Depth' / 'a.mcap')
    words = ['import', 'utd-mhad', str(tmp_path), str(recording)]
    assert 'is a file of the input' in refuse(capsys, words)


def test_report_does_not_replace_another_page(recording, capsys):
    page = recording.parent / 'report' / 'index.html'
    page.parent.mkdir()
    page.write_text('precious')
    line = refuse(capsys, ['evaluate', 'm.npz', 'k.mcap', '--report', 'report'])
    assert 'exists and is not a web page' in line


def test_json_to_a_device(recording):
    assert main(['info', str(recording), '--json', '/dev/null']) == 0
    assert stat.S_ISCHR(Path('/dev/null').stat().st_mode)


def run(*words: str) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [sys.executable, '-m', 'lsc_pose_ros', *words], check=True, capture_output=True
    )


def test_json_on_standard_output_is_nothing_else(recording):
    ended = run('info', str(recording), '--json', '-')
    assert json.loads(ended.stdout)
    assert b'/ground_truth/skeletons' in ended.stderr


def test_recording_on_standard_output(tmp_path):
    ended = run('synth', '-', '--frames', '1')
    (tmp_path / 'k.mcap').write_bytes(ended.stdout)
    assert len(list(read_messages(tmp_path / 'k.mcap'))) == 4
    assert b'1 frames, 1 people' in ended.stderr
