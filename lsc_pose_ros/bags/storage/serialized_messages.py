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

"""What every container of a recording comes down to: topics and serialised messages."""

from dataclasses import dataclass
from typing import NamedTuple


class SerializedMessage(NamedTuple):
    """One message as it was recorded.

    Attributes:
        topic: its name.
        type_name: for example 'sensor_msgs/msg/Image'.
        log_time: when it was recorded, nanoseconds.
        data: the serialised message (CDR), decompressed.
    """

    topic: str
    type_name: str
    log_time: int
    data: bytes


@dataclass(frozen=True)
class TopicSummary:
    """What a recording says of a topic.

    Attributes:
        type_name: for example 'sensor_msgs/msg/Image'.
        count: how many messages it has, None where the recording does not say.
        qos: the publishers' offered QoS profiles as rosbag2 writes them, YAML text.
    """

    type_name: str
    count: int | None
    qos: str


class ReadStatistics:
    """What has been read of a recording so far.

    Attributes:
        counts: messages of each topic.
        size: bytes of all messages.
        start: the earliest log time, nanoseconds; 0 before the first message.
        end: the latest.
    """

    def __init__(self) -> None:
        """Start from nothing."""
        self.counts: dict[str, int] = {}
        self.size = 0
        self.start = 0
        self.end = 0

    @property
    def messages(self) -> int:
        """How many messages have been read."""
        return sum(self.counts.values())

    @property
    def seconds(self) -> float:
        """The time between the earliest and the latest message."""
        return (self.end - self.start) * 1e-9

    def add(self, message: SerializedMessage) -> None:
        """Count `message`."""
        first = not self.counts
        self.counts[message.topic] = self.counts.get(message.topic, 0) + 1
        self.size += len(message.data)
        self.start = message.log_time if first else min(self.start, message.log_time)
        self.end = message.log_time if first else max(self.end, message.log_time)

    def __str__(self) -> str:
        """Say how much was read."""
        return f'{self.messages} messages, {self.size * 1e-6:.1f} MB, {self.seconds:.1f} s'
