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

"""`lsc_pose train --resume` goes on where a killed training has ended."""

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.commands import train_command
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.cli.options.training_options import DEPTH_OPTIONS, FOREST_OPTIONS, LEAF_OPTIONS
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.settings import LARGEST
from lsc_pose_ros.training.checkpoint_file import CheckpointFile, checkpoint_path

BOUNDED = [
    option
    for option in (*FOREST_OPTIONS, *LEAF_OPTIONS, *DEPTH_OPTIONS)
    if option.largest is not None and not option.choices
]


@pytest.fixture(scope='module')
def recording_file(people, tmp_path_factory):
    path = tmp_path_factory.mktemp('resume') / 'given.mcap'
    with RecordingWriter(path) as writer:
        for frame in people[:40]:
            writer.write_frame(frame)
    return path


def parts_of(path):
    with np.load(path) as stored:
        return {name: stored[name] for name in stored}


# The training ends by SIGKILL as soon as its first tree is kept.
_KILLED = """
import os, signal, sys
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.training.checkpoint_file import CheckpointFile

store = CheckpointFile.store

def store_and_die(self, key, trees):
    store(self, key, trees)
    os.kill(os.getpid(), signal.SIGKILL)

CheckpointFile.store = store_and_die
main()
"""


def words_of(recording_file, out, *others):
    few = ['--points', '100', '--query-points', '50']
    return ['train', str(recording_file), '-o', str(out), *few, '--depth', '8', *others]


def kill_after_a_tree(words):
    killed = subprocess.run([sys.executable, '-c', _KILLED, *words], env=os.environ, check=False)
    assert killed.returncode == -signal.SIGKILL


def test_killed_command_is_resumed(recording_file, tmp_path, capsys):
    out = tmp_path / 'me.npz'
    words = words_of(recording_file, out, '--trees', '2')
    kill_after_a_tree(words)
    assert not out.exists()
    kept = checkpoint_path(out).read_bytes()
    assert main(words) == 2
    refused = capsys.readouterr().err
    assert f'go on with --resume, or remove {checkpoint_path(out)}' in refused
    assert main([*words, '--joints', 'head', 'neck', '--resume']) == 2
    assert 'belongs to a training with other recordings or settings' in capsys.readouterr().err
    assert checkpoint_path(out).read_bytes() == kept
    assert main([*words, '--resume', '--verbose']) == 0
    told = capsys.readouterr().err
    assert f'lsc_pose: 1 of 2 trees are taken from {checkpoint_path(out)}\n' in told
    assert 'growing tree 1 ' not in told
    assert not checkpoint_path(out).exists()
    whole = tmp_path / 'whole.npz'
    assert main([*words[:3], str(whole), *words[4:]]) == 0
    resumed, expected = parts_of(out), parts_of(whole)
    assert resumed.keys() == expected.keys()
    for name in expected.keys() - {'header'}:
        np.testing.assert_array_equal(resumed[name], expected[name])


def test_resume_needs_a_file(recording_file, capsys):
    assert main(['train', str(recording_file), '-o', '/dev/null', '--resume']) == 2
    assert '--resume: /dev/null is no file' in capsys.readouterr().err


def test_resume_without_a_checkpoint_says_so(recording_file, tmp_path, capsys):
    out = tmp_path / 'me.npz'
    assert main(words_of(recording_file, out, '--trees', '1', '--resume', '--quiet')) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith('lsc_pose: warning: --resume: there is no checkpoint')
    assert line.endswith('me.npz.checkpoint; the training begins anew')


def test_second_training_with_one_output_is_refused(recording_file, tmp_path, capsys):
    out = tmp_path / 'me.npz'
    with CheckpointFile(checkpoint_path(out), 'another', resume=False):
        assert main(words_of(recording_file, out)) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert 'is in use by another training with the same output' in line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize('letter', ['m', 'ü'])
def test_model_with_the_longest_name(recording_file, tmp_path, letter):
    name = letter * (251 // len(letter.encode())) + '.npz'
    out = tmp_path / name.rjust(len(name) + 255 - len(name.encode()), 'x')
    words = words_of(recording_file, out, '--trees', '2')
    kill_after_a_tree(words)
    assert main([*words, '--resume']) == 0
    assert len(load_model(out).forest.roots) == 2
    assert list(tmp_path.iterdir()) == [out]  # the lock of the killed process is gone, too


def test_model_on_standard_output(recording_file, tmp_path):
    words = [sys.executable, '-m', 'lsc_pose_ros', *words_of(recording_file, '-', '--trees', '1')]
    ended = subprocess.run(words, check=True, capture_output=True)
    (tmp_path / 'me.npz').write_bytes(ended.stdout)
    assert len(load_model(tmp_path / 'me.npz').forest.roots) == 1
    assert b'1 trees' in ended.stderr


def test_model_to_a_device(recording_file):
    assert main(words_of(recording_file, '/dev/null', '--trees', '1')) == 0


def test_model_that_cannot_be_written_leaves_the_trees(
    recording_file, tmp_path, capsys, monkeypatch
):
    def fail(_path, _model):
        msg = 'me.npz: cannot be written: No space left on device'
        raise InputError(msg)

    out = tmp_path / 'me.npz'
    words = words_of(recording_file, out, '--trees', '1')
    with monkeypatch.context() as patched:
        patched.setattr(train_command, 'save_model', fail)
        assert main(words) == 2
    assert f'the finished trees are in {checkpoint_path(out)}' in capsys.readouterr().err
    assert main([*words, '--resume']) == 0
    assert '1 of 1 trees are taken' in capsys.readouterr().err
    assert load_model(out)


@pytest.mark.parametrize(
    ('option', 'largest'),
    [(f'--{option.name}', option.largest) for option in BOUNDED]
    + [('--seed', LARGEST['offset_seed'])],
)
def test_setting_that_no_model_file_may_have(option, largest, tmp_path, capsys):
    """The recording is not there: it would be read after the options."""
    out = tmp_path / 'me.npz'
    above = str(largest + 1)
    words = ['train', 'nothing.mcap', '-o', str(out), option, above]
    if option == '--seed':
        assert main(words) == 2
    else:
        with pytest.raises(SystemExit, match='2'):
            main(words)
    error = capsys.readouterr().err
    assert option in error
    assert 'nothing.mcap' not in error


def test_bounds_of_a_model_file_are_known_to_the_options():
    assert {option.name for option in BOUNDED} >= {'trees', 'depth', 'points', 'noise-factor'}
