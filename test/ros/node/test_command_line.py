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

"""The command line of `pose_node`: help, version and unknown words. No test needs ROS 2."""

import subprocess
import sys

import pytest

from lsc_pose_ros import __version__
from lsc_pose_ros.ros.node.command_line import check_command_line

# The node where rclpy cannot be imported.
WITHOUT_ROS = """
import sys

sys.modules['rclpy'] = None

from lsc_pose_ros.ros.node.main import main

sys.exit(main())
"""


@pytest.mark.parametrize(
    'words',
    [
        [],
        ['--ros-args'],
        ['--ros-args', '-p', 'model:=front', '-r', 'mask:=people'],
        ['--ros-args', '-p', 'model:=front', '--', '--ros-args', '--log-level', 'debug'],
    ],
)
def test_arguments_of_ros_are_left_to_ros(words: list[str]) -> None:
    check_command_line(words)


@pytest.mark.parametrize(
    ('words', 'unknown'),
    [
        (['front'], 'front'),
        (['model:=front'], 'model:=front'),
        (['__ns:=/robot'], '__ns:=/robot'),
        (['-p', 'model:=front'], '-p model:=front'),
        (['--vers'], '--vers'),
        (['--ros-args', '-p', 'model:=front', '--', 'more'], 'more'),
    ],
)
def test_unknown_words_are_named(
    words: list[str], unknown: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as end:
        check_command_line(words)
    assert end.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f'pose_node: error: unknown argument: {unknown};')
    assert '--ros-args' in line


@pytest.mark.parametrize(
    ('words', 'status', 'text'),
    [
        (['--help'], 0, '--ros-args -p NAME:=VALUE'),
        (['-h'], 0, '--ros-args --params-file FILE'),
        (['--version'], 0, f'pose_node {__version__}'),
        (['--version', '--ros-args', '-p', 'model:=front'], 0, f'pose_node {__version__}'),
        (['front'], 2, 'unknown argument: front'),
    ],
)
def test_program_ends_without_ros(words: list[str], status: int, text: str) -> None:
    result = subprocess.run(
        [sys.executable, '-c', WITHOUT_ROS, *words], capture_output=True, text=True, check=False
    )
    assert result.returncode == status
    assert text in result.stdout + result.stderr
