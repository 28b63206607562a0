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

"""benchmarks/live.py, for three seconds with a small model."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from waiting import PATIENCE

pytest.importorskip('rclpy')
pytest.importorskip('diagnostic_msgs')

PROGRAM = Path(__file__).parents[2] / 'benchmarks' / 'live.py'


def live(ros_environment, *words):
    """Run the benchmark; return how it ends."""
    return subprocess.run(
        [sys.executable, str(PROGRAM), *map(str, words)],
        env=os.environ | ros_environment,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )


def test_what_is_measured_can_be_true(ros_environment, small_model_file, tmp_path):
    path = tmp_path / 'live.json'
    words = ['--size', '160x120', '--rate', 20, '--seconds', 3, '--settle', 1]
    ended = live(ros_environment, *words, '--model', small_model_file, '--json', path)
    assert ended.returncode == 0, ended.stderr
    assert '| 160x120 at 20 Hz, 3 s, one person, masks |' in ended.stdout
    results = json.loads(path.read_text())
    assert results['model'] == str(small_model_file)
    (run,) = results['runs']
    assert (run['size'], run['rate'], run['seconds']) == ('160x120', 20, 3)
    # A busy computer may be late, but neither invents images nor loses track of them.
    assert 0 < run['sent_per_second'] < 21
    assert 0 < run['answers_per_second'] < 21
    assert run['answers'] <= run['sent'] <= 81
    assert 0 <= run['unaccounted'] <= 2
    assert run['drops']['replaced'] >= 0
    latency = run['latency_ms']
    assert 0 < latency['p50'] <= latency['p95'] <= latency['max']
    assert max(run['stages_ms_p50'].values()) < latency['max']
    assert 0 < run['processor_share'] < 2
    memory = run['memory_mb']
    assert 50 < memory['private_end'] < memory['end'] < 2000
    assert 0 <= memory['largest_growth'] < 100
    assert abs(memory['typical_growth']) < 100
    assert len(memory['resident']) == len(memory['seconds']) >= 2
    assert 4 < run['joints_an_answer'] <= 8


def test_model_that_is_none_is_told_of_in_one_line(ros_environment, tmp_path):
    ended = live(ros_environment, '--seconds', 1, '--model', tmp_path / 'none.npz')
    assert ended.returncode == 2
    (complaint,) = (line for line in ended.stderr.splitlines() if 'error' in line)
    assert 'none.npz' in complaint
