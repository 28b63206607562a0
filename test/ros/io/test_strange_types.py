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

"""The name of a message type from a recording imports packages of messages, and nothing else."""

import sys
from pathlib import Path

import pytest

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from sensor_msgs.msg import Image

from lsc_pose_ros.ros.io.message_types import message_class


def make_package(folder: Path, name: str) -> Path:
    """Make a Python package that looks like one of messages; return what it makes if imported."""
    trace = folder / f'{name}_was_imported'
    (folder / name / 'msg').mkdir(parents=True)
    (folder / name / '__init__.py').write_text(f'open({str(trace)!r}, "w")\n')
    (folder / name / 'msg' / '__init__.py').write_text('class Thing:\n    pass\n')
    return trace


def register(prefix: Path, name: str) -> None:
    index = prefix / 'share' / 'ament_index' / 'resource_index' / 'rosidl_interfaces'
    index.mkdir(parents=True, exist_ok=True)
    (index / name).write_text('msg/Thing.msg\n')


@pytest.fixture(autouse=True)
def fresh():
    message_class.cache_clear()
    yield
    message_class.cache_clear()


def test_types_of_installed_packages():
    assert message_class('sensor_msgs/msg/Image') is Image
    assert message_class('rcl_interfaces/msg/Log').__name__ == 'Log'
    assert message_class('sensor_msgs/msg/Missing') is None
    assert message_class('missing_msgs/msg/Missing') is None


@pytest.mark.parametrize(
    'name',
    [
        'antigravity/msg/X', 'this/msg/X', 'sensor_msgs.msg/msg/Image', 'a.b/msg/X', '/msg/X', 'x',
        '', '../x/msg/X', 'sensor_msgs/msg/Image/msg/Image', 'sensor_msgs/msg/__doc__', 'ü/msg/X',
    ],
)  # fmt: skip
def test_other_names_import_nothing(name):
    before = set(sys.modules)
    assert message_class(name) is None
    assert set(sys.modules) == before


def test_package_on_the_path_is_not_run(tmp_path, monkeypatch):
    trace = make_package(tmp_path, 'stranger_msgs')
    monkeypatch.syspath_prepend(tmp_path)
    assert message_class('stranger_msgs/msg/Thing') is None
    assert not trace.exists()
    assert 'stranger_msgs' not in sys.modules


def test_package_that_is_registered_elsewhere_is_not_run(tmp_path, monkeypatch):
    """A folder on the path hides the package that the installation has."""
    register(tmp_path / 'install', 'hidden_msgs')
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(tmp_path / 'install'))
    trace = make_package(tmp_path / 'other', 'hidden_msgs')
    monkeypatch.syspath_prepend(tmp_path / 'other')
    assert message_class('hidden_msgs/msg/Thing') is None
    assert not trace.exists()


def test_package_that_a_workspace_registers(tmp_path, monkeypatch):
    site = tmp_path / 'lib' / 'python3' / 'site-packages'
    make_package(site, 'workspace_msgs')
    register(tmp_path, 'workspace_msgs')
    monkeypatch.setenv('AMENT_PREFIX_PATH', f'/missing:{tmp_path}')
    monkeypatch.syspath_prepend(site)
    assert message_class('workspace_msgs/msg/Thing').__name__ == 'Thing'
