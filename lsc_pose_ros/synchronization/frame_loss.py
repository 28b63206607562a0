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

"""Estimates the number of lost frames from the stamps of the others."""

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

# Number of steps between stamps in a block, and number of earlier steps that are kept.
_BLOCK = 20
_REMEMBERED = 60

# Resolution of changes of the rate, steps; also the fewest steps before and after a change.
_CHANGES = 5

# The gain in log-likelihood (natural logarithm) that a change of the rate must bring.
_CHANGE = 5.0

# The least standard deviation of the steps, as a fraction of the mean step.
_LEAST_SPREAD = 0.05

# Candidate periods as fractions of the mean step; 0.1 if 9 of 10 frames are lost.
_PERIODS = np.geomspace(0.1, 1.0, 32)

# A longer step is a pause of the camera, not a loss. Nanoseconds.
_PAUSE = 2_000_000_000

_Steps = npt.NDArray[np.float64]


class FrameLoss:
    """Finds the period of a stream from its stamps, and counts the missing frames.

    Two models of the steps are compared by their likelihood: stamps that jitter around a regular
    grid, where short steps compensate for long ones and no frame is missing; and steps of one or
    more whole periods, where frames are missing in the longer ones.

    Attributes:
        missing: the number of missing frames.
    """

    def __init__(self) -> None:
        """Start with no stamps."""
        self.missing = 0
        self._last: int | None = None
        self._steps: deque[int] = deque(maxlen=_REMEMBERED)
        self._new = 0
        self._surplus = 0.0

    def add(self, stamp: int) -> None:
        """Add the next stamp, nanoseconds; it must be newer than all earlier ones."""
        if self._last is not None and stamp - self._last < _PAUSE:
            self._steps.append(stamp - self._last)
            self._new += 1
        self._last = stamp
        if self._new == _BLOCK:
            self._count()
            self._new = 0

    def restart(self) -> None:
        """Forget the stamps, because the next one does not follow them."""
        self._last = None
        self._forget_until(len(self._steps))
        self._new = 0

    def _count(self) -> None:
        """Count the missing frames in the newest steps."""
        change = _newest_change(self._steps)
        self._forget_until(change)
        new = np.array(self._steps)[-_BLOCK:]
        period = _explain(np.array(self._steps, float)).period
        if period is None:
            self._surplus = 0.0
            return
        self._surplus = max(self._surplus, -1.0) + float(new.sum()) / period - len(new)
        found = max(round(self._surplus), 0)
        self.missing += found
        self._surplus -= found

    def _forget_until(self, index: int) -> None:
        for _ in range(index):
            self._steps.popleft()
        if index:
            self._surplus = 0.0


class _Explanation(NamedTuple):
    """A model of the steps.

    Attributes:
        cost: the negative log-likelihood of the steps, up to a constant for each step.
        period: nanoseconds from frame to frame; None if no frame is missing.
    """

    cost: float
    period: float | None


def _newest_change(steps: Sequence[int]) -> int:
    """Return the index of the step at which the rate changed last, 0 if it did not change."""
    values = np.array(steps, float)
    costs = {0: _explain(values).cost}
    earliest = max(len(values) - 2 * _BLOCK, _CHANGES)
    for index in range(earliest, len(values) - _CHANGES + 1, _CHANGES):
        costs[index] = _explain(values[:index]).cost + _explain(values[index:]).cost + _CHANGE
    return min(costs, key=lambda index: costs[index])


def _explain(steps: _Steps) -> _Explanation:
    """Return the more likely model of `steps`, nanoseconds."""
    mean = float(steps.mean())
    relative = steps / mean
    jitter = len(steps) * np.log(max(_deviation_from_even(relative), _LEAST_SPREAD))
    lossy, period = _whole_periods(relative)
    scale = len(steps) * np.log(mean)
    if jitter <= lossy:
        return _Explanation(float(jitter + scale), None)
    return _Explanation(lossy + scale, None if period is None else period * mean)


def _deviation_from_even(steps: _Steps) -> float:
    """Return the standard deviation of the stamps from a regular grid, in mean steps."""
    stamps = np.concatenate(([0.0], np.cumsum(steps)))
    stamps -= stamps.mean()
    numbers = np.arange(len(stamps)) - len(steps) / 2
    slope = (numbers @ stamps) / (numbers @ numbers)
    return float(np.std(stamps - slope * numbers))


def _whole_periods(steps: _Steps) -> tuple[float, float | None]:
    """Return the cost of steps of whole periods, and the period, None if all are of one period.

    The number of periods in a step has a geometric distribution, because each frame is lost with
    the same probability; the deviation from it has a normal distribution.
    """
    periods = _PERIODS[:, None]
    counts = np.maximum(np.rint(steps / periods), 1)
    periods = ((counts * steps).sum(axis=1) / (counts**2).sum(axis=1))[:, None]
    spread = np.maximum(np.std(steps - counts * periods, axis=1), _LEAST_SPREAD)
    mean_count = counts.mean(axis=1)
    excess = mean_count - 1
    surprise = mean_count * np.log(mean_count) - excess * np.log(np.maximum(excess, 1e-12))
    costs = len(steps) * (np.log(spread) + surprise)
    best = int(np.argmin(costs))
    return float(costs[best]), float(periods[best, 0]) if excess[best] > 0 else None
