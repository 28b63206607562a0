"""The fixtures of the live tests, where ROS 2 is; without it those tests skip themselves."""

import importlib.util

if importlib.util.find_spec('rclpy') is not None:
    from live_ros import (  # noqa: F401
        active_node,
        camera,
        estimates,
        probe,
        ros_environment,
        services,
        shared_node,
        spawn_node,
        start_node,
        start_program,
    )
