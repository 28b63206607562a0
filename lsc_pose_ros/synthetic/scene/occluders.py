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

"""Pieces right in front of people, which hide the body up to knee, thigh, hip or waist."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.arrangement import Arrangement
from lsc_pose_ros.synthetic.scene.furniture.seating import SeatSize, box_seat, chair, sofa
from lsc_pose_ros.synthetic.scene.furniture.tables import TableSize, counter, desk, table
from lsc_pose_ros.synthetic.scene.occupant import Occupant, unit
from lsc_pose_ros.synthetic.scene.piece import Piece

DISTANCE = (0.1, 0.6)
"""Range of the distance between a person and what stands in front, metres."""

_HEIGHTS = (0.2, 1.7)  # range of the height of such pieces, metres
_STEPS = 8  # positions that are tried, nearer and nearer to the camera
_STEP = 0.1  # between these positions, metres
_LEAST_SIGHT = 0.5  # distance of the near side of such pieces from the camera, metres

# Joints that are just visible, and how far the line of sight is above them, metres.
_CUTS: tuple[tuple[float, tuple[str, str]], ...] = (
    (0.2, ('l_knee', 'r_knee')),
    (0.25, ('l_knee', 'pelvis')),
    (0.25, ('l_hip', 'r_hip')),
    (0.25, ('torso', 'pelvis')),
    (0.05, ('torso', 'neck')),
)


def piece_in_front(
    occupant: Occupant, arrangement: Arrangement, stream: RandomStream
) -> Piece | None:
    """Return a piece between the camera and a person that hides the lower part of the body.

    Args:
        occupant: the person.
        arrangement: the room and all people.
        stream: the source of randomness.

    Returns:
        The piece, or None if none fits.
    """
    pelvis = occupant.joint('pelvis')[[0, 2]]
    sight = unit(pelvis)
    cut = 0.5 * np.add(*(occupant.joint(name) for name in stream.choose(_CUTS)))
    width, depth = stream.between(0.5, 2.2), stream.between(0.15, 0.8)
    make = stream.choose(_KINDS)
    low = occupant.points[:, :, 1] > cut[1] - 0.1
    nearest = float((occupant.points[low][:, [0, 2]] @ sight).min())
    far = nearest - stream.between(*DISTANCE)
    slant, aside = stream.between(-0.4, 0.4), stream.between(-0.35, 0.35) * width
    across = np.array([sight[1], -sight[0]])
    front = unit(slant * across - sight)
    for _ in range(_STEPS):
        near = far - depth
        if near < _LEAST_SIGHT:
            return None
        height = _hiding_height(cut, (near, far), arrangement.floor)
        spot = (far - 0.5 * depth) * sight + aside * across
        position = np.array([spot[0], arrangement.floor, spot[1]])
        piece = make(TableSize(width, depth, height), stream).placed(position, front)
        if arrangement.clear(piece):
            return piece
        far -= _STEP
    return None


def _hiding_height(cut: NDArray[np.float64], sides: tuple[float, float], floor: float) -> float:
    """Return the height of a piece that hides what is below a point.

    The line of sight to the point touches the upper edge of the piece: of its far side if the
    camera is above it, of its near side otherwise.

    Args:
        cut: the point, in the level frame, shape (3,).
        sides: distances of the near and of the far side, metres.
        floor: y of the floor, metres.
    """
    slope = cut[1] / np.sqrt(cut[0] ** 2 + cut[2] ** 2)
    edge = sides[1] if slope > 0 else sides[0]
    return float(np.clip(floor - slope * edge, *_HEIGHTS))


def _sofa_from_behind(size: TableSize, stream: RandomStream) -> Piece:
    """Return a sofa whose user faces the person behind it."""
    seat = min(0.6 * size.height, 0.45)
    return sofa(SeatSize(0.5, max(size.depth, 0.45), seat, size.height - seat), stream)


def _chair_from_behind(size: TableSize, stream: RandomStream) -> Piece:
    seat = min(0.6 * size.height, 0.5)
    return chair(SeatSize(min(size.width, 0.55), 0.42, seat, size.height - seat), stream)


def _box(size: TableSize, stream: RandomStream) -> Piece:
    return box_seat(SeatSize(size.width, size.depth, size.height, 0.0), stream)


_KINDS: tuple[tuple[float, Callable[[TableSize, RandomStream], Piece]], ...] = (
    (0.3, counter), (0.2, desk), (0.15, table), (0.15, _sofa_from_behind),
    (0.05, _chair_from_behind), (0.15, _box),
)  # fmt: skip
