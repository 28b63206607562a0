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

"""The numbers that labels can have, and the refusal of files with others."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.stamps import NANOSECONDS

LATEST = (1 << 31) * NANOSECONDS - 1
"""The latest stamp of a ROS message, nanoseconds: `sec` is an int32."""

LARGEST_BODY = 65535
"""The largest number of a body: masks have 16 bits."""

FARTHEST = 1e9
"""No position is farther from the origin of its frame, metres."""


def regular_stamps(path: Path, start: int, count: int, period: float) -> NDArray[np.int64]:
    """Return the stamps of `count` samples, nanoseconds, shape (count,).

    Args:
        path: the file that has the samples; named in errors.
        start: the stamp of the first sample, nanoseconds.
        count: at least 1.
        period: seconds from each sample to the next.

    Raises:
        InputError: the last one is no stamp.
    """
    if not 0 <= period * (count - 1) <= (LATEST - start) / NANOSECONDS:  # NaN, too
        msg = f'{path}: {count} samples with {period:g} s from each to the next end after 2038'
        raise InputError(msg)
    moments = np.rint(np.arange(count) * (period * NANOSECONDS)).astype(np.int64)
    return np.asarray(start + moments)


def known_positions(positions: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return `positions`, metres, with NaN in place of numbers that none can have."""
    return np.where(np.abs(positions) <= FARTHEST, positions, np.nan)


def check_positions(path: Path, positions: NDArray[np.float64]) -> None:
    """Raise InputError if a position in the file `path` cannot be one; NaN is an unknown one."""
    absurd = ~(np.abs(positions) <= FARTHEST) & ~np.isnan(positions)
    if absurd.any():
        value = positions[absurd][0]
        msg = f'{path}: a joint is at {value:.3g} m; give the metres per unit with --scale'
        raise InputError(msg)
