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

"""Topics and serialized messages, as all storage formats contain them."""

from dataclasses import dataclass
from typing import NamedTuple


class SerializedMessage(NamedTuple):
    """One recorded message.

    Attributes:
        topic: the name of the topic.
        type_name: for example 'sensor_msgs/msg/Image'.
        log_time: the time of recording, nanoseconds.
        data: the serialized message (CDR), decompressed.
    """

    topic: str
    type_name: str
    log_time: int
    data: bytes


@dataclass(frozen=True)
class TopicSummary:
    """A topic of a recording.

    Attributes:
        type_name: for example 'sensor_msgs/msg/Image'.
        count: the number of messages, None if it is unknown.
        qos: the QoS profiles that the publishers offered, as YAML text of rosbag2.
    """

    type_name: str
    count: int | None
    qos: str


class ReadStatistics:
    """Counts of the messages that have been read.

    Attributes:
        counts: the number of messages of each topic.
        size: the bytes of all messages.
        start: the earliest log time, nanoseconds; 0 before the first message.
        end: the latest log time, nanoseconds.
    """

    def __init__(self) -> None:
        """Start with no messages."""
        self.counts: dict[str, int] = {}
        self.size = 0
        self.start = 0
        self.end = 0

    @property
    def messages(self) -> int:
        """The number of messages."""
        return sum(self.counts.values())

    @property
    def seconds(self) -> float:
        """The time from the earliest to the latest message, seconds."""
        return (self.end - self.start) * 1e-9

    def add(self, message: SerializedMessage) -> None:
        """Count `message`."""
        first = not self.counts
        self.counts[message.topic] = self.counts.get(message.topic, 0) + 1
        self.size += len(message.data)
        self.start = message.log_time if first else min(self.start, message.log_time)
        self.end = message.log_time if first else max(self.end, message.log_time)

    def __str__(self) -> str:
        """Return a summary."""
        return f'{self.messages} messages, {self.size * 1e-6:.1f} MB, {self.seconds:.1f} s'
