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

"""Where pieces of furniture can stand: at walls, freely, or close to a person."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.clearance import hides, is_clear
from lsc_pose_ros.synthetic.scene.occupant import Occupant, unit
from lsc_pose_ros.synthetic.scene.piece import Piece
from lsc_pose_ros.synthetic.scene.room import Room

GAP = 0.015
"""Minimum distance between people and furniture that they do not sit on, metres."""

_CAMERA_GAP = 0.45  # minimum distance between camera and furniture, metres
_NEAREST, _FARTHEST = 0.6, 6.0  # distances of pieces that stand freely, metres
_STEPS = np.arange(0.1, 2.0, 0.08)  # distances of pieces beside people that are tried, metres
_HIDDEN_ALLOWED = 0.04  # probability that a piece may hide a head and the trunk below it
_SHOWN = tuple(JOINT_NUMBERS[name] for name in ('head', 'torso'))
_TURNS = (0.0, 0.5 * np.pi, np.pi, 1.5 * np.pi)


class Arrangement(NamedTuple):
    """A room with its people, in the level frame at the camera: x right, y down, z away.

    Attributes:
        walls: the room's walls, floor and ceiling.
        occupants: the people.
        points: all points of all people in all frames, metres, shape (M, 3).
        floor: y of the floor, metres.
        view: half of the horizontal field of view, radians.
    """

    walls: Room
    occupants: list[Occupant]
    points: NDArray[np.float64]
    floor: float
    view: float

    def clear(self, piece: Piece, gap: float = GAP) -> bool:
        """Return whether a piece intersects neither a person nor the camera's surroundings."""
        return is_clear(piece.blocks, np.zeros((1, 3)), _CAMERA_GAP) and self.clear_of_people(
            piece, gap
        )

    def clear_of_people(self, piece: Piece, gap: float = GAP) -> bool:
        """Return whether a piece intersects nobody."""
        return is_clear(piece.blocks, self.points, gap)

    def accepts(self, piece: Piece, stream: RandomStream) -> bool:
        """Return whether a piece can stay: it is clear, and it rarely hides a head and trunk."""
        may_hide = stream.bernoulli(_HIDDEN_ALLOWED)
        return self.clear(piece) and (may_hide or not self._hides_somebody(piece))

    def at_wall(self, piece: Piece, stream: RandomStream) -> Piece:
        """Return a piece that stands with its back at a wall, in view."""
        bearing = self._bearing(stream)
        distance, inwards = self._wall(bearing)
        gap = stream.choose(((0.7, 0.0), (0.3, stream.between(0.0, 0.3))))
        spot = distance * bearing + (gap - piece.size()[0][2]) * inwards
        return piece.placed(self._on_floor(spot), inwards)

    def freely(self, piece: Piece, stream: RandomStream) -> Piece:
        """Return a piece that stands anywhere in view."""
        bearing = self._bearing(stream)
        farthest = min(max(self._wall(bearing)[0] - 0.2, _NEAREST), _FARTHEST)
        # Far pieces are more frequent, because the view is wider there.
        distance = _NEAREST + (farthest - _NEAREST) * np.sqrt(stream.uniform())
        spot = distance * bearing
        return piece.placed(self._on_floor(spot), self._any_front(stream))

    def beside(self, piece: Piece, stream: RandomStream) -> Piece | None:
        """Return a piece close to a person, or None if nobody is there or it does not fit."""
        if not self.occupants:
            return None
        occupant = self.occupants[int(len(self.occupants) * stream.uniform())]
        angle, gap = 2 * np.pi * stream.uniform(), stream.between(0.0, 0.1)
        direction = np.array([np.cos(angle), np.sin(angle)])
        front = unit(-direction) if stream.bernoulli(0.5) else self._any_front(stream)
        return self.slid(piece, occupant.joint('pelvis')[[0, 2]], direction, front, gap)

    def slid(
        self,
        piece: Piece,
        start: NDArray[np.float64],
        direction: NDArray[np.float64],
        front: NDArray[np.float64],
        gap: float,
    ) -> Piece | None:
        """Return a piece at the first clear position on a line, displaced further by `gap`.

        Args:
            piece: in its own frame.
            start: of the line (x, z), metres.
            direction: of the line (x, z), length 1.
            front: of the piece (x, z), length 1.
            gap: metres.
        """
        placed = piece.placed(self._on_floor(start), front)
        offset = np.array([direction[0], 0.0, direction[1]])
        for step in _STEPS:
            moved = placed.moved(step * offset)
            if self.clear(moved):
                return placed.moved((step + gap) * offset)
        return None

    def _hides_somebody(self, piece: Piece) -> bool:
        return any(
            all(hides(piece.blocks, occupant.joints[frame, joint]) for joint in _SHOWN)
            for occupant in self.occupants
            for frame in {0, len(occupant.joints) // 2, len(occupant.joints) - 1}
        )

    def _on_floor(self, spot: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([spot[0], self.floor, spot[1]])

    def _bearing(self, stream: RandomStream) -> NDArray[np.float64]:
        angle = 1.1 * self.view * (2 * stream.uniform() - 1)
        return np.array([np.sin(angle), np.cos(angle)])

    def _any_front(self, stream: RandomStream) -> NDArray[np.float64]:
        """Return a direction that is often parallel to a wall."""
        turn, slant = stream.choose(tuple((1.0, turn) for turn in _TURNS)), stream.uniform()
        if stream.bernoulli(0.5):
            turn += 2 * np.pi * slant
        cosine, sine = self.walls.rotations[0]
        x, z = np.cos(turn), np.sin(turn)
        return np.array([cosine * x + sine * z, cosine * z - sine * x])

    def _wall(self, bearing: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        """Return the distance of the wall in a direction, and the wall's inward normal (x, z)."""
        cosine, sine = self.walls.rotations[0]
        # The rows are the axes of the room.
        axes = np.array([[cosine, -sine], [sine, cosine]])
        centre, half = self.walls.centres[0, [0, 2]], self.walls.halves[0, [0, 2]]
        best, normal = np.inf, -bearing
        for axis, along in enumerate(axes @ bearing):
            sign = 1.0 if along > 0 else -1.0
            if along == 0.0:
                continue
            distance = (sign * half[axis] + axes[axis] @ centre) / along
            if distance < best:
                best, normal = float(distance), -sign * axes[axis]
        return best, normal
