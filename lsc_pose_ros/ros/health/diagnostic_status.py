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

"""Summarises an interval of the node's work for /diagnostics; does not import ROS."""

from enum import Enum
from typing import NamedTuple

import numpy as np

from lsc_pose_ros.ros.health.measurements import Measurements
from lsc_pose_ros.ros.health.stream_warnings import TOLERATED_FRACTION, Counters

# Without a depth image for more seconds than this, the stream counts as stale.
_STALE_AFTER = 3.0

# With so many depth images in an interval, the camera is not slow: there should be estimates.
_FEW_DEPTH_IMAGES = 3

_UNKNOWN = 'unknown'

# Counters that also grow without any problem; masks may be slower or faster than depth images.
_NORMAL_COUNTERS = frozenset(
    {
        'depth',
        'masks',
        'camera_infos',
        'lost_camera_infos',
        'pairs',
        'unmatched_depth',
        'unmatched_masks',
        'out_of_order',
    }
)

# All other counters, with their words in the message.
_PROBLEM_COUNTERS = {
    'replaced': 'replaced by newer ones',
    'lost': 'lost by the middleware',
    'missing': 'missing by their stamps',
    'duplicates': 'with the stamp of another',
    'late': 'too late',
    'rewinds': 'stamps that went back',
}

# Problems that occur now and then on any computer.
_TOLERATED = frozenset({'replaced', 'missing'})


class Level(Enum):
    """The severity, with the numbers of diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


class Status(NamedTuple):
    """The content of a diagnostic_msgs/DiagnosticStatus.

    Attributes:
        level: the severity.
        message: the most serious problem in a few words.
        values: names and values, in the order in which they are shown.
    """

    level: Level
    message: str
    values: dict[str, str]


class Interval(NamedTuple):
    """What was counted and measured in an interval of time.

    Attributes:
        seconds: its length.
        silence: seconds from the last depth image to the end of the interval.
        before: the counters at its beginning.
        now: the counters at its end.
        measured: the measurements in it.
        notes: names and values that are shown as they are.
    """

    seconds: float
    silence: float
    before: Counters
    now: Counters
    measured: Measurements
    notes: dict[str, str] = {}  # noqa: RUF012 - never changed


def status_of(interval: Interval) -> Status:
    """Return the status of the node in `interval`."""
    level, message = _level_and_message(interval)
    return Status(level, message, _values(interval))


def _level_and_message(interval: Interval) -> tuple[Level, str]:
    measured = interval.measured
    increase = interval.now.since(interval.before)
    if interval.silence > _STALE_AFTER:
        return Level.STALE, f'no depth image for {interval.silence:.0f} s'
    if measured.failures:
        return Level.ERROR, f'{measured.failures} frames could not be estimated; see the log'
    if increase.depth >= _FEW_DEPTH_IMAGES and not measured.estimates:
        return Level.WARN, 'depth images are received, but none can be estimated; see the log'
    problems = _problems(increase)
    if problems:
        return Level.WARN, f'images: {", ".join(problems)}'
    return Level.OK, 'estimating' if measured.estimates else 'waiting'


def _problems(increase: Counters) -> list[str]:
    """Return the problems that occurred more often than is tolerated."""
    tolerated = TOLERATED_FRACTION * increase.depth
    counts = increase._asdict()
    return [
        f'{counts[name]} {words}'
        for name, words in _PROBLEM_COUNTERS.items()
        if counts[name] > (tolerated if name in _TOLERATED else 0)
    ]


def _values(interval: Interval) -> dict[str, str]:
    measured, seconds = interval.measured, max(interval.seconds, 1e-9)
    depth_images = interval.now.depth - interval.before.depth
    values = interval.notes | {
        'frames in (Hz)': f'{depth_images / seconds:.1f}',
        'estimates out (Hz)': f'{measured.estimates / seconds:.1f}',
        'bodies': str(measured.bodies),
        'latency p50 (ms)': _milliseconds(measured.latencies, 50),
        'latency p95 (ms)': _milliseconds(measured.latencies, 95),
    }
    for stage, times in measured.stages.items():
        values[f'{stage} p50 (ms)'] = _milliseconds(times, 50)
        values[f'{stage} p95 (ms)'] = _milliseconds(times, 95)
    # Totals since the node was activated, so that a later reader misses nothing.
    values |= {
        name.replace('_', ' '): str(number) for name, number in interval.now._asdict().items()
    }
    return values


def _milliseconds(seconds: list[float], percentile: float) -> str:
    if not seconds:
        return _UNKNOWN
    return f'{1000 * float(np.percentile(seconds, percentile)):.1f}'
