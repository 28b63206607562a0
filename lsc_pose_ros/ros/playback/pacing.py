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

"""Waits until a recorded message is to be published."""

import time
from collections.abc import Callable, Iterator

# A wait is cut into pieces of this length, seconds, so that it can be interrupted.
_SLICE = 0.02


class Pacer:
    """Turns recorded times into waits, so that errors do not accumulate.

    The first message is published immediately. Each other message follows after the time that
    passed between the two in the recording, divided by the rate; immediately if it is late.
    """

    def __init__(
        self,
        rate: float,
        now: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Start before the first message.

        Args:
            rate: recorded seconds per real second.
            now: the clock, seconds.
            sleep: waits for some seconds.
        """
        self._rate = rate
        self._now = now
        self._sleep = sleep
        self._start: tuple[float, int] | None = None

    def wait_until(self, log_time: int) -> Iterator[int]:
        """Wait until a message is to be published; meanwhile yield the current recorded time.

        Args:
            log_time: when the message was recorded, nanoseconds.

        Yields:
            the recorded time in nanoseconds, many times per second, and `log_time` at the end.
        """
        if self._start is None:
            self._start = (self._now(), log_time)
        began, first = self._start
        due = began + (log_time - first) * 1e-9 / self._rate
        while (left := due - self._now()) > 0:
            yield log_time - round(left * self._rate * 1e9)
            self._sleep(min(left, _SLICE))
        yield log_time
