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

"""Publishes the messages of a recording over ROS 2, unchanged, at their recorded times."""

import re
import time
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, NamedTuple

import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import QoSDurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock

from lsc_pose_ros.bags import RecordingReader, SerializedMessage, TopicSummary
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.stamps import NANOSECONDS
from lsc_pose_ros.ros.io.message_types import message_class
from lsc_pose_ros.ros.playback.pacing import Pacer

if TYPE_CHECKING:
    from rclpy.publisher import Publisher

CLOCK_TOPIC = '/clock'

_QUEUE_DEPTH = 10
_LATCHED_DEPTH = 1000  # topics such as /tf_static must keep all of their messages
_LATCHED = re.compile(r'durability:\s*(1\b|transient_local)')

# Seconds until a subscriber has found the publisher after the publisher has found it.
_SETTLING = 0.5

# How long the last messages may take to reach their subscribers.
_ACKNOWLEDGEMENT_TIMEOUT = Duration(seconds=2)


class Playback(NamedTuple):
    """How a recording is played.

    Attributes:
        rate: recorded seconds per real second.
        clock: whether the recorded time is published on /clock.
        remap: recorded names of topics, and the names under which they are published.
    """

    rate: float = 1.0
    clock: bool = False
    remap: Mapping[str, str] = {}


@contextmanager
def open_player(reader: RecordingReader, playback: Playback) -> Iterator['Player']:
    """Create a player; its publishers are removed at the end of the `with` block.

    Args:
        reader: the recording.
        playback: how to play it.

    Raises:
        InputError: a topic to rename is not in the recording.
    """
    rclpy.init(args=[])
    try:
        node = Node('lsc_pose_player', use_global_arguments=False)
        try:
            yield Player(node, reader, playback)
        finally:
            node.destroy_node()
    finally:
        rclpy.try_shutdown()


class Player:
    """Publishes one recording; use `open_player` to create one.

    Attributes:
        left_out: a sentence for each topic that cannot be published.
        published: the number of messages that have been published.
    """

    def __init__(self, node: Node, reader: RecordingReader, playback: Playback) -> None:
        """Create the publishers on `node`; the other arguments are those of `open_player`."""
        _check_names(reader, playback.remap)
        self._node = node
        self._playback = playback
        self.left_out: list[str] = []
        self.published = 0
        self._clock: Publisher | None = None
        if playback.clock:
            self._clock = node.create_publisher(Clock, CLOCK_TOPIC, 1)
        self._publishers: dict[str, Publisher] = {}
        for name, topic in reader.topics.items():
            self._advertise(name, topic)

    def wait_for_subscribers(self, topics: Collection[str], seconds: float) -> bool:
        """Wait until each of `topics` has a subscriber.

        Args:
            topics: recorded names; topics that are not published are ignored.
            seconds: the longest time to wait.

        Returns:
            whether all of them have a subscriber.
        """
        publishers = [self._publishers[name] for name in topics if name in self._publishers]
        deadline = time.monotonic() + seconds
        while self._node.context.ok():
            if all(publisher.get_subscription_count() for publisher in publishers):
                time.sleep(_SETTLING)
                return True
            if time.monotonic() > deadline:
                break
            time.sleep(0.02)
        return False

    def play(self, messages: Iterable[SerializedMessage]) -> bool:
        """Publish all `messages` once.

        Args:
            messages: the messages of the recording.

        Returns:
            True if all were published, False if SIGTERM came before the end.
        """
        pacer = Pacer(self._playback.rate)
        for message in messages:
            publisher = self._publishers.get(message.topic)
            if publisher is None:
                continue
            for moment in pacer.wait_until(message.log_time):
                if not self._node.context.ok():
                    return False
                self._publish_clock(moment)
            publisher.publish(message.data)
            self.published += 1
        return True

    def finish(self) -> None:
        """Wait until the last messages have arrived."""
        for publisher in self._publishers.values():
            publisher.wait_for_all_acked(_ACKNOWLEDGEMENT_TIMEOUT)
        time.sleep(_SETTLING)  # best-effort subscribers acknowledge nothing

    def _advertise(self, name: str, topic: TopicSummary) -> None:
        played_as = self._playback.remap.get(name, name)
        if played_as == CLOCK_TOPIC and self._clock is not None:
            return  # two clocks would contradict each other
        kind = message_class(topic.type_name)
        if kind is None:
            self.left_out.append(
                f'{name} is not played: the package of {topic.type_name} is not installed'
            )
            return
        self._publishers[name] = self._node.create_publisher(kind, played_as, _qos(topic.qos))

    def _publish_clock(self, moment: int) -> None:
        if self._clock is not None:
            message = Clock()
            message.clock.sec, message.clock.nanosec = divmod(moment, NANOSECONDS)
            self._clock.publish(message)


def _check_names(reader: RecordingReader, remap: Mapping[str, str]) -> None:
    unknown = sorted(set(remap) - set(reader.topics))
    if unknown:
        msg = f'{reader.path}: no topic {", ".join(unknown)}; it has {", ".join(reader.topics)}'
        raise InputError(msg)


def _qos(offered: str) -> QoSProfile:
    """Return the QoS to publish with: reliable, which fits subscribers of both kinds."""
    if _LATCHED.search(offered):
        return QoSProfile(depth=_LATCHED_DEPTH, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)
    return QoSProfile(depth=_QUEUE_DEPTH)
