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

"""Waits for conditions, so that no test depends on how fast or how busy the computer is."""

import time
from collections.abc import Callable

PATIENCE = 600.0
"""Seconds until a test gives up, far more than what it waits for takes on a busy computer."""

COMPILING_PATIENCE = 1800.0
"""The same, if a process that compiles many kernels is waited for."""

_POLL_PERIOD = 0.01


def wait_until(condition: Callable[[], object]) -> bool:
    """Wait until a condition holds, at most `PATIENCE`; return whether it does."""
    return becomes(condition, PATIENCE)


def stays(condition: Callable[[], object], seconds: float = 1.0) -> bool:
    """Return whether a condition holds during all of `seconds`."""
    return not becomes(lambda: not condition(), seconds)


def becomes(condition: Callable[[], object], seconds: float) -> bool:
    """Wait at most `seconds` until a condition holds; return whether it does."""
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            return False
        time.sleep(_POLL_PERIOD)
    return True
