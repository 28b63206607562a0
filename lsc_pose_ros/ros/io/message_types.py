"""The installed message classes of rclpy, by the names of their types."""

import array
import importlib
from functools import cache
from typing import Any

from lsc_pose_ros.messages.message_classes import MessageClasses


@cache
def message_class(type_name: str) -> type[Any] | None:
    """Return the class of a message type, or None if its package is not installed.

    Args:
        type_name: for example 'sensor_msgs/msg/Image'.
    """
    package, _, name = type_name.partition('/msg/')
    try:
        found: type[Any] | None = getattr(importlib.import_module(f'{package}.msg'), name, None)
    except ImportError:
        return None
    return found


RCLPY_CLASSES = MessageClasses(message_class, lambda data: array.array('B', data))
"""The message classes of rclpy, for the functions of `messages.build`."""
