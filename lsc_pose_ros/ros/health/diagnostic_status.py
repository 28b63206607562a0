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

"""How the node does, in words and numbers for /diagnostics; no ROS in here."""

from enum import Enum
from typing import NamedTuple

import numpy as np

from lsc_pose_ros.ros.health.measurements import Measurements
from lsc_pose_ros.ros.health.stream_warnings import TOLERATED_SHARE, Counters

# Without a depth image for so long, what is known of the stream is old, seconds.
PATIENCE = 3.0

# So many depth images within a second are no slow camera: answers are due.
_SOME = 3

_UNKNOWN = 'unknown'

# Counters that grow while all is well; a mask may be slower than the depth image, or quicker.
_ORDINARY = frozenset(
    {
        'depth',
        'masks',
        'camera_infos',
        'pairs',
        'unmatched_depth',
        'unmatched_masks',
        'out_of_order',
    }
)

# All others, as a message of trouble names them.
_TROUBLES = {
    'replaced': 'left out for newer ones',
    'lost': 'lost by the middleware',
    'missing': 'missing by their stamps',
    'duplicates': 'with the stamp of another',
    'late': 'too late',
    'rewinds': 'stamps that went back',
}

# Of these, a few happen on any computer.
_TOLERATED = frozenset({'replaced', 'missing'})


class Level(Enum):
    """How serious it is, as diagnostic_msgs/DiagnosticStatus has it."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


class Condition(NamedTuple):
    """What a DiagnosticStatus says.

    Attributes:
        level: how serious it is.
        message: the most serious trouble in a few words.
        values: names with numbers, in the order to show them in.
    """

    level: Level
    message: str
    values: dict[str, str]


class Stretch(NamedTuple):
    """A stretch of time, and what came and went in it.

    Attributes:
        seconds: how long it was.
        quiet: how long ago the last depth image came at its end, seconds.
        before: the counters at its beginning.
        now: the counters at its end.
        measured: what was measured in it.
    """

    seconds: float
    quiet: float
    before: Counters
    now: Counters
    measured: Measurements


def condition(stretch: Stretch) -> Condition:
    """Return how the node did."""
    level, message = _verdict(stretch)
    return Condition(level, message, _values(stretch))


def _verdict(stretch: Stretch) -> tuple[Level, str]:
    measured, gained = stretch.measured, _gained(stretch)
    if stretch.quiet > PATIENCE:
        return Level.STALE, f'no depth image for {stretch.quiet:.0f} s'
    if measured.failures:
        return Level.ERROR, f'{measured.failures} frames could not be answered; the log says why'
    if gained['depth'] >= _SOME and not measured.answers:
        return Level.WARN, 'depth images come, but none can be answered; the log says why'
    tolerated = TOLERATED_SHARE * gained['depth']
    troubles = [
        f'{gained[name]} {words}'
        for name, words in _TROUBLES.items()
        if gained[name] > (tolerated if name in _TOLERATED else 0)
    ]
    if troubles:
        return Level.WARN, f'images: {", ".join(troubles)}'
    return Level.OK, 'answering' if measured.answers else 'waiting'


def _values(stretch: Stretch) -> dict[str, str]:
    measured, seconds = stretch.measured, max(stretch.seconds, 1e-9)
    values = {
        'frames in (Hz)': f'{_gained(stretch)["depth"] / seconds:.1f}',
        'answers out (Hz)': f'{measured.answers / seconds:.1f}',
        'bodies': str(measured.bodies),
        'latency p50 (ms)': _milliseconds(measured.latencies, 50),
        'latency p95 (ms)': _milliseconds(measured.latencies, 95),
    }
    for stage, times in measured.stages.items():
        values[f'{stage} p50 (ms)'] = _milliseconds(times, 50)
        values[f'{stage} p95 (ms)'] = _milliseconds(times, 95)
    # Since the node started, so that whoever looks in later misses nothing.
    values |= {
        name.replace('_', ' '): str(number) for name, number in stretch.now._asdict().items()
    }
    return values


def _gained(stretch: Stretch) -> dict[str, int]:
    before, now = stretch.before._asdict(), stretch.now._asdict()
    return {name: now[name] - before[name] for name in now}


def _milliseconds(seconds: list[float], percentile: float) -> str:
    if not seconds:
        return _UNKNOWN
    return f'{1000 * float(np.percentile(seconds, percentile)):.1f}'
