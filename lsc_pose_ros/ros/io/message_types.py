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
