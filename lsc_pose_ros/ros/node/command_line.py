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

"""The command line of `pose_node`, beside the arguments that ROS 2 reads; does not import ROS."""

import argparse
from collections.abc import Sequence

from lsc_pose_ros import __version__

PROGRAM = 'pose_node'

_DESCRIPTION = 'Publish the joints of the people in depth images as a ROS 2 node.'

_EPILOG = """\
Everything is set by the arguments of ROS 2:
  --ros-args -p NAME:=VALUE        set a parameter; docs/parameters.md lists them
  --ros-args --params-file FILE    set the parameters in a file, such as config/pose_node.yaml
  --ros-args -r depth/image:=TOPIC -r depth/camera_info:=TOPIC -r mask:=TOPIC
                                   subscribe to the topics of a camera and a segmentation
  --ros-args -r __ns:=/NAMESPACE   start the node in a namespace

A running node describes its parameters: ros2 param describe /pose_node NAME
"""

_ROS_ARGUMENTS = '--ros-args'
_END_OF_ROS_ARGUMENTS = '--'


def check_command_line(words: Sequence[str]) -> None:
    """Answer --help and --version, and refuse words that neither the node nor ROS 2 reads.

    Args:
        words: the command line without the program.

    Raises:
        SystemExit: a word is unknown (status 2), or help or the version was requested (status 0).
    """
    parser = argparse.ArgumentParser(
        prog=PROGRAM,
        usage=f'{PROGRAM} [-h] [--version] [--ros-args ...]',
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument('--version', action='version', version=f'{PROGRAM} {__version__}')
    _, unknown = parser.parse_known_args(_without_ros_arguments(words))
    if unknown:
        parser.exit(
            2,
            f'{PROGRAM}: error: unknown argument: {" ".join(unknown)}; parameters and remappings '
            f'come after {_ROS_ARGUMENTS} (see {PROGRAM} --help)\n',
        )


def _without_ros_arguments(words: Sequence[str]) -> list[str]:
    """Return the words that are not between `--ros-args` and `--` or the end."""
    kept = []
    for_ros = False
    for word in words:
        if word == _ROS_ARGUMENTS:
            for_ros = True
        elif for_ros and word == _END_OF_ROS_ARGUMENTS:
            for_ros = False
        elif not for_ros:
            kept.append(word)
    return kept
