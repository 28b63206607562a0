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

"""Imports modules that need ROS 2, with one error message if it is missing."""

import importlib
from types import ModuleType

from lsc_pose_ros.errors import InputError


def load_with_ros(module: str) -> ModuleType:
    """Import and return a module that needs rclpy or message packages.

    Args:
        module: the name of the module.

    Raises:
        InputError: ROS 2 or one of the message packages is not installed, or cannot start.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        reason = str(error).splitlines()[0] if str(error) else module
        msg = (
            f'ROS 2 is not available to this Python ({reason}); source a ROS 2 installation, '
            "or run pip install '.[ros]' in a clone of the repository"
        )
        raise InputError(msg) from error
