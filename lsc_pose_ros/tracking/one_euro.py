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

"""The One-Euro filter: steady where a joint rests, quick where it moves.

Casiez, Roussel, Vogel: "1 € Filter: a simple speed-based low-pass filter for noisy input in
interactive systems", CHI 2012. Here the filtered values are points in space, so the speed is a
point's own, whatever the direction.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.skeletons import Skeletons

# Cutoff of the low-pass filter over the velocity (the paper's dcutoff), Hz.
VELOCITY_CUTOFF = 1.0

# What was seen longer ago than this says nothing about now, nanoseconds.
MEMORY_NS = 500_000_000

_SECOND_NS = 1_000_000_000


class OneEuroSettings(NamedTuple):
    """How much is smoothed.

    Attributes:
        cutoff: mincutoff, the cutoff frequency for a joint at rest, Hz; less is smoother.
        beta: by how much the cutoff rises with a joint's speed, 1/m; more follows faster.
    """

    cutoff: float
    beta: float


class OneEuroPoints:
    """The filter for the joints of one body, each by itself."""

    def __init__(self, joints: int) -> None:
        """Begin without a past.

        Args:
            joints: how many joints the body has.
        """
        self._points = np.full((joints, 3), np.nan)
        self._velocity = np.zeros((joints, 3))
        self._stamps = np.zeros(joints, np.int64)

    def filter(
        self, stamp: int, points: NDArray[np.float32], settings: OneEuroSettings
    ) -> NDArray[np.float32]:
        """Return the smoothed points, shape (J, 3); algorithm 1 of the paper.

        A joint that is unknown (NaN) stays so, and is smoothed again when it comes back soon. One
        that was away for long begins anew. Where no time has passed since the last point, or
        less than none, there is nothing to smooth by, and the point is returned as it came.

        Args:
            stamp: nanoseconds; the steps between the stamps may differ.
            points: metres, NaN where unknown, shape (J, 3).
            settings: how much is smoothed.
        """
        known = np.isfinite(points).all(axis=1)
        elapsed = stamp - self._stamps
        going_on = known & (elapsed > 0) & (elapsed <= MEMORY_NS)
        going_on &= np.isfinite(self._points).all(axis=1)
        smooth = self._step(going_on, elapsed[going_on] / _SECOND_NS, points, settings)
        # A point whose stamp is not after the last one's must not take its place.
        fresh = known & ~going_on & ((elapsed > 0) | np.isnan(self._points[:, 0]))
        self._points[fresh] = points[fresh]
        self._velocity[fresh] = 0
        self._stamps[going_on | fresh] = stamp
        return smooth

    def _step(
        self,
        which: NDArray[np.bool_],
        seconds: NDArray[np.float64],
        points: NDArray[np.float32],
        settings: OneEuroSettings,
    ) -> NDArray[np.float32]:
        before, velocity = self._points[which], self._velocity[which]
        seconds = seconds[:, None]
        velocity += _weight(seconds, VELOCITY_CUTOFF) * (
            (points[which] - before) / seconds - velocity
        )
        speed = np.linalg.norm(velocity, axis=1, keepdims=True)
        now = before + _weight(seconds, settings.cutoff + settings.beta * speed) * (
            points[which] - before
        )
        self._points[which], self._velocity[which] = now, velocity
        smooth = points.copy()
        smooth[which] = now
        return smooth


class OneEuroBodies:
    """The filter for all bodies, which may come and go."""

    def __init__(self) -> None:
        """Begin without a past."""
        self._bodies: dict[int, OneEuroPoints] = {}
        self._seen: dict[int, int] = {}

    def filter(self, stamp: int, skeletons: Skeletons, settings: OneEuroSettings) -> Skeletons:
        """Return `skeletons` with smoothed positions; all else stays.

        Args:
            stamp: nanoseconds.
            skeletons: the bodies of one frame, each with the number that it had before.
            settings: how much is smoothed.
        """
        for number in [each for each, last in self._seen.items() if stamp - last > MEMORY_NS]:
            del self._bodies[number], self._seen[number]
        positions = np.empty_like(skeletons.positions)
        for row, number in enumerate(skeletons.bodies.tolist()):
            body = self._bodies.setdefault(number, OneEuroPoints(len(skeletons.joints)))
            self._seen[number] = max(stamp, self._seen.get(number, stamp))
            positions[row] = body.filter(stamp, skeletons.positions[row], settings)
        return skeletons._replace(positions=positions)


def _weight(
    seconds: NDArray[np.float64], cutoff: NDArray[np.float64] | float
) -> NDArray[np.float64]:
    """Return the share of the new value in an exponential smoothing (eq. 2 and 3 of the paper)."""
    period = 1 / (2 * np.pi * cutoff)
    weight: NDArray[np.float64] = 1 / (1 + period / seconds)
    return weight
