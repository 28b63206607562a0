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

"""A clock that observes the stages of the method and adds up the time of each."""

import time
from collections.abc import Callable, Sequence

from lsc_pose_ros.pose.stages import STAGE_NAMES


class StageClock:
    """An observer of stages; it charges each stage with the time since the stage before.

    Attributes:
        seconds: the time of each stage so far, in their order.
    """

    def __init__(
        self, names: Sequence[str] = STAGE_NAMES, now: Callable[[], float] = time.perf_counter
    ) -> None:
        """Start the clock.

        Args:
            names: the stages.
            now: returns the current time, seconds.
        """
        self.seconds = dict.fromkeys(names, 0.0)
        self._now = now
        self._last = now()

    def __call__(self, stage: str) -> None:
        """Charge `stage` with the time since the last call."""
        now = self._now()
        self.seconds[stage] += now - self._last
        self._last = now
