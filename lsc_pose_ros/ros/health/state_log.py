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


"""Logs states when they change, but not with each frame if they change with each frame."""

import time
from collections.abc import Callable

from lsc_pose_ros.ros.health.throttled_log import Logger


class StateLog:
    """Logs the state of each of several things, once until it changes.

    Some changes of a thing are logged at once; after that, one in each period. A state that came
    too soon is logged at the next `update` at which it may be.
    """

    def __init__(
        self,
        logger: Logger,
        period: float = 5.0,
        now: Callable[[], float] = time.monotonic,
        burst: int = 3,
    ) -> None:
        """Start with nothing known.

        Args:
            logger: receives the messages.
            period: if a thing changes often, one change in so many seconds is logged.
            now: the clock, seconds.
            burst: so many changes of a thing are logged at once, even if they are close together.
        """
        self._logger = logger
        self._period = period
        self._now = now
        self._burst = burst
        # The text that was logged last, and how many more changes could be logged then, and when.
        self._logged: dict[str, tuple[str, float, float]] = {}

    def update(self, name: str, text: str) -> None:
        """Log `text`, the state of `name`, if it is another than the one that was logged last."""
        now = self._now()
        before, left, last = self._logged.get(name, ('', float(self._burst), now))
        left = min(left + (now - last) / self._period, self._burst)
        if text != before and left >= 1:
            self._logged[name] = text, left - 1, now
            self._logger.info(text)
