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

"""The time between labels and depth images, by comparison with a model's estimates."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

MOST_FRAMES = 6
"""The largest lag that is looked for, frames."""

# Differences beyond this are errors of the model, and count no more; metres.
_LARGEST = 0.25

# Joints that move less in one frame tell nothing about time, metres.
_LEAST_MOTION = 0.004

# So many moving joints are needed for a result.
_FEWEST = 100

# The differences must shrink by this fraction for a lag to be believed.
_LEAST_GAIN = 0.04


class LabelledSequence(NamedTuple):
    """One body in T successive depth images.

    Attributes:
        stamps: nanoseconds, shape (T,).
        labels: metres, NaN if unknown, shape (T, J, 3).
        estimates: of the model, likewise.
    """

    stamps: NDArray[np.int64]
    labels: NDArray[np.float64]
    estimates: NDArray[np.float64]


class Lag(NamedTuple):
    """The time by which labels must be shifted to fit the depth images.

    Attributes:
        frames: positive if the labels are early: depth image k shows label k - frames. Between
            whole frames, the minimum of a parabola.
        seconds: the same.
        gain: the fraction by which the shift reduces the differences to the estimates.
    """

    frames: float
    seconds: float
    gain: float

    @property
    def found(self) -> bool:
        """Whether the labels are shifted by half a frame or more, as far as can be told."""
        return abs(self.frames) >= 0.5 and self.gain >= _LEAST_GAIN


def find_lag(sequences: Sequence[LabelledSequence]) -> Lag | None:
    """Return the lag of labels, or None if too little moves to tell.

    For each shift, the differences between label and estimate are taken for the joints that move,
    without the median difference of each joint, because label and model can have other anatomies.
    The shift with the smallest mean difference is that of the labels.
    """
    shifts = np.arange(-MOST_FRAMES, MOST_FRAMES + 1)
    parts = [_shifted(sequence, shifts) for sequence in sequences]
    parts = [part for part in parts if part.shape[1]]
    if not parts:
        return None
    differences = np.concatenate(parts, axis=1)  # (S, n, J, 3)
    known = np.asarray(np.isfinite(differences).all(axis=(0, 3)))
    if known.sum() < _FEWEST:
        return None
    differences = np.where(known[None, :, :, None], differences, np.nan)
    used = np.asarray(known.any(axis=0))
    differences = differences[:, :, used]
    differences -= np.nanmedian(differences, axis=1, keepdims=True)
    errors = np.minimum(np.linalg.norm(differences, axis=-1), _LARGEST)
    means = np.nanmean(errors, axis=(1, 2))
    frames = _minimum(shifts, means)
    steps = np.concatenate([np.diff(sequence.stamps) for sequence in sequences])
    gain = 1 - float(means.min() / means[MOST_FRAMES])
    return Lag(frames, frames * float(np.median(steps)) * 1e-9, gain)


def _shifted(sequence: LabelledSequence, shifts: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return label minus estimate for each shift, NaN where nothing moves, shape (S, n, J, 3)."""
    count = len(sequence.stamps)
    middle = np.arange(MOST_FRAMES, count - MOST_FRAMES)
    empty = np.zeros((len(shifts), 0, *sequence.labels.shape[1:]))
    if not len(middle):
        return empty
    motion = np.linalg.norm(np.diff(sequence.estimates, axis=0), axis=-1)
    moving = np.zeros(sequence.estimates.shape[:2], bool)
    moving[1:] |= motion > _LEAST_MOTION
    estimates = np.where(moving[middle][..., None], sequence.estimates[middle], np.nan)
    return np.stack([sequence.labels[middle - shift] - estimates for shift in shifts])


def _minimum(shifts: NDArray[np.int64], means: NDArray[np.float64]) -> float:
    """Return where a parabola through the smallest mean and its neighbours is smallest."""
    best = int(means.argmin())
    if best in {0, len(means) - 1}:
        return float(shifts[best])
    before, at, after = means[best - 1 : best + 2]
    curvature = before - 2 * at + after
    shift = 0.5 * (before - after) / curvature if curvature > 0 else 0.0
    return float(shifts[best] + shift)
