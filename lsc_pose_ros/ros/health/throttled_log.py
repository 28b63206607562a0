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

"""Logs each kind of problem at most once in a period."""

import threading
import time
import traceback
from collections.abc import Callable
from typing import Protocol

from lsc_pose_ros.errors import cut

# A kind of problem is forgotten after these seconds, which are longer than any period.
_MEMORY = 600.0


class Logger(Protocol):
    """The part of rclpy's logger that is used here."""

    def info(self, message: str) -> object:
        """Log an information."""

    def warning(self, message: str) -> object:
        """Log a warning."""

    def error(self, message: str) -> object:
        """Log an error."""


class ThrottledLog:
    """Limits log messages that would otherwise repeat with each frame.

    rclpy throttles by the line of code that logs. Here the kind of problem decides, so that a bad
    mask does not hide a bad depth image. It may be used from any thread.
    """

    def __init__(
        self, logger: Logger, period: float = 5.0, now: Callable[[], float] = time.monotonic
    ) -> None:
        """Make a log without a history.

        Args:
            logger: receives the messages.
            period: each kind of problem is logged once in so many seconds.
            now: the clock, seconds.
        """
        self._logger = logger
        self._period = period
        self._now = now
        self._lock = threading.Lock()
        self._last: dict[str, float] = {}
        self._withheld: dict[str, int] = {}

    def warning(self, kind: str, text: str) -> None:
        """Log `text` as a warning unless one of the same `kind` was logged just before."""
        message = self._admit(kind, text)
        if message is not None:
            self._logger.warning(message)

    def error(self, kind: str, text: str) -> None:
        """Log `text` as an error unless one of the same `kind` was logged just before."""
        message = self._admit(kind, text)
        if message is not None:
            self._logger.error(message)

    def _admit(self, kind: str, text: str) -> str | None:
        with self._lock:
            now = self._now()
            if now - self._last.get(kind, -float('inf')) < self._period:
                self._withheld[kind] = self._withheld.get(kind, 0) + 1
                return None
            self._last[kind] = now
            withheld = self._withheld.pop(kind, 0)
            self._forget(now)
        text = cut(text)
        return f'{text} ({withheld} more like this since the last report)' if withheld else text

    def _forget(self, now: float) -> None:
        """Remove old kinds; some names contain a number that differs each time."""
        for kind in [kind for kind, last in self._last.items() if now - last > _MEMORY]:
            del self._last[kind]
            self._withheld.pop(kind, None)


def kind_of(error: BaseException) -> str:
    """Return the kind of problem that `error` reports: its type and the way to it in the code.

    Its text may be different for each frame. A bad mask and a bad depth image are two kinds,
    because they are read in different places.
    """
    places = [
        f'{frame.f_code.co_filename}:{line}'
        for frame, line in traceback.walk_tb(error.__traceback__)
    ]
    cause = kind_of(error.__cause__) if error.__cause__ else ''
    return ' '.join([type(error).__name__, *places, cause])
