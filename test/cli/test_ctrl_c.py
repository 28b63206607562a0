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

"""Ctrl-C at random moments: status 130, one line, nothing half-written.

`make interrupts` sends hundreds to all commands.
"""

import random
import signal
import subprocess
import sys

import pytest
from ctrl_c import LINE, commands, interrupt, start
from waiting import wait_until

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.resources.package_files import default_model


@pytest.fixture(scope='module')
def recording(people, tmp_path_factory):
    path = tmp_path_factory.mktemp('interrupts') / 'given.mcap'
    with RecordingWriter(path) as writer:
        for frame in people[:20]:
            writer.write_frame(frame)
    return path


@pytest.mark.parametrize('name', ['synth', 'synth to a folder', 'train', 'evaluate', 'replay'])
def test_command(name, recording):
    moments = random.Random(name)  # noqa: S311 - no secret
    # The first seconds are those of the imports.
    assert interrupt(commands(recording)[name], moments.uniform(0, 6)) == ''


_IMPORT = """
import signal, sys
from importlib.abc import MetaPathFinder

class Interrupting(MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == interrupted:
            signal.raise_signal(signal.SIGINT)

interrupted = sys.argv.pop(1)
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.meta_path.insert(0, Interrupting())
from lsc_pose_ros.cli.program import main
sys.exit(main())
"""


@pytest.mark.parametrize('module', ['lsc_pose_ros.cli.main', 'numba'])
def test_during_an_import(module, tmp_path):
    words = [module, 'info', str(tmp_path / 'none.mcap')]
    ended = subprocess.run(
        [sys.executable, '-c', _IMPORT, *words], capture_output=True, check=False
    )
    assert (ended.returncode, ended.stderr) == (130, LINE)


@pytest.mark.parametrize('output', ['out.mcap', 'out'])
def test_while_an_output_is_written(output, tmp_path):
    process = start(['synth', output, '--frames', '1000000'], tmp_path)
    assert wait_until(lambda: [*tmp_path.iterdir()] or process.poll() is not None)
    process.send_signal(signal.SIGINT)
    _, printed = process.communicate()
    assert (process.returncode, printed) == (130, LINE)
    assert not [*tmp_path.iterdir()]


_LOOP = """
import os, random, signal, sys, threading, time
import numpy as np
from lsc_pose_ros import Estimator, load_model, open_recording

signal.signal(signal.SIGINT, signal.default_int_handler)
estimator = Estimator(load_model(sys.argv[1]))
frames = list(open_recording(sys.argv[2]))[:5]

def positions(frame):
    return estimator.estimate(frame.depth, frame.labels, frame.camera).positions

expected = [positions(frame) for frame in frames]
sent = threading.Event()

def send():
    moments = random.Random(1)
    for _ in range(int(sys.argv[3])):
        time.sleep(moments.random() * 0.02)
        os.kill(os.getpid(), signal.SIGINT)
    sent.set()

sender = threading.Thread(target=send, daemon=True)
interrupts = answers = 0
sender.start()

def loop():
    global interrupts, answers
    while not sent.is_set():
        try:
            while not sent.is_set():
                for frame, answer in zip(frames, expected):
                    np.testing.assert_array_equal(positions(frame), answer)
                    answers += 1
        except KeyboardInterrupt:
            interrupts += 1

while not sent.is_set():
    try:
        loop()
    except KeyboardInterrupt:  # between the attempts
        interrupts += 1
print(interrupts, answers)
"""


def test_hundreds_of_signals_in_a_loop_over_estimate(recording):
    done = subprocess.run(
        [sys.executable, '-c', _LOOP, str(default_model()), str(recording), '300'],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    interrupts, answers = map(int, done.stdout.split())
    # On a busy computer, several signals arrive as one.
    assert interrupts > 0
    assert answers > 0
    assert done.stderr == ''
