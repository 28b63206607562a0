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

"""The bond with a lifecycle manager, with a stand-in for bondpy, of which there is no wheel."""

import signal
from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from live_ros import NodeServices, Program

# The part of bondpy that the node uses.
BONDPY = """
class Bond:
    def __init__(self, topic, id, node):
        self.is_shutdown = False
        print('bond:', topic, id, node.get_fully_qualified_name(), flush=True)

    def start(self):
        print('bond: started with timeout', self.heartbeat_timeout, flush=True)

    def shutdown(self):
        if not self.is_shutdown:
            self.is_shutdown = True
            print('bond: shut down', flush=True)

    def __del__(self):
        self.shutdown()
"""


@pytest.fixture
def start_with_bondpy(
    start_program: Callable[..., Program],
    ros_environment: dict[str, str],
    small_model_file: Path,
    tmp_path: Path,
) -> Callable[..., Program]:
    """Start the node where the stand-in for bondpy can be imported."""
    package = tmp_path / 'packages' / 'bondpy'
    package.mkdir(parents=True)
    (package / '__init__.py').touch()
    (package / 'bondpy.py').write_text(BONDPY)

    def begin(*words: str) -> Program:
        return start_program(
            *('-m', 'lsc_pose_ros.ros.node.main', '--ros-args'),
            *('-p', f'model:={small_model_file}', *words),
            PYTHONPATH=f'{package.parent}:{ros_environment["PYTHONPATH"]}',
        )

    return begin


def lines_of(node: Program) -> list[str]:
    return [line for line in node.output.splitlines() if line.startswith('bond:')]


def test_bond_lasts_while_the_node_is_active(
    start_with_bondpy: Callable[..., Program], services: NodeServices
) -> None:
    node = start_with_bondpy('-p', 'autostart:=false')
    assert services.change('configure')
    assert lines_of(node) == []
    assert services.change('activate')
    begin = ['bond: bond pose_node /pose_node', 'bond: started with timeout 4.0']
    assert lines_of(node) == begin
    assert services.change('deactivate')
    assert lines_of(node) == [*begin, 'bond: shut down']
    assert services.change('activate')
    assert lines_of(node) == [*begin, 'bond: shut down', *begin]
    assert node.exit_status(signal.SIGINT) == 0
    assert lines_of(node) == [*begin, 'bond: shut down', *begin]
    assert 'Traceback' not in node.output


def test_node_that_starts_itself_has_no_bond(start_with_bondpy: Callable[..., Program]) -> None:
    node = start_with_bondpy()
    assert node.prints('ready: listening'), node.output
    assert lines_of(node) == []
