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

"""Logs problems that last: at once, and again after longer and longer times."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from lsc_pose_ros.ros.health.throttled_log import Logger

FIRST_REMINDER = 30.0
"""Seconds after which a problem that lasts is logged again; each next time is twice as long."""

LONGEST_TIME = 3600.0
"""Seconds, the longest time between two messages about a problem that lasts."""

# A problem that was absent for these seconds is a new one when it returns.
_MEMORY = 60.0


@dataclass
class _Problem:
    """When a problem was found last, when it is logged next, and the time after that."""

    found: float
    next_message: float
    interval: float


class Reminders:
    """Logs each problem when it is new, and then after 30 s, 1 min, 2 min and so on."""

    def __init__(self, logger: Logger, now: Callable[[], float] = time.monotonic) -> None:
        """Make a log without a history.

        Args:
            logger: receives the messages.
            now: the clock, seconds.
        """
        self._logger = logger
        self._now = now
        self._problems: dict[str, _Problem] = {}

    def update(self, problems: Mapping[str, str]) -> None:
        """Log the problems that are new, or that have lasted until their next message.

        Args:
            problems: the kind of each problem that was found now, and the message.
        """
        now = self._now()
        for kind, text in problems.items():
            problem = self._problems.setdefault(kind, _Problem(now, now, FIRST_REMINDER))
            problem.found = now
            if now >= problem.next_message:
                self._logger.warning(text)
                problem.next_message = now + problem.interval
                problem.interval = min(2 * problem.interval, LONGEST_TIME)
        self._problems = {
            kind: problem
            for kind, problem in self._problems.items()
            if now - problem.found < _MEMORY
        }

    def forget(self, kind: str) -> bool:
        """Forget a problem that has ended; return whether it was logged."""
        return self._problems.pop(kind, None) is not None
