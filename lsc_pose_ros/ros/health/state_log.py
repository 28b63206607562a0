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
    """Logs the state of each of several things, once until it changes."""

    def __init__(
        self, logger: Logger, period: float = 5.0, now: Callable[[], float] = time.monotonic
    ) -> None:
        """Start with nothing known.

        Args:
            logger: receives the messages.
            period: the state of a thing is logged at most once in so many seconds; if it changes
                more often, it is logged at the next `update` after that time.
            now: the clock, seconds.
        """
        self._logger = logger
        self._period = period
        self._now = now
        self._logged: dict[str, tuple[str, float]] = {}

    def update(self, name: str, text: str) -> None:
        """Log `text`, the state of `name`, if it is another than the one that was logged last."""
        before, last = self._logged.get(name, ('', -float('inf')))
        now = self._now()
        if text != before and now - last >= self._period:
            self._logged[name] = text, now
            self._logger.info(text)
