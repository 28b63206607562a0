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

"""Each source file has the header that ROS checks; ruff checks its first lines (CPY001)."""

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FOLDERS = ('lsc_pose_ros', 'experiments', 'launch', 'benchmarks', 'models', 'test')


def test_ament_copyright_finds_no_problem(monkeypatch: pytest.MonkeyPatch) -> None:
    ament_copyright = pytest.importorskip('ament_copyright.main')
    monkeypatch.chdir(ROOT)
    paths = [*FOLDERS, 'setup.py', 'LICENSE', 'CONTRIBUTING.md']
    assert ament_copyright.main(paths) == os.EX_OK
