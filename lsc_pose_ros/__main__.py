"""`python -m lsc_pose_ros` is `lsc_pose`."""

import sys

from lsc_pose_ros.cli.main import main

if __name__ == '__main__':
    sys.exit(main())
