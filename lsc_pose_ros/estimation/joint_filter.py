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


"""A Kalman filter of the joints: how far a joint moves to its measurement.

The more certain a joint is, the more the measurement counts: its confidence is the calibrated
probability that it is within 10 cm, so the standard deviation of its error follows from it. The
numbers were fitted on synthetic videos with exact joints (`docs/time.md`).

R. E. Kalman, "A new approach to linear filtering and prediction problems", 1960.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

SURE_ERROR, DOUBTFUL_ERROR = 0.02, 0.17
"""The standard deviation of a joint of confidence 1 and of confidence 0, metres."""

SPEED_ERROR = 1.05
"""The standard deviation of the speed that is expected of a joint, metres per second."""

GATE = 3.0
"""A measurement that is so many standard deviations away is an unexpected movement."""


class FilteredJoints(NamedTuple):
    """The joints of a person.

    Attributes:
        positions: metres, NaN if never known, shape (J, 3), float32.
        variance: of each, square metres, shape (J,).
    """

    positions: NDArray[np.float32]
    variance: NDArray[np.float64]


def measured_joints(
    positions: NDArray[np.float32], confidence: NDArray[np.float32]
) -> FilteredJoints:
    """Return joints of which only this frame is known.

    Args:
        positions: metres, NaN if not estimated, shape (J, 3).
        confidence: of each, 0 to 1, shape (J,).
    """
    error = DOUBTFUL_ERROR + (SURE_ERROR - DOUBTFUL_ERROR) * confidence.astype(np.float64)
    return FilteredJoints(positions, error * error)


def filter_joints(
    expected: FilteredJoints, seconds: float, measured: FilteredJoints
) -> FilteredJoints:
    """Return the joints after a measurement: x + K (z - x) with K = P / (P + R).

    P is the variance of what was expected plus that of the movement since, R that of the
    measurement. Beyond GATE standard deviations P grows by the square of the rest, so that the
    joint follows a sudden movement, but not at once if the measurement is doubtful.

    Args:
        expected: where the joints are expected, and their variance in the frame before.
        seconds: since the frame before.
        measured: of this frame. A joint without a measurement has no position.
    """
    moved = np.linalg.norm((measured.positions - expected.positions).astype(np.float64), axis=1)
    prior = expected.variance + (SPEED_ERROR * seconds) ** 2
    limit = GATE * np.sqrt(prior + measured.variance)
    prior = prior + np.maximum(moved - limit, 0) ** 2
    known = np.isfinite(moved)
    gain = np.where(known, prior / (prior + measured.variance), 1)
    start = np.where(known[:, None], expected.positions, measured.positions)
    positions = start + gain[:, None] * (measured.positions - start)
    variance = np.where(known, (1 - gain) * prior, measured.variance)
    return FilteredJoints(positions.astype(np.float32), variance)
