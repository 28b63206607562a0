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

"""What the wheel holds, and what it does not."""

import configparser
import importlib
import re
import zipfile
from pathlib import Path

import lsc_pose_ros

ROOT = Path(__file__).parents[2]


def test_wheel_holds_the_package_and_nothing_else(wheel: zipfile.ZipFile) -> None:
    package = ROOT / 'lsc_pose_ros'
    files = {
        path.relative_to(ROOT).as_posix()
        for path in package.rglob('*')
        if path.is_file() and '__pycache__' not in path.parts
    }
    assert {'lsc_pose_ros/py.typed', 'lsc_pose_ros/resources/models/default.npz'} <= files
    described = re.compile(r'lsc_pose_ros-[^/]+\.(dist-info|data)/')
    assert files == {
        name for name in wheel.namelist() if not described.match(name) and not name.endswith('/')
    }


def test_wheel_holds_no_test_experiment_or_plain_kernel(wheel: zipfile.ZipFile) -> None:
    folders = {part for name in wheel.namelist() for part in Path(name).parent.parts}
    others = {'test', 'tests', 'experiments', 'lsc_pose_experiments', 'benchmarks', 'plain'}
    assert not folders & others


def test_wheel_holds_the_shared_files_at_their_places(wheel: zipfile.ZipFile) -> None:
    expected = {'share/ament_index/resource_index/packages/lsc_pose_ros'}
    expected.add('share/lsc_pose_ros/package.xml')
    expected |= {f'lib/lsc_pose_ros/{name}' for name in ('lsc_pose', 'pose_node')}
    for folder in ('config', 'launch'):
        expected |= {
            f'share/lsc_pose_ros/{path.relative_to(ROOT)}'
            for path in (ROOT / folder).rglob('*')
            if path.is_file() and path.suffix != '.pyc'
        }
    data = f'lsc_pose_ros-{lsc_pose_ros.__version__}.data/data/'
    assert expected == {
        name.removeprefix(data)
        for name in wheel.namelist()
        if name.startswith(data) and not name.endswith('/')
    }


def test_wheel_gives_both_executables(wheel: zipfile.ZipFile) -> None:
    folder = f'lsc_pose_ros-{lsc_pose_ros.__version__}.dist-info'
    scripts = configparser.ConfigParser()
    scripts.read_string(wheel.read(f'{folder}/entry_points.txt').decode())
    assert set(scripts['console_scripts']) == {'lsc_pose', 'pose_node'}
    for target in scripts['console_scripts'].values():
        module, _, function = target.partition(':')
        assert callable(getattr(importlib.import_module(module), function))
