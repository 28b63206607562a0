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
import importlib.util
import os
import re
from functools import cache
from pathlib import Path
from typing import Any

import rclpy

from lsc_pose_ros.messages.message_classes import MessageClasses

_TYPE = re.compile(r'([A-Za-z]\w*)/msg/([A-Za-z]\w*)', re.ASCII)

_INDEX = Path('share', 'ament_index', 'resource_index', 'rosidl_interfaces')
"""The folder of an installation with one file for each package that has messages."""

_OWN_PACKAGES = frozenset({
    'builtin_interfaces', 'diagnostic_msgs', 'geometry_msgs', 'hri_msgs', 'rosgraph_msgs',
    'sensor_msgs', 'std_msgs', 'tf2_msgs', 'visualization_msgs',
})  # fmt: skip
"""The packages that this package itself names, which may be installed without an index."""


@cache
def message_class(type_name: str) -> type[Any] | None:
    """Return the class of a message type, or None if its package is not installed.

    The name may come from a stranger's recording. Only packages of ROS messages are imported:
    those that an installation lists as such, and only from this installation.

    Args:
        type_name: for example 'sensor_msgs/msg/Image'.
    """
    found = _TYPE.fullmatch(type_name)
    if found is None:
        return None
    package, name = found.groups()
    if package not in _OWN_PACKAGES and not _is_message_package(package):
        return None
    try:
        module = importlib.import_module(f'{package}.msg')
    except ImportError:
        return None
    kind: type[Any] | None = getattr(module, name, None)
    return kind


def _is_message_package(package: str) -> bool:
    """Return whether `package` is one of ROS messages, without importing it."""
    spec = importlib.util.find_spec(package)
    if spec is None or spec.origin is None:
        return False
    origin = Path(os.path.abspath(spec.origin))  # noqa: PTH100 - links are not followed
    return any(
        (prefix / _INDEX / package).is_file() and origin.is_relative_to(prefix)
        for prefix in _installations()
    )


def _installations() -> list[Path]:
    """Return the folders of the installations of ROS: those that are sourced, and rclpy's own."""
    sourced = os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)
    folders = Path(rclpy.__file__).parents
    # PREFIX/lib/python3.x/site-packages/rclpy/__init__.py; `pip install --target`: PREFIX/rclpy.
    return [*map(Path, filter(os.path.isabs, sourced)), folders[1], folders[4]]


RCLPY_CLASSES = MessageClasses(
    message_class,
    lambda data: array.array('B', data),
    lambda numbers: array.array('d', numbers),
)
"""The message classes of rclpy, for the functions of `messages.build`."""
