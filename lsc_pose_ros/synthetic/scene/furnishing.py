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

"""Furnishes a room: seats, pieces in front of people, and everything that stands about."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.arrangement import Arrangement
from lsc_pose_ros.synthetic.scene.furniture import clothing, clutter, seating, storage, tables
from lsc_pose_ros.synthetic.scene.occluders import piece_in_front
from lsc_pose_ros.synthetic.scene.occupant import Occupant
from lsc_pose_ros.synthetic.scene.piece import Piece
from lsc_pose_ros.synthetic.scene.room import Room, sample_close_walls
from lsc_pose_ros.synthetic.scene.seats import berth_under, seat_under, table_before

PIECES = (3, 15)
"""Fewest and most pieces that are tried, not counting seats and what is in front of people."""

IN_FRONT_FRACTION = 0.4
"""Fraction of scenes with a piece right in front of a person."""

_TABLE_FRACTION = 0.4  # of the people on seats
_ARM_FRACTION = 0.12  # of the scenes, with a robot's arm near the camera
_DECK_FRACTION = 0.12  # of the scenes, with the deck of a robot or a table below the camera
_TRIES = 3  # positions per piece
_EMPTY_SPOTS = (1.2, 5.0)  # distances of imagined people in a room without people, metres


class Furnishing(NamedTuple):
    """A room in the level frame at the camera: x right, y down, z away.

    Attributes:
        walls: a room without boxes.
        pieces: the furniture.
        seats: the seat or bed of each person, or None.
    """

    walls: Room
    pieces: list[Piece]
    seats: list[Piece | None]


def furnish(
    occupants: Sequence[Occupant], camera_height: float, view: float, stream: RandomStream
) -> Furnishing:
    """Sample walls and furniture around people.

    Args:
        occupants: the people.
        camera_height: above the floor, metres.
        view: half of the horizontal field of view, radians.
        stream: the source of randomness.
    """
    points = [occupant.points.reshape(-1, 3) for occupant in occupants]
    spots = points or [_imagined_points(camera_height, view, stream)]
    uniforms = np.array([stream.uniform() for _ in range(10)])
    walls = sample_close_walls(np.concatenate(spots), camera_height, uniforms)
    everybody = np.concatenate([np.zeros((0, 3)), *points])
    arrangement = Arrangement(walls, list(occupants), everybody, camera_height, view)
    seats = [_support_under(each, arrangement, stream) for each in occupants]
    pieces = [seat for seat in seats if seat is not None]
    pieces += _before_people(arrangement, stream)
    pieces += _own_parts(arrangement, stream)
    for _ in range(int(stream.between(PIECES[0], PIECES[1] + 1))):
        piece = _sample_piece(arrangement, stream)
        if piece is not None:
            pieces.append(piece)
    return Furnishing(walls, pieces, seats)


def _support_under(
    occupant: Occupant, arrangement: Arrangement, stream: RandomStream
) -> Piece | None:
    if occupant.seated:
        return seat_under(occupant, arrangement, stream)
    return berth_under(occupant, arrangement, stream) if occupant.raised else None


def _before_people(arrangement: Arrangement, stream: RandomStream) -> list[Piece]:
    """Return tables before people on seats, and a piece in front of one person."""
    occupants = arrangement.occupants
    before = [
        table_before(each, arrangement, stream)
        for each in occupants
        if each.seated and stream.bernoulli(_TABLE_FRACTION)
    ]
    pieces = [each for each in before if each is not None and arrangement.accepts(each, stream)]
    if occupants and stream.bernoulli(IN_FRONT_FRACTION):
        chosen = occupants[int(len(occupants) * stream.uniform())]
        for _ in range(_TRIES):
            piece = piece_in_front(chosen, arrangement, stream)
            if piece is not None and arrangement.accepts(piece, stream):
                pieces.append(piece)
                break
    return pieces


def _own_parts(arrangement: Arrangement, stream: RandomStream) -> list[Piece]:
    """Return arm and deck of the robot that carries the camera, unless they hit anybody."""
    position, front = np.array([0.0, arrangement.floor, 0.0]), np.array([0.0, 1.0])
    pieces = []
    for make, fraction in (
        (clutter.robot_arm, _ARM_FRACTION),
        (clutter.robot_deck, _DECK_FRACTION),
    ):
        if stream.bernoulli(fraction):
            pieces.append(make(arrangement.floor, stream).placed(position, front))
    return [piece for piece in pieces if arrangement.clear_of_people(piece)]


def _sample_piece(arrangement: Arrangement, stream: RandomStream) -> Piece | None:
    """Return a piece at an accepted position, or None."""
    where, make = stream.choose(_PIECES)
    piece = make(stream)
    for _ in range(_TRIES):
        if where == 'wall':
            placed: Piece | None = arrangement.at_wall(piece, stream)
        elif stream.bernoulli(_BESIDE_FRACTION):
            placed = arrangement.beside(piece, stream)
        else:
            placed = arrangement.freely(piece, stream)
        if placed is not None and arrangement.accepts(placed, stream):
            return placed
    return None


_BESIDE_FRACTION = 0.35  # of the pieces that do not need a wall


def _imagined_points(
    camera_height: float, view: float, stream: RandomStream
) -> 'np.ndarray[tuple[int, int], np.dtype[np.float64]]':
    """Return positions in view, shape (3, 3), where people could stand in an empty room."""
    points = np.zeros((3, 3))
    for point in points:
        bearing, distance = view * stream.between(-1, 1), stream.between(*_EMPTY_SPOTS)
        point[:] = distance * np.sin(bearing), camera_height, distance * np.cos(bearing)
    return points


def _any_chair(stream: RandomStream) -> Piece:
    return seating.chair(seating.sample_seat(stream), stream)


def _any_seat(stream: RandomStream) -> Piece:
    return stream.choose(seating.SEATS)(seating.sample_seat(stream), stream)


def _any_sofa(stream: RandomStream) -> Piece:
    return seating.sofa(seating.sample_seat(stream), stream)


def _any_table(stream: RandomStream) -> Piece:
    return tables.table(tables.sample_table(stream), stream)


def _any_desk(stream: RandomStream) -> Piece:
    return tables.desk(tables.sample_table(stream), stream)


def _any_counter(stream: RandomStream) -> Piece:
    size = tables.sample_table(stream)._replace(height=stream.between(0.7, 1.2))
    return tables.counter(size, stream)


_PIECES: tuple[tuple[float, tuple[str, Callable[[RandomStream], Piece]]], ...] = (
    (0.08, ('free', _any_chair)),
    (0.1, ('free', _any_seat)),
    (0.05, ('wall', _any_sofa)),
    (0.08, ('free', _any_table)),
    (0.05, ('wall', _any_desk)),
    (0.04, ('free', _any_counter)),
    (0.03, ('wall', seating.bed)),
    (0.08, ('wall', storage.shelf)),
    (0.08, ('wall', storage.cupboard)),
    (0.06, ('wall', storage.curtain)),
    (0.05, ('wall', storage.door)),
    (0.06, ('wall', storage.hooks)),
    (0.05, ('wall', storage.wall_things)),
    (0.05, ('free', clothing.coat_stand)),
    (0.02, ('free', clothing.dummy)),
    (0.07, ('free', clutter.boxes)),
    (0.06, ('free', clutter.plant)),
    (0.04, ('free', clutter.lamp)),
    (0.04, ('free', clutter.robot)),
    (0.06, ('free', clutter.round_things)),
    (0.02, ('free', clutter.ladder)),
    (0.03, ('free', clutter.poles)),
    (0.04, ('free', clutter.partition)),
)
"""Kinds of pieces with their frequency and where they stand."""
