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

"""What the node says of itself on /diagnostics, each second."""

import importlib
from collections.abc import Callable
from typing import Any

from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from lsc_pose_ros.messages.stamps import NANOSECONDS
from lsc_pose_ros.ros.health.diagnostic_status import Condition, Stretch, condition
from lsc_pose_ros.ros.health.measurements import Measuring
from lsc_pose_ros.ros.health.stream_warnings import Counters

TOPIC = '/diagnostics'
PERIOD = 1.0

_QUEUE_DEPTH = 10
_TASK = 'pose estimation'


class Diagnostics:
    """Measures how the node does, and publishes it until `close`.

    The worker's thread tells what it does:

        with diagnostics.measuring.stage('decode'):
            ...
        diagnostics.answered(stamp, bodies)     # after publication; or
        diagnostics.measuring.failed()

    Attributes:
        measuring: what collects the measurements; may be used from any thread.
    """

    def __init__(self, node: Node, counters: Callable[[], Counters]) -> None:
        """Advertise, and publish from now on.

        Where diagnostic_msgs is not installed, the log says so and nothing is published.

        Args:
            node: the node that publishes; its clock is that of the latencies.
            counters: called in the executor's thread for how much has come and gone.
        """
        self.measuring = Measuring()
        self._node = node
        self._counters = counters
        self._before = counters()
        self._messages = _diagnostic_messages()
        if self._messages is None:
            node.get_logger().info(
                f'nothing is published on {TOPIC}: diagnostic_msgs is not installed; '
                'install the package ros-jazzy-diagnostic-msgs to have it'
            )
            self._publisher = None
            return
        # Real time, for where a recording's clock stands still there is the most to say.
        self._clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._last = self._heard = self._clock.now()
        self._publisher = node.create_publisher(
            self._messages.DiagnosticArray, TOPIC, _QUEUE_DEPTH
        )
        self._timer = node.create_timer(PERIOD, self._publish, clock=self._clock)

    def answered(self, stamp: int, bodies: int) -> None:
        """Count an answer that has just been published.

        Args:
            stamp: the depth image's, nanoseconds.
            bodies: how many bodies the answer has.
        """
        latency = self._node.get_clock().now().nanoseconds - stamp
        self.measuring.answered(bodies, latency / NANOSECONDS)

    def close(self) -> None:
        """Publish no more."""
        if self._publisher is not None:
            self._node.destroy_timer(self._timer)
            self._node.destroy_publisher(self._publisher)
            self._publisher = None

    def _publish(self) -> None:
        if self._publisher is None:
            return
        found = condition(self._stretch())
        self._publisher.publish(self._message(found))

    def _stretch(self) -> Stretch:
        """Return what there is to tell since the last time."""
        before, now, time = self._before, self._counters(), self._clock.now()
        if now.depth != before.depth:
            self._heard = time
        stretch = Stretch(
            (time - self._last).nanoseconds / NANOSECONDS,
            (time - self._heard).nanoseconds / NANOSECONDS,
            before,
            now,
            self.measuring.take(),
        )
        self._before, self._last = now, time
        return stretch

    def _message(self, found: Condition) -> Any:  # noqa: ANN401
        status = self._messages.DiagnosticStatus(
            name=f'{self._node.get_fully_qualified_name().lstrip("/")}: {_TASK}',
            level=bytes([found.level.value]),
            message=found.message,
            values=[
                self._messages.KeyValue(key=key, value=value)
                for key, value in found.values.items()
            ],
        )
        message = self._messages.DiagnosticArray(status=[status])
        message.header.stamp = self._node.get_clock().now().to_msg()
        return message


def _diagnostic_messages() -> Any:  # noqa: ANN401
    """Return the module of the messages, or None where their package is not installed."""
    try:
        return importlib.import_module('diagnostic_msgs.msg')
    except ImportError:
        return None
