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

"""Receives the transforms that tell the roll of the camera."""

from typing import TYPE_CHECKING, Any

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from lsc_pose_ros.camera.roll_finder import RollFinder
from lsc_pose_ros.messages.parse import parse_transforms
from lsc_pose_ros.messages.type_names import TF_MESSAGE
from lsc_pose_ros.ros.io.message_types import message_class

if TYPE_CHECKING:
    from rclpy.subscription import Subscription

# The queue depth of tf2_ros's listener.
_QUEUE_DEPTH = 100

# How often it is checked whether /tf is needed, seconds.
_PERIOD = 1.0

_STATIC_PROFILE = QoSProfile(depth=_QUEUE_DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class TransformListener:
    """Subscribes to /tf_static, and to /tf while the way to gravity is not all static.

    A robot publishes thousands of transforms per second on /tf, and a camera is usually fixed.
    Without the package tf2_msgs nothing is received.
    """

    def __init__(self, node: Node, finder: RollFinder) -> None:
        """Subscribe.

        Args:
            node: the node that subscribes.
            finder: the transforms are added to its tree.
        """
        self._node = node
        self._finder = finder
        self._message_class = message_class(TF_MESSAGE)
        self._static_frames: set[str] = set()
        self._dynamic: Subscription | None = None
        self._static: Subscription | None = None
        self._timer = None
        if self._message_class is None:
            return
        self._static = node.create_subscription(
            self._message_class, '/tf_static', self._add_static, _STATIC_PROFILE
        )
        self._timer = node.create_timer(
            _PERIOD, self._update, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )
        self._update()

    def close(self) -> None:
        """Unsubscribe."""
        if self._timer is not None:
            self._node.destroy_timer(self._timer)
        for each in (self._static, self._dynamic):
            if each is not None:
                self._node.destroy_subscription(each)
        self._timer = self._static = self._dynamic = None

    def _update(self) -> None:
        way = self._finder.way
        needed = not way or not self._static_frames.issuperset(way[:-1])
        if needed and self._dynamic is None:
            self._dynamic = self._node.create_subscription(
                self._message_class, '/tf', self._add, _QUEUE_DEPTH
            )
        elif self._dynamic is not None and not needed:
            self._node.destroy_subscription(self._dynamic)
            self._dynamic = None

    def _add_static(self, message: Any) -> None:  # noqa: ANN401
        for transform in parse_transforms(message):
            self._static_frames.add(transform.child.lstrip('/'))
            self._finder.tree.add(transform)

    def _add(self, message: Any) -> None:  # noqa: ANN401
        for transform in parse_transforms(message):
            self._finder.tree.add(transform)
