"""Runs the node until it is told to stop."""

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.ros.node import PoseNode


def run_node(words: list[str] | None = None) -> None:
    """Run the node until SIGINT or SIGTERM.

    Args:
        words: the command line with --ros-args; None for the process's own.

    Raises:
        InputError: an argument, a parameter or the model cannot be used.
    """
    try:
        rclpy.init(args=words)
    except RuntimeError as error:  # what all of rclpy's own errors are
        msg = f'the arguments after --ros-args cannot be read: {error}'
        raise InputError(msg) from error
    try:
        node = PoseNode()
        try:
            # One thread is enough: its callbacks only pass messages on to the worker.
            executor = SingleThreadedExecutor()
            executor.add_node(node)
            executor.spin()
        finally:
            node.close()
            node.destroy_node()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # the ordinary ends
    except RuntimeError:
        if rclpy.ok():
            raise
        # Told to stop while it was starting: nothing more can be made of ROS.
    finally:
        rclpy.try_shutdown()
