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

"""Publishes the status of the node on /diagnostics, once a second."""

import importlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from lsc_pose_ros.messages.stamps import NANOSECONDS
from lsc_pose_ros.ros.health.diagnostic_status import Interval, Status, status_of
from lsc_pose_ros.ros.health.measurements import MeasurementCollector
from lsc_pose_ros.ros.health.stream_warnings import Counters

if TYPE_CHECKING:
    from rclpy.timer import Timer

TOPIC = '/diagnostics'
PERIOD = 1.0

_QUEUE_DEPTH = 10
_TASK = 'pose estimation'


class Diagnostics:
    """Measures how the node works, and publishes its status until `close`.

    The worker's thread reports each frame:

        with diagnostics.measurements.stage('decode'):
            ...
        diagnostics.count_estimate(stamp, bodies)     # after publication; or
        diagnostics.measurements.count_failure()

    Attributes:
        measurements: collects the measurements; may be used from any thread.
        notes: names and values that are shown besides the measurements. A value may be set from
            any thread.
    """

    def __init__(self, node: Node, counters: Callable[[], Counters]) -> None:
        """Advertise, and start to publish.

        If diagnostic_msgs is not installed, the log says so and nothing is published.

        Args:
            node: the node that publishes; latencies are measured with its clock.
            counters: returns the current counters; called in the executor's thread.
        """
        self.measurements = MeasurementCollector()
        self.notes: dict[str, str] = {}
        self._node = node
        self._timer: Timer | None = None
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
        # Real time: if the clock of a recording stands still, the status is needed most.
        self._clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._last = self._last_depth = self._clock.now()
        self._publisher = node.create_publisher(
            self._messages.DiagnosticArray, TOPIC, _QUEUE_DEPTH
        )
        self._timer = node.create_timer(PERIOD, self._publish, clock=self._clock)

    def count_estimate(self, stamp: int, bodies: int) -> None:
        """Count an estimate that has just been published.

        Args:
            stamp: the stamp of the depth image, nanoseconds.
            bodies: the number of bodies in the estimate.
        """
        latency = self._node.get_clock().now().nanoseconds - stamp
        self.measurements.count_estimate(bodies, latency / NANOSECONDS)

    def close(self) -> None:
        """Stop publishing."""
        if self._timer is not None:
            self._node.destroy_timer(self._timer)
            self._timer = None
        if self._publisher is not None:
            self._node.destroy_publisher(self._publisher)
            self._publisher = None

    def _publish(self) -> None:
        if self._publisher is None:
            return
        status = status_of(self._next_interval())
        self._publisher.publish(self._message(status))

    def _next_interval(self) -> Interval:
        """Return the interval since the last call."""
        before, now, time = self._before, self._counters(), self._clock.now()
        if now.depth != before.depth:
            self._last_depth = time
        interval = Interval(
            (time - self._last).nanoseconds / NANOSECONDS,
            (time - self._last_depth).nanoseconds / NANOSECONDS,
            before,
            now,
            self.measurements.take(),
            dict(self.notes),
        )
        self._before, self._last = now, time
        return interval

    def _message(self, status: Status) -> Any:  # noqa: ANN401 - the package may be missing
        item = self._messages.DiagnosticStatus(
            name=f'{self._node.get_fully_qualified_name().lstrip("/")}: {_TASK}',
            level=bytes([status.level.value]),
            message=status.message,
            values=[
                self._messages.KeyValue(key=key, value=value)
                for key, value in status.values.items()
            ],
        )
        message = self._messages.DiagnosticArray(status=[item])
        message.header.stamp = self._node.get_clock().now().to_msg()
        return message


def _diagnostic_messages() -> Any:  # noqa: ANN401 - the package may be missing
    """Return the module of the messages, or None if their package is not installed."""
    try:
        return importlib.import_module('diagnostic_msgs.msg')
    except ImportError:
        return None
