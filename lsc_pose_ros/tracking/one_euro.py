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

"""The One-Euro filter: smooth if a joint rests, fast if it moves.

Casiez, Roussel, Vogel: "1 € Filter: a simple speed-based low-pass filter for noisy input in
interactive systems", CHI 2012. The filtered values are points in space, so the cutoff depends on
the speed of a point in any direction.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.skeletons import Skeletons

# Cutoff of the low-pass filter over the velocity (the paper's dcutoff), Hz.
VELOCITY_CUTOFF = 1.0

# A joint or body that was not seen for longer than this starts again unfiltered, nanoseconds.
MEMORY_NS = 500_000_000

_SECOND_NS = 1_000_000_000


class OneEuroSettings(NamedTuple):
    """Parameters of the filter.

    Attributes:
        cutoff: mincutoff, the cutoff frequency of a joint at rest, Hz; lower is smoother.
        beta: increase of the cutoff with the speed of a joint, 1/m; higher follows faster.
    """

    cutoff: float
    beta: float


class OneEuroPoints:
    """The filter of the joints of one body; joints are independent."""

    def __init__(self, joints: int) -> None:
        """Start without history.

        Args:
            joints: number of joints.
        """
        self._points = np.full((joints, 3), np.nan)
        self._velocity = np.zeros((joints, 3))
        self._stamps = np.zeros(joints, np.int64)

    def filter(
        self, stamp: int, points: NDArray[np.float32], settings: OneEuroSettings
    ) -> NDArray[np.float32]:
        """Return the smoothed points, shape (J, 3); algorithm 1 of the paper.

        An unknown joint (NaN) stays unknown. Its history continues if it returns within MEMORY_NS,
        otherwise it starts again. A point is returned unfiltered if its stamp is not after that of
        the point before.

        Args:
            stamp: nanoseconds; the intervals may vary.
            points: metres, NaN where unknown, shape (J, 3).
            settings: parameters of the filter.
        """
        known = np.isfinite(points).all(axis=1)
        elapsed = stamp - self._stamps
        continued = known & (elapsed > 0) & (elapsed <= MEMORY_NS)
        continued &= np.isfinite(self._points).all(axis=1)
        smooth = self._step(continued, elapsed[continued] / _SECOND_NS, points, settings)
        # A point with an old stamp must not replace the last point.
        fresh = known & ~continued & ((elapsed > 0) | np.isnan(self._points[:, 0]))
        self._points[fresh] = points[fresh]
        self._velocity[fresh] = 0
        self._stamps[continued | fresh] = stamp
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
    """The filters of all bodies, which may appear and disappear."""

    def __init__(self) -> None:
        """Start without history."""
        self._bodies: dict[int, OneEuroPoints] = {}
        self._seen: dict[int, int] = {}

    def filter(self, stamp: int, skeletons: Skeletons, settings: OneEuroSettings) -> Skeletons:
        """Return `skeletons` with smoothed positions.

        Args:
            stamp: nanoseconds.
            skeletons: the bodies of one frame, with numbers that persist from frame to frame.
            settings: parameters of the filter.
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
    """Return the weight of the new value in exponential smoothing (eq. 2 and 3 of the paper)."""
    period = 1 / (2 * np.pi * cutoff)
    weight: NDArray[np.float64] = 1 / (1 + period / seconds)
    return weight
