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
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.training.checkpoint_file import checkpoint_path


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


def test_killed_command_is_resumed(recording_file, tmp_path, capsys):
    out = tmp_path / 'me.npz'
    words = ['train', str(recording_file), '-o', str(out), '--trees', '2', '--depth', '8']
    killed = subprocess.run([sys.executable, '-c', _KILLED, *words], env=os.environ, check=False)
    assert killed.returncode == -signal.SIGKILL
    assert not out.exists()
    assert checkpoint_path(out).exists()
    assert main([*words, '--resume', '--verbose']) == 0
    assert 'growing tree 1 ' not in capsys.readouterr().err
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
