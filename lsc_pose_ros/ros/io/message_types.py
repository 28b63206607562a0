"""The classes of messages, found by the names of their types."""

import importlib
from typing import Any


def message_class(type_name: str) -> type[Any] | None:
    """Return the class of the messages of a type, or None where its package is not installed.

    Args:
        type_name: for example 'sensor_msgs/msg/Image'.
    """
    package, _, name = type_name.partition('/msg/')
    try:
        found: type[Any] | None = getattr(importlib.import_module(f'{package}.msg'), name, None)
    except ImportError:
        return None
    return found
