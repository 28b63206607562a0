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

"""Measures rates, latencies and the time of each stage; does not import ROS."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

LONGEST_LATENCY = 10.0
"""With an older stamp, the clock of the camera is not that of the node: an old recording."""

# Two clocks can differ by so much: a stamp may lie that far in the future, seconds.
_CLOCK_ERROR = 0.05


class Measurements(NamedTuple):
    """The measurements of one interval.

    Attributes:
        estimates: the number of frames that were estimated.
        failures: the number of frames that could not be estimated.
        bodies: the number of bodies in the last estimate.
        latencies: seconds from stamp to publication, for frames with comparable clocks.
        stages: the seconds of each stage, frame by frame.
    """

    estimates: int
    failures: int
    bodies: int
    latencies: list[float]
    stages: dict[str, list[float]]


class MeasurementCollector:
    """Collects measurements in the worker's thread until another thread takes them.

    The memory is bounded: if nobody takes the measurements, the newest values are kept.
    """

    def __init__(self, now: Callable[[], float] = time.perf_counter, capacity: int = 1000) -> None:
        """Make a collector without measurements.

        Args:
            now: the clock for the stages, seconds.
            capacity: how many values of each kind are kept.
        """
        self._now = now
        self._capacity = capacity
        self._lock = threading.Lock()
        self._clear()

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Measure the time inside the context as one frame's time of the stage `name`."""
        begin = self._now()
        yield
        seconds = self._now() - begin
        with self._lock:
            self._append(self._stages.setdefault(name, []), seconds)

    def add_stages(self, seconds: dict[str, float]) -> None:
        """Add the times of one frame's stages, seconds; a stage that did not run has 0."""
        with self._lock:
            for name, value in seconds.items():
                if value > 0:
                    self._append(self._stages.setdefault(name, []), value)

    def count_estimate(self, bodies: int, latency: float) -> None:
        """Count a frame that was estimated.

        Args:
            bodies: the number of bodies in the estimate.
            latency: seconds from the stamp of the depth image until now, by the node's clock.
        """
        with self._lock:
            self._estimates += 1
            self._bodies = bodies
            if -_CLOCK_ERROR <= latency <= LONGEST_LATENCY:
                self._append(self._latencies, max(latency, 0.0))

    def count_failure(self) -> None:
        """Count a frame that could not be estimated."""
        with self._lock:
            self._failures += 1

    def take(self) -> Measurements:
        """Return the measurements since the last call, and start a new interval."""
        with self._lock:
            taken = Measurements(
                self._estimates, self._failures, self._bodies, self._latencies, self._stages
            )
            self._clear()
        return taken

    def _clear(self) -> None:
        self._estimates = 0
        self._failures = 0
        self._bodies = 0
        self._latencies: list[float] = []
        self._stages: dict[str, list[float]] = {}

    def _append(self, values: list[float], value: float) -> None:
        values.append(value)
        del values[: -self._capacity]
