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

"""Tracks bodies: their numbers persist from frame to frame, independent of the mask.

The bodies of a frame are those of the frames before by place and size: a body moves on at a
constant velocity (`movement.py`), and its limbs keep their lengths (`body_size.py`). All bodies
are assigned at once, at the least cost (`assignment.py`). A piece of a known body is no new one
(`fragments.py`).
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.image_arguments import ImageArguments
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.tracking.assignment import assign
from lsc_pose_ros.tracking.body_size import (
    MOST_DIFFERENT,
    BodySize,
    limbs_of,
    size_difference,
    size_in_frame,
)
from lsc_pose_ros.tracking.fragments import join_fragments
from lsc_pose_ros.tracking.movement import LARGEST_COST, Movement, at_rest
from lsc_pose_ros.tracking.surfaces import Surface

MEMORY_NS = 1_000_000_000
"""How long the number of an unseen body is kept, nanoseconds."""

RECENT_NS = 200_000_000
"""Only of bodies that were seen a moment ago is it known where they have pieces, nanoseconds."""

_LARGEST = int(np.iinfo(np.uint16).max)

_NOWHERE: Mapping[int, Surface] = {}


class _Observation(NamedTuple):
    """A body in one frame.

    Attributes:
        label: its number in the mask.
        joints: metres, NaN if unknown, shape (J, 3).
        size: the lengths of the limbs.
        surface: the visible surface; None if nothing is known of the body's place.
    """

    label: int
    joints: NDArray[np.float32]
    size: BodySize
    surface: Surface | None


class _Track(NamedTuple):
    """What is known of a body.

    Attributes:
        stamp: when it was last seen, nanoseconds.
        label: its number in the mask when it was last seen.
        joints: last known position of each joint, metres, NaN if never known, shape (J, 3).
        size: the lengths of the limbs.
        movement: of the body; None if its place was never known.
    """

    stamp: int
    label: int
    joints: NDArray[np.float32]
    size: BodySize
    movement: Movement | None

    def expected(self, stamp: int) -> NDArray[np.float32]:
        """Return where the joints are expected at `stamp`, metres, shape (J, 3)."""
        if self.movement is None:
            return self.joints
        return (self.joints + self.movement.step(stamp)).astype(np.float32)

    def cost(self, stamp: int, body: _Observation) -> float:
        """Return the cost of the track and the body being the same; infinity if they are not."""
        if self.movement is None or body.surface is None:
            return float('inf')
        return self.movement.cost(stamp, body.surface) + size_difference(self.size, body.size)

    def seen(self, stamp: int, body: _Observation) -> '_Track':
        """Return the track after its body was seen again."""
        movement = self.movement
        if body.surface is not None:
            movement = (
                at_rest(stamp, body.surface)
                if movement is None
                else movement.seen(stamp, body.surface)
            )
        # A hidden joint goes where the body goes.
        known = np.isfinite(body.joints)
        joints = np.where(known, body.joints, self.expected(stamp))
        return _Track(stamp, body.label, joints, self.size.updated(body.size), movement)


class Tracker:
    """Assigns the bodies of each frame to those of earlier frames."""

    def __init__(self, *, memory_ns: int = MEMORY_NS) -> None:
        """Start without tracks.

        Args:
            memory_ns: how long the number of an unseen body is kept, nanoseconds.
        """
        self._memory = memory_ns
        self._tracks: dict[int, _Track] = {}
        self._largest = 0
        self._limbs = np.zeros((0, 2), np.int32)

    def labels_of(self, stamp: int) -> dict[int, int]:
        """Return the labels of the bodies that were seen at `stamp`, by their numbers."""
        return {
            number: track.label for number, track in self._tracks.items() if track.stamp == stamp
        }

    def join_fragments(self, stamp: int, images: ImageArguments) -> NDArray[np.int32]:
        """Return the labels of a frame, with fragments of known bodies given to these, (H, W).

        Args:
            stamp: nanoseconds.
            images: depth, labels and camera.
        """
        expected = [
            track.expected(stamp)
            for track in self._tracks.values()
            if stamp - track.stamp <= RECENT_NS
        ]
        return join_fragments(images, expected, self._limbs)

    def follow(
        self, stamp: int, skeletons: Skeletons, surfaces: Mapping[int, Surface] = _NOWHERE
    ) -> Skeletons:
        """Return `skeletons` with persistent body numbers, in ascending order.

        A new body keeps its number in the mask unless another body has that number.

        Args:
            stamp: nanoseconds.
            skeletons: the bodies of one frame, with the numbers of its mask.
            surfaces: of the bodies, by these numbers. A body without one is where its joints are.
        """
        self._forget(stamp)
        self._limbs = limbs_of(skeletons.joints)
        bodies = _observations(skeletons, surfaces, self._limbs)
        numbers = self._recognise(stamp, bodies)
        self._number_new_bodies(skeletons.bodies, numbers)
        for row, number in numbers.items():
            self._keep(stamp, number, bodies[row])
        assigned = np.array([numbers[row] for row in range(len(numbers))], np.uint16)
        order = np.argsort(assigned)
        return Skeletons(
            assigned[order],
            skeletons.joints,
            skeletons.positions[order],
            skeletons.confidence[order],
        )

    def _forget(self, stamp: int) -> None:
        for number, track in list(self._tracks.items()):
            if stamp - track.stamp > self._memory:
                del self._tracks[number]

    def _recognise(self, stamp: int, bodies: list[_Observation]) -> dict[int, int]:
        """Return the numbers of the rows that are known bodies."""
        known = list(self._tracks)
        costs = np.array(
            [[self._tracks[number].cost(stamp, body) for number in known] for body in bodies]
        ).reshape(len(bodies), len(known))
        numbers = {
            row: known[column] for row, column in assign(costs, LARGEST_COST + MOST_DIFFERENT)
        }
        # A body without a place is matched by its number in the mask.
        for row, body in enumerate(bodies):
            if row in numbers or body.surface is not None:
                continue
            for number, track in self._tracks.items():
                if track.label == body.label and number not in numbers.values():
                    numbers[row] = number
                    break
        return numbers

    def _number_new_bodies(self, labels: NDArray[np.uint16], numbers: dict[int, int]) -> None:
        """Add the numbers of the rows that are new bodies."""
        taken = {*self._tracks, *numbers.values()}
        new_rows = [row for row in range(len(labels)) if row not in numbers]
        for row in new_rows:
            label = int(labels[row])
            if label not in taken:
                numbers[row] = label
                taken.add(label)
        # A new number must differ from all numbers of the mask.
        taken.update(labels.tolist())
        for row in new_rows:
            if row not in numbers:
                numbers[row] = self._new_number(taken)
                taken.add(numbers[row])

    def _new_number(self, taken: set[int]) -> int:
        """Return a number that was never used, or a free one if all were used."""
        unused = max(self._largest, *taken) + 1
        if unused <= _LARGEST:
            return unused
        return next(number for number in range(1, _LARGEST + 1) if number not in taken)

    def _keep(self, stamp: int, number: int, body: _Observation) -> None:
        before = self._tracks.get(number)
        if before is None:
            movement = None if body.surface is None else at_rest(stamp, body.surface)
            self._tracks[number] = _Track(stamp, body.label, body.joints, body.size, movement)
        else:
            self._tracks[number] = before.seen(stamp, body)
        self._largest = max(self._largest, number)


def _observations(
    skeletons: Skeletons, surfaces: Mapping[int, Surface], limbs: NDArray[np.int32]
) -> list[_Observation]:
    bodies = zip(skeletons.bodies.tolist(), skeletons.positions, skeletons.confidence, strict=True)
    return [
        _Observation(
            label,
            joints,
            size_in_frame(joints, confidence, limbs),
            surfaces.get(label) or _surface_of_joints(joints),
        )
        for label, joints, confidence in bodies
    ]


def _surface_of_joints(joints: NDArray[np.float32]) -> Surface | None:
    """Return a surface in the middle of the known joints."""
    known = np.isfinite(joints).all(axis=1)
    if not known.any():
        return None
    return Surface(joints[known].mean(axis=0).astype(np.float64), float(known.mean()))


def body_distance(first: NDArray[np.float32], second: NDArray[np.float32]) -> float:
    """Return the mean distance of the joints of two skeletons, metres.

    Joints that are unknown in one of them do not count; without any other, it is infinity.

    Args:
        first: metres, NaN if unknown, shape (J, 3).
        second: as `first`.
    """
    distances = np.linalg.norm(first - second, axis=1)
    known = distances[np.isfinite(distances)]
    return float(known.mean()) if len(known) else float('inf')
