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

"""The program `pose_node`."""

import os
import signal
import sys

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.ros.node.command_line import PROGRAM, check_command_line
from lsc_pose_ros.ros.requirements import load_with_ros

BAD_INPUT = 2


def main(args: list[str] | None = None) -> int:
    """Run the node until SIGINT or SIGTERM and return the exit status.

    Args:
        args: the command line with --ros-args; None for that of the process.

    Raises:
        SystemExit: a word is unknown (status 2), or help or the version was requested (status 0).
    """
    words = sys.argv[1:] if args is None else args
    check_command_line(words)
    for number in (signal.SIGINT, signal.SIGTERM):
        # While libraries are imported there is nothing to close; the node sets other handlers.
        signal.signal(number, lambda *_: os._exit(0))
    try:
        load_with_ros('lsc_pose_ros.ros.node.run').run_node(words)
    except InputError as error:
        sys.stderr.write(f'{PROGRAM}: error: {" ".join(str(error).split())}\n')
        return BAD_INPUT
    return 0


if __name__ == '__main__':
    sys.exit(main())
