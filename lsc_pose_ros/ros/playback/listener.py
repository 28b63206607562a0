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

"""Receives the messages of some topics and keeps them, serialized."""

import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress

import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node

from lsc_pose_ros.bags import SerializedMessage
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.ros.io.message_types import message_class

_QUEUE_DEPTH = 100


class Listener:
    """Subscribes and keeps all messages; use `open_listener` to create one.

    Attributes:
        node: the node that subscribes.
        received: the messages in the order in which they came.
    """

    def __init__(self, node: Node, topics: Mapping[str, str]) -> None:
        """Subscribe.

        Args:
            node: the node that subscribes.
            topics: the type of each topic, by the topic's name.

        Raises:
            InputError: the package of a type is not installed.
        """
        self.node = node
        self.received: list[SerializedMessage] = []
        self._subscriptions = []
        for topic, type_name in topics.items():
            kind = message_class(type_name)
            if kind is None:
                msg = f'{topic}: the package of {type_name} is not installed'
                raise InputError(msg)
            keep = self._keeper(topic, type_name)
            self._subscriptions.append(
                node.create_subscription(kind, topic, keep, _QUEUE_DEPTH, raw=True)
            )

    @property
    def has_publishers(self) -> bool:
        """Whether any topic has a publisher."""
        return any(each.get_publisher_count() for each in self._subscriptions)

    def wait_for_publishers(self, seconds: float) -> bool:
        """Wait at most `seconds` until each topic has a publisher; return whether it has."""
        return _wait_until(
            lambda: all(each.get_publisher_count() for each in self._subscriptions), seconds
        )

    def wait_for_messages(self, count: int, seconds: float) -> bool:
        """Wait at most `seconds` for `count` messages; return whether they have come."""
        return _wait_until(lambda: len(self.received) >= count, seconds)

    def _keeper(self, topic: str, type_name: str) -> Callable[[bytes], None]:
        def keep(data: bytes) -> None:
            self.received.append(SerializedMessage(topic, type_name, time.time_ns(), data))

        return keep


@contextmanager
def open_listener(topics: Mapping[str, str]) -> Iterator[Listener]:
    """Create a listener that receives in its own thread until the end of the `with` block.

    Args:
        topics: names of topics with the names of their types.

    Raises:
        InputError: the package of a type is not installed.
    """
    context = Context()
    rclpy.init(args=[], context=context)
    node = Node('lsc_pose_listener', context=context, use_global_arguments=False)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    thread = threading.Thread(target=_spin, args=(executor,), name='listener', daemon=True)
    try:
        listener = Listener(node, topics)
        thread.start()
        yield listener
    finally:
        executor.shutdown()
        if thread.is_alive():
            thread.join()
        node.destroy_node()
        rclpy.try_shutdown(context=context)


def _spin(executor: SingleThreadedExecutor) -> None:
    with suppress(ExternalShutdownException):
        executor.spin()


def _wait_until(true: Callable[[], bool], seconds: float) -> bool:
    deadline = time.monotonic() + seconds
    while not true():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.02)
    return True
