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

"""Describes the computer, the software and the day of a training or a measurement."""

import os
import platform
from datetime import datetime, timezone
from pathlib import Path

import numba
import numpy as np

from lsc_pose_ros import __version__

_PROCESSORS = Path('/proc/cpuinfo')


def describe_machine() -> dict[str, object]:
    """Return the model of the processor, the number of cores, and the architecture."""
    return {
        'processor': _processor(),
        'cores': os.cpu_count() or 1,
        'architecture': platform.machine(),
    }


def versions() -> dict[str, str]:
    """Return the versions of the software that influences the speed of the kernels."""
    return {
        'lsc_pose_ros': __version__,
        'python': platform.python_version(),
        'numpy': np.__version__,
        'numba': numba.__version__,
    }


def utc_date() -> str:
    """Return the time in UTC as ISO 8601: now, or that of the variable SOURCE_DATE_EPOCH.

    With this variable (reproducible-builds.org), the same work makes the same file again.
    """
    seconds = os.environ.get('SOURCE_DATE_EPOCH', '')
    given = int(seconds) if seconds.isdecimal() else None
    moment = (
        datetime.now(timezone.utc)
        if given is None
        else datetime.fromtimestamp(given, timezone.utc)
    )
    return moment.isoformat(timespec='seconds')


def _processor() -> str:
    try:
        lines = _PROCESSORS.read_text(encoding='utf-8', errors='replace').splitlines()
    except OSError:  # this file exists only on Linux
        lines = []
    for line in lines:
        name, _, value = line.partition(':')
        if name.strip() == 'model name':
            return value.strip()
    return platform.processor() or 'unknown processor'
