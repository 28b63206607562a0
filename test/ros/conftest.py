"""The fixtures of the live tests, where ROS 2 is; without it those tests skip themselves."""

import importlib.util

if importlib.util.find_spec('rclpy') is not None:
    from live_ros import (  # noqa: F401
        acquaintances,
        begin_node,
        camera,
        corner,
        ear,
        meeting,
        probe,
        remote,
        start,
        start_node,
    )
