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

"""The interface to the message classes of a ROS library: rclpy in the node, rosbags offline."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple


class MessageClasses(NamedTuple):
    """The message classes of one ROS library.

    The functions of `messages.build` pass every field by name, because the classes of rosbags
    have no default values.

    Attributes:
        find: returns the class of a message type, given its name, e.g. 'sensor_msgs/msg/Image'.
        octets: converts bytes to the value of a field uint8[]: an array.array for rclpy, a numpy
            array for rosbags. Neither library takes the other's type (rclpy takes 60 ms to copy
            a numpy array of one VGA image).
        doubles: converts numbers to the value of a field float64[], in the same way.
    """

    find: Callable[[str], Any]
    octets: Callable[[bytes], Any]
    doubles: Callable[[Sequence[float]], Any]
