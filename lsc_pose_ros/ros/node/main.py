"""`pose_node`: the program around the node."""

import os
import signal
import sys

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.ros.requirements import load_with_ros

BAD_INPUT = 2


def main(args: list[str] | None = None) -> int:
    """Run the node until SIGINT or SIGTERM and return the exit status.

    Args:
        args: the command line with --ros-args; None for the process's own.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        # While libraries are loaded there is nothing to close; the node takes over afterwards.
        signal.signal(number, lambda *_: os._exit(0))
    try:
        load_with_ros('lsc_pose_ros.ros.node.run').run_node(args)
    except InputError as error:
        sys.stderr.write(f'pose_node: error: {" ".join(str(error).split())}\n')
        return BAD_INPUT
    return 0


if __name__ == '__main__':
    sys.exit(main())
