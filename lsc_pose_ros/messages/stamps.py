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

"""Stamps of messages as integers, nanoseconds."""

from typing import Protocol

NANOSECONDS = 1_000_000_000
"""Nanoseconds per second."""


class Time(Protocol):
    """A builtin_interfaces/Time of any ROS library."""

    sec: int
    nanosec: int


def nanoseconds(time: Time) -> int:
    """Return `time` in nanoseconds; a field `nanosec` of a second or more is invalid, and cut."""
    return int(time.sec) * NANOSECONDS + min(int(time.nanosec), NANOSECONDS - 1)


def sec_nanosec(stamp: int) -> tuple[int, int]:
    """Return the fields `sec` and `nanosec` of `stamp`, nanoseconds."""
    return divmod(int(stamp), NANOSECONDS)
