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

"""How a body moves between two observations: at a constant velocity, and how far off it may be."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.tracking.surfaces import Surface

ERROR = 0.14
"""The standard deviation of a body's place between two frames, metres."""

SPREAD = 0.6
"""It grows by so much in a second in which the body is not seen, metres."""

PART_ERROR = 0.25
"""The standard deviation of the middle of a body of which hardly anything is visible, metres."""

HEIGHT_WEIGHT = 0.3
"""A difference in height counts so much, because half of a body may be hidden."""

LARGEST_COST = 13.0
"""A body that is less likely to be the same is another one."""

LARGEST_GAP = 1.5
"""A body that is farther away after any time is another one, metres."""

SETTLING_SECONDS = 0.3
"""The velocity is the mean over about so long."""

FADING_SECONDS = 1.0
"""The velocity of a body that is not seen fades in this time, t0."""

FASTEST = 3.0
"""No body is expected to move faster, metres per second."""

AREA_SECONDS = 5.0
"""The largest visible area is forgotten in about so long."""

_SECOND_NS = 1_000_000_000


class Movement(NamedTuple):
    """Where a body was last seen, and how it moves.

    Attributes:
        stamp: when it was last seen, nanoseconds.
        place: of its visible surface then, metres, shape (3,).
        velocity: metres per second, shape (3,).
        area: the largest visible area of the last seconds, square metres.
        hidden: the fraction of this area that was not visible when the body was last seen.
    """

    stamp: int
    place: NDArray[np.float64]
    velocity: NDArray[np.float64]
    area: float
    hidden: float

    def step(self, stamp: int) -> NDArray[np.float64]:
        """Return how far the body has moved until `stamp`, metres, shape (3,).

        The velocity fades, because nobody walks straight on for long: v t0 (1 - exp(-t / t0)).
        """
        seconds = max(stamp - self.stamp, 0) / _SECOND_NS
        return self.velocity * float(FADING_SECONDS * (1 - np.exp(-seconds / FADING_SECONDS)))

    def cost(self, stamp: int, surface: Surface) -> float:
        """Return the cost of `surface` being that of this body; infinity if it cannot be.

        It is d^2 / (s^2 + p^2) + 6 ln(s / s0), as minus twice the logarithm of a normal density.
        d is the distance from where the body is expected. s grows with the time: what was seen a
        moment ago is known better than what was not seen for long. p is for the parts that are
        hidden, now or before: the middle of what is visible may be a hand.
        """
        off = (surface.place - self.place - self.step(stamp)) * (1, HEIGHT_WEIGHT, 1)
        distance = float(np.sqrt((off * off).sum()))
        error = ERROR + SPREAD * max(stamp - self.stamp, 0) / _SECOND_NS
        part = PART_ERROR**2 * (self.hidden + hidden_fraction(surface.area, self.area))
        cost = distance**2 / (error**2 + part) + 6 * float(np.log(error / ERROR))
        return cost if distance <= LARGEST_GAP and cost < LARGEST_COST else float('inf')

    def seen(self, stamp: int, surface: Surface) -> 'Movement':
        """Return the movement after the body was seen again.

        The less of the body is visible, the less its velocity changes: the middle of what is
        visible moves because the body moves, or because something covers it.
        """
        seconds = (stamp - self.stamp) / _SECOND_NS
        if seconds <= 0:
            return self
        area = max(surface.area, self.area * float(np.exp(-seconds / AREA_SECONDS)))
        hidden = hidden_fraction(surface.area, area)
        gain = (1 - hidden) * (1 - np.exp(-seconds / SETTLING_SECONDS))
        velocity = self.velocity + gain * ((surface.place - self.place) / seconds - self.velocity)
        speed = float(np.sqrt((velocity * velocity).sum()))
        velocity = velocity * min(1.0, FASTEST / max(speed, 1e-9))
        return Movement(stamp, surface.place, velocity, area, hidden)


def at_rest(stamp: int, surface: Surface) -> Movement:
    """Return the movement of a body that is seen for the first time."""
    return Movement(stamp, surface.place, np.zeros(3), surface.area, 0.0)


def hidden_fraction(area: float, largest: float) -> float:
    """Return the fraction of a body's largest visible area that is hidden."""
    return max(1 - area / largest, 0.0) if largest > 0 else 0.0
