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

"""Interpolation between two samples in time."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

# The angle between quaternions below which a line is as good as an arc, and has no division by 0.
_SMALL_ANGLE = 1e-6

STAMP_TOLERANCE = 5_000_000
"""Stamps that differ by no more are the same moment, nanoseconds.

Times that were rounded to floats or milliseconds, and frame rates that were, are so far off. It is
less than half of the time between two images of a camera with 90 Hz.
"""


class Bracket(NamedTuple):
    """The samples before and after a moment, and the fraction of the way between them."""

    before: int
    after: int
    fraction: float


def bracket(
    stamps: Sequence[int] | NDArray[np.int64], moment: int, longest_gap: int
) -> Bracket | None:
    """Return the samples around `moment`, or None if there are none near enough.

    At the ends and at the edges of a longer gap, a sample within STAMP_TOLERANCE is enough.

    Args:
        stamps: nanoseconds, ascending.
        moment: nanoseconds.
        longest_gap: the longest time between two samples that is interpolated, nanoseconds.
    """
    after = int(np.searchsorted(stamps, moment, 'left'))
    if after < len(stamps) and int(stamps[after]) == moment:
        return Bracket(after, after, 0.0)
    if after not in {0, len(stamps)}:
        start, end = int(stamps[after - 1]), int(stamps[after])
        if end - start <= longest_gap:
            return Bracket(after - 1, after, (moment - start) / (end - start))
    held = nearest(stamps, moment)
    if held is None or abs(int(stamps[held]) - moment) > STAMP_TOLERANCE:
        return None
    return Bracket(held, held, 0.0)


def nearest(stamps: Sequence[int] | NDArray[np.int64], moment: int) -> int | None:
    """Return the index of the stamp that is nearest to `moment`; None if there are no stamps.

    Args:
        stamps: nanoseconds, ascending.
        moment: nanoseconds.
    """
    after = int(np.searchsorted(stamps, moment, 'left'))
    around = [index for index in (after - 1, after) if 0 <= index < len(stamps)]
    return min(around, key=lambda index: abs(int(stamps[index]) - moment), default=None)


def between(
    values: NDArray[np.float64] | Sequence[NDArray[np.float64]], place: Bracket
) -> NDArray[np.float64]:
    """Return the values at `place` on the line between two samples; NaN if one is NaN."""
    if place.before == place.after:
        return np.asarray(values[place.before])
    first, second = np.asarray(values[place.before]), np.asarray(values[place.after])
    return np.asarray(first + (second - first) * place.fraction)


def slerp(
    first: NDArray[np.float64], second: NDArray[np.float64], fraction: float
) -> NDArray[np.float64]:
    """Return the unit quaternion on the shorter arc between two (Shoemake 1985), shape (4,)."""
    cosine = float(first @ second)
    if cosine < 0:
        second, cosine = -second, -cosine
    angle = np.arccos(min(cosine, 1.0))
    if angle < _SMALL_ANGLE:
        mixed = first + (second - first) * fraction
    else:
        mixed = np.sin((1 - fraction) * angle) * first + np.sin(fraction * angle) * second
    return np.asarray(mixed / np.linalg.norm(mixed))
