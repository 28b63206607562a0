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

# ruff: noqa: INP001 - a program, not a package
"""What a running process takes of the machine, as Linux tells it."""

import os
import re
import time
from pathlib import Path
from typing import NamedTuple

_TICKS = os.sysconf('SC_CLK_TCK')
_STATE_FIELD, _USER_TICKS_FIELD = 3, 14  # counted from 1, as proc(5) does


class Usage(NamedTuple):
    """A reading.

    Attributes:
        time: when it was taken, nanoseconds since 1970.
        processor: how long all threads together have run so far, seconds.
        resident: memory in use, bytes; the parts of shared segments that were touched are in it.
        private: what of that no other process can share and no file backs, bytes.
    """

    time: int
    processor: float
    resident: int
    private: int


def read_usage(pid: int) -> Usage:
    """Return what the process `pid` takes.

    Raises:
        OSError: there is no such process.
    """
    folder = Path(f'/proc/{pid}')
    # The name of the program, in parentheses, may hold blanks.
    fields = (folder / 'stat').read_text(encoding='utf-8').rpartition(')')[2].split()
    first = _USER_TICKS_FIELD - _STATE_FIELD
    ticks = sum(map(int, fields[first : first + 2]))
    memory = (folder / 'smaps_rollup').read_text(encoding='utf-8')
    return Usage(
        time.time_ns(), ticks / _TICKS, _bytes(memory, 'Rss'), _bytes(memory, 'Anonymous')
    )


def _bytes(memory: str, name: str) -> int:
    found = re.search(rf'^{name}: +(\d+) kB$', memory, re.MULTILINE)
    return 1024 * int(found[1]) if found else 0
