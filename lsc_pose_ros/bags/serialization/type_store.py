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

"""The message types of ROS 2 Jazzy as rosbags has them: classes, definitions and hashes."""

from functools import cache
from typing import Any

import numpy as np
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.base import TypesysError
from rosbags.typesys.store import Typestore

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.message_classes import MessageClasses


@cache
def typestore() -> Typestore:
    """Return the message types of ROS 2 Jazzy."""
    return get_typestore(Stores.ROS2_JAZZY)


def message_class(type_name: str) -> Any:  # noqa: ANN401
    """Return the rosbags class of a message type, e.g. 'sensor_msgs/msg/Image'."""
    return typestore().types[type_name]


ROSBAGS_CLASSES = MessageClasses(
    message_class,
    lambda data: np.frombuffer(data, np.uint8),
    lambda numbers: np.array(numbers, np.float64),
)
"""The message classes of rosbags, for the functions of `messages.build`."""


@cache
def type_definition(type_name: str) -> str:
    """Return the definition of a type and of all types it consists of, as rosbag2 stores it.

    Raises:
        InputError: the type is not one of the common messages of ROS 2 Jazzy.
    """
    try:
        return typestore().generate_msgdef(type_name, ros_version=2)[0]
    except (KeyError, TypesysError) as error:
        msg = (
            f'messages of the type {type_name!r} cannot be written: '
            'its definition is not among the common messages of ROS 2 Jazzy'
        )
        raise InputError(msg) from error


@cache
def type_hash(type_name: str) -> str:
    """Return the hash of a type by REP-2016, e.g. 'RIHS01_d31d...'."""
    return typestore().hash_rihs01(type_name)
