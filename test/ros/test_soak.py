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


"""The soak test, for some seconds: each frame is answered or counted."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from waiting import PATIENCE

pytest.importorskip('rclpy')
pytest.importorskip('diagnostic_msgs')

PROGRAM = Path(__file__).parents[2] / 'benchmarks' / 'soak.py'


def test_short_soak_answers_or_counts_each_frame(ros_environment, small_model_file, tmp_path):
    words = ['--seconds', 8, '--rate', 20, '--faults', 0.4, '--seed', 3, '--output', tmp_path]
    ended = subprocess.run(
        [sys.executable, PROGRAM, *map(str, words), '--model', small_model_file],
        env=os.environ | ros_environment,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr
    report = json.loads((tmp_path / 'soak.json').read_text())
    assert report['complaints'] == []
    assert 0 < report['answered'] <= report['good'] < report['sent']
    assert report['good'] + sum(report['faults'].values()) == report['sent']
    assert len(report['faults']) > 5
    # A busy computer skips the images that would have failed.
    assert sum(report['drops'].values()) > 0
    assert report['latency_ms']['50'] <= report['latency_ms']['100']
    assert len(report['memory_mb']['resident']) > 2
    assert report['log_bytes'] < 100_000
    assert (tmp_path / 'soak.png').stat().st_size > 1000
