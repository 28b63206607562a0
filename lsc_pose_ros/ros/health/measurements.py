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

"""How fast the answers come: rates, latencies, and the time that each stage takes; no ROS here."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

# Where a stamp lies further back, the camera's clock is not the node's: an old recording, say.
LONGEST_LATENCY = 10.0

# How far a stamp may lie ahead of the node's clock: two clocks agree no better, seconds.
_CLOCK_ERROR = 0.05


class Measurements(NamedTuple):
    """What was measured in one stretch of time.

    Attributes:
        answers: how many frames were answered.
        failures: how many could not be.
        bodies: how many bodies the last answer has.
        latencies: seconds from stamp to publication, of those where the clocks are comparable.
        stages: for each stage the seconds that it took, frame by frame.
    """

    answers: int
    failures: int
    bodies: int
    latencies: list[float]
    stages: dict[str, list[float]]


class Measuring:
    """Collects measurements in the worker's thread, for another thread to take away.

    What is not taken away is bounded: of a stretch without end, the last values are kept.
    """

    def __init__(self, now: Callable[[], float] = time.perf_counter, capacity: int = 1000) -> None:
        """Begin with nothing.

        Args:
            now: the clock for the stages, seconds.
            capacity: how many values of a kind are kept.
        """
        self._now = now
        self._capacity = capacity
        self._lock = threading.Lock()
        self._clear()

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Measure how long what is done inside takes, as one frame's time for the stage `name`."""
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

    def answered(self, bodies: int, latency: float) -> None:
        """Count an answer.

        Args:
            bodies: how many bodies it has.
            latency: seconds from the depth image's stamp to now, both in the node's clock.
        """
        with self._lock:
            self._answers += 1
            self._bodies = bodies
            if -_CLOCK_ERROR <= latency <= LONGEST_LATENCY:
                self._append(self._latencies, max(latency, 0.0))

    def failed(self) -> None:
        """Count a frame that could not be answered."""
        with self._lock:
            self._failures += 1

    def take(self) -> Measurements:
        """Return what was measured since the last time, and begin anew."""
        with self._lock:
            taken = Measurements(
                self._answers, self._failures, self._bodies, self._latencies, self._stages
            )
            self._clear()
        return taken

    def _clear(self) -> None:
        self._answers = 0
        self._failures = 0
        self._bodies = 0
        self._latencies: list[float] = []
        self._stages: dict[str, list[float]] = {}

    def _append(self, values: list[float], value: float) -> None:
        values.append(value)
        del values[: -self._capacity]
