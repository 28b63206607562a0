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

"""How regularly stamps come, and how many are missing between them; no ROS in here."""

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

# Steps from stamp to stamp are judged by so many at a time, together with those before them.
_BLOCK = 20
_REMEMBERED = 60

# A stream's rate may change after any so many steps; fewer than this say nothing.
_CHANGES = 5

# By so much, in natural logarithms, a change of the rate must explain the steps better.
_CHANGE = 5.0

# Stamps are not taken to be more regular than this share of their mean step.
_LEAST_SPREAD = 0.05

# What the period may be, as shares of the mean step: where 9 of 10 frames are lost, 0.1.
_PERIODS = np.geomspace(0.1, 1.0, 32)

# A pause this long is one: somebody stopped the camera. Nanoseconds.
_PAUSE = 2_000_000_000

_Steps = npt.NDArray[np.float64]


class FrameLoss:
    """Finds the period of a stream from its stamps, and counts the frames that must be missing.

    Two explanations of the steps compete, by their likelihood: stamps that jitter about an even
    pace, where short steps make up for long ones and none is missing; and steps of whole periods,
    those of more than one with frames missing.

    Attributes:
        missing: how many frames are missing.
    """

    def __init__(self) -> None:
        """Start with nothing."""
        self.missing = 0
        self._last: int | None = None
        self._steps: deque[int] = deque(maxlen=_REMEMBERED)
        self._new = 0
        self._surplus = 0.0

    def add(self, stamp: int) -> None:
        """Take the next stamp, nanoseconds, newer than all before."""
        if self._last is not None and stamp - self._last < _PAUSE:
            self._steps.append(stamp - self._last)
            self._new += 1
        self._last = stamp
        if self._new == _BLOCK:
            self._count()
            self._new = 0

    def restart(self) -> None:
        """Forget the stamps, for the next one does not follow them."""
        self._last = None
        self._forget_until(len(self._steps))
        self._new = 0

    def _count(self) -> None:
        """Count what is missing in the newest steps."""
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
    """What steps are taken for.

    Attributes:
        cost: the negative logarithm of their likelihood, but for a constant a step.
        period: nanoseconds from frame to frame; None where no frame is missing.
    """

    cost: float
    period: float | None


def _newest_change(steps: Sequence[int]) -> int:
    """Return the index of the step at which the rate changed last; 0 if it did not."""
    values = np.array(steps, float)
    costs = {0: _explain(values).cost}
    earliest = max(len(values) - 2 * _BLOCK, _CHANGES)
    for index in range(earliest, len(values) - _CHANGES + 1, _CHANGES):
        costs[index] = _explain(values[:index]).cost + _explain(values[index:]).cost + _CHANGE
    return min(costs, key=lambda index: costs[index])


def _explain(steps: _Steps) -> _Explanation:
    """Return the likelier explanation of steps, nanoseconds."""
    mean = float(steps.mean())
    relative = steps / mean
    jitter = len(steps) * np.log(max(_deviation_from_even(relative), _LEAST_SPREAD))
    lossy, period = _whole_periods(relative)
    scale = len(steps) * np.log(mean)
    if jitter <= lossy:
        return _Explanation(float(jitter + scale), None)
    return _Explanation(lossy + scale, None if period is None else period * mean)


def _deviation_from_even(steps: _Steps) -> float:
    """Return the standard deviation of stamps from an even pace, in mean steps."""
    stamps = np.concatenate(([0.0], np.cumsum(steps)))
    stamps -= stamps.mean()
    numbers = np.arange(len(stamps)) - len(steps) / 2
    slope = (numbers @ stamps) / (numbers @ numbers)
    return float(np.std(stamps - slope * numbers))


def _whole_periods(steps: _Steps) -> tuple[float, float | None]:
    """Return the cost of steps as whole periods, and the period, None if all are of one.

    Numbers of periods are geometrically distributed, as they are where each frame is lost with
    the same probability, and a normal deviation comes on top.
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
