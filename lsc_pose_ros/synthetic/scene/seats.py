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

"""Seats under people who sit, tables before them, and beds under people who lie."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.arrangement import Arrangement
from lsc_pose_ros.synthetic.scene.furniture.seating import SEATS, SeatSize, berth, stool
from lsc_pose_ros.synthetic.scene.furniture.tables import desk, sample_table, table
from lsc_pose_ros.synthetic.scene.occupant import SEAT, TRUNK, Occupant, unit
from lsc_pose_ros.synthetic.scene.piece import Piece, front_axes

CONTACT = -0.025
"""Gap between a seat and the person on it, metres: flesh and cushions give way."""

_PRESSED = 0.01  # how far a person sinks into the seat, metres
_TRIES = 10
_LEAST_DEPTH = 0.12  # of a seat, metres
_BACK_REACH = 0.5  # height above the seat up to which the trunk stays before the back, metres
_TABLE_GAP = (0.0, 0.3)  # distance from the first clear position of a table, metres
_FROM_TRUNK = 0.12  # of the search for that position, metres


def seat_under(occupant: Occupant, arrangement: Arrangement, stream: RandomStream) -> Piece | None:
    """Return a seat that touches thighs and buttocks of a person who sits, or None.

    Args:
        occupant: the person.
        arrangement: the room and all people.
        stream: the source of randomness.
    """
    shape = _SittingShape.of(occupant, arrangement.floor)
    for attempt in range(_TRIES):
        # Small seats fit more often, below hands that hang down and feet that are drawn back.
        small = attempt / _TRIES
        make, back = stream.choose(SEATS), stream.between(0.3, 0.65)
        width = stream.between(0.32, 0.52 - 0.2 * small)
        reach = stream.between(0.4, 0.9 - 0.4 * small)
        gap = stream.between(0.0, 0.08)
        size, ahead = shape.seat(width, reach, gap, back if stream.bernoulli(0.9) else 0.0)
        piece = make(size, stream).placed(shape.position(ahead), occupant.front())
        if arrangement.clear(piece, CONTACT):
            return piece
    size, ahead = shape.seat(0.24, 0.4, 0.0, 0.0)
    piece = stool(size, stream).placed(shape.position(ahead), occupant.front())
    return piece if arrangement.clear(piece, CONTACT) else None


def berth_under(
    occupant: Occupant, arrangement: Arrangement, stream: RandomStream
) -> Piece | None:
    """Return a bed or sofa under a person who lies above the floor, or None."""
    front = unit((occupant.joint('pelvis') - occupant.joint('head'))[[0, 2]])
    axes = front_axes(front)
    pelvis = occupant.joint('pelvis')
    origin = np.array([pelvis[0], arrangement.floor, pelvis[2]])
    local = ((occupant.points - origin) @ axes).reshape(-1, 3)
    low, high = local.min(axis=0), local.max(axis=0)
    top = float(low[1]) + _PRESSED
    for _ in range(_TRIES):
        wide, long = high[0] - low[0] + stream.between(0.02, 0.5), high[2] - low[2] + 0.1
        middle = 0.5 * (low + high)
        spot = origin + middle[0] * axes[:, 0] + middle[2] * axes[:, 2]
        piece = berth(float(wide), float(long), top, stream).placed(spot, front)
        if arrangement.clear(piece, CONTACT):
            return piece
    return None


def table_before(
    occupant: Occupant, arrangement: Arrangement, stream: RandomStream
) -> Piece | None:
    """Return a table or desk before a person who sits, thighs below its plate, or None."""
    size = sample_table(stream)
    size = size._replace(
        height=max(size.height, stream.between(0.62, 0.78)), depth=min(size.depth, 0.8)
    )
    piece = (desk if stream.bernoulli(0.5) else table)(size, stream)
    front = occupant.front()
    start = occupant.joint('pelvis')[[0, 2]] + (_FROM_TRUNK + 0.5 * size.depth) * front
    start = start + stream.between(-0.25, 0.25) * size.width * np.array([front[1], -front[0]])
    return arrangement.slid(piece, start, front, -front, stream.between(*_TABLE_GAP))


class _SittingShape(NamedTuple):
    """The skin of a person who sits, in all frames: x to the left, y up, z to the front.

    Attributes:
        axes: these axes in the level frame, in columns, shape (3, 3).
        origin: the point on the floor below the pelvis, in the level frame, shape (3,).
        bottom: buttocks and thighs, shape (M, 3).
        trunk: the trunk, shape (N, 3).
        knee: mean z of the knees.
    """

    axes: NDArray[np.float64]
    origin: NDArray[np.float64]
    bottom: NDArray[np.float64]
    trunk: NDArray[np.float64]
    knee: float

    @classmethod
    def of(cls, occupant: Occupant, floor: float) -> '_SittingShape':
        """Return the shape of `occupant`, who sits above the floor at y = `floor`."""
        axes = front_axes(occupant.front())
        pelvis = occupant.joint('pelvis')
        origin = np.array([pelvis[0], floor, pelvis[2]])
        bottom, trunk = (
            ((occupant.points[:, occupant.regions == region] - origin) @ axes).reshape(-1, 3)
            for region in (SEAT, TRUNK)
        )
        knees = 0.5 * (occupant.joint('l_knee') + occupant.joint('r_knee'))
        return cls(axes, origin, bottom, trunk, float((knees - origin) @ axes[:, 2]))

    def seat(self, width: float, reach: float, gap: float, back: float) -> tuple[SeatSize, float]:
        """Return the size of a seat and the z of its middle.

        Args:
            width: of the seat, metres.
            reach: position of its front edge, from 0 at the buttocks to 1 at the knees.
            gap: between trunk and back, metres.
            back: height of the back, metres; 0 if it has none.
        """
        hind = float(self.bottom[:, 2].min())
        front = hind + max(reach * (self.knee - hind), _LEAST_DEPTH)
        borne = self.bottom[
            (self.bottom[:, 2] <= front) & (np.abs(self.bottom[:, 0]) <= 0.5 * width)
        ]
        height = float(borne[:, 1].min()) + _PRESSED
        if back:
            low = self.trunk[self.trunk[:, 1] < height + _BACK_REACH]
            hind = min(hind, float(low[:, 2].min()) if len(low) else hind) - gap
        return SeatSize(width, front - hind, height, back), 0.5 * (front + hind)

    def position(self, ahead: float) -> NDArray[np.float64]:
        """Return the point on the floor at a z, in the level frame, shape (3,)."""
        return self.origin + ahead * self.axes[:, 2]
