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

"""Builds the messages that other messages consist of."""

from typing import Any

from lsc_pose_ros.messages.message_classes import MessageClasses
from lsc_pose_ros.messages.stamps import sec_nanosec
from lsc_pose_ros.messages.type_names import DURATION, HEADER, TIME


def build_header(classes: MessageClasses, stamp: int, frame_id: str) -> Any:  # noqa: ANN401
    """Return a std_msgs/Header.

    Args:
        classes: the message classes.
        stamp: nanoseconds.
        frame_id: the coordinate frame.
    """
    seconds, nanoseconds = sec_nanosec(stamp)
    time = classes.find(TIME)(sec=seconds, nanosec=nanoseconds)
    return classes.find(HEADER)(stamp=time, frame_id=frame_id)


def build_duration(classes: MessageClasses, duration: int) -> Any:  # noqa: ANN401
    """Return `duration`, nanoseconds, as a builtin_interfaces/Duration."""
    seconds, nanoseconds = sec_nanosec(duration)
    return classes.find(DURATION)(sec=seconds, nanosec=nanoseconds)
