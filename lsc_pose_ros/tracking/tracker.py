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

"""Tracks bodies: their numbers persist from frame to frame, independent of the mask."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.skeletons import Skeletons

# The largest distance between a body and its last position, metres. A person who walks fast moves
# 0.4 m between two frames at 5 Hz; two people are rarely closer than that.
GATE = 0.5

# How long the number of an unseen body is kept, nanoseconds.
MEMORY_NS = 1_000_000_000

_LARGEST = int(np.iinfo(np.uint16).max)


class _Track(NamedTuple):
    """The last observation of a body.

    Attributes:
        stamp: nanoseconds.
        label: its number in the mask.
        joints: last known position of each joint, metres, NaN if never known, shape (J, 3).
    """

    stamp: int
    label: int
    joints: NDArray[np.float32]


class Tracker:
    """Assigns the bodies of each frame to those of earlier frames, the nearest pairs first."""

    def __init__(self, *, gate: float = GATE, memory_ns: int = MEMORY_NS) -> None:
        """Start without tracks.

        Args:
            gate: the largest distance between a body and its last position, metres.
            memory_ns: how long the number of an unseen body is kept, nanoseconds.
        """
        self._gate = gate
        self._memory = memory_ns
        self._tracks: dict[int, _Track] = {}
        self._largest = 0

    def follow(self, stamp: int, skeletons: Skeletons) -> Skeletons:
        """Return `skeletons` with persistent body numbers, in ascending order.

        A new body keeps its number in the mask unless another body has that number.

        Args:
            stamp: nanoseconds.
            skeletons: the bodies of one frame, with the numbers of its mask.
        """
        self._forget(stamp)
        numbers = self._recognise(skeletons)
        self._number_new_bodies(skeletons.bodies, numbers)
        for row, number in numbers.items():
            self._keep(number, _Track(stamp, int(skeletons.bodies[row]), skeletons.positions[row]))
        bodies = np.array([numbers[row] for row in range(len(numbers))], np.uint16)
        order = np.argsort(bodies)
        return Skeletons(
            bodies[order],
            skeletons.joints,
            skeletons.positions[order],
            skeletons.confidence[order],
        )

    def _forget(self, stamp: int) -> None:
        for number, track in list(self._tracks.items()):
            if stamp - track.stamp > self._memory:
                del self._tracks[number]

    def _recognise(self, skeletons: Skeletons) -> dict[int, int]:
        """Return the numbers of the rows that are known bodies."""
        numbers: dict[int, int] = {}
        for row, number in self._nearest_first(skeletons.positions):
            if row not in numbers and number not in numbers.values():
                numbers[row] = number
        # A body without known joints has no position; it is matched by its number in the mask.
        for row, label in enumerate(skeletons.bodies.tolist()):
            if row in numbers or np.isfinite(skeletons.positions[row]).any():
                continue
            for number, track in self._tracks.items():
                if track.label == label and number not in numbers.values():
                    numbers[row] = number
                    break
        return numbers

    def _nearest_first(self, positions: NDArray[np.float32]) -> list[tuple[int, int]]:
        """Return the pairs (row, number) within the gate, the nearest first."""
        pairs = [
            (distance, row, number)
            for row, joints in enumerate(positions)
            for number, track in self._tracks.items()
            if (distance := body_distance(joints, track.joints)) <= self._gate
        ]
        return [(row, number) for _, row, number in sorted(pairs)]

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

    def _keep(self, number: int, track: _Track) -> None:
        before = self._tracks.get(number)
        if before is not None:
            # A hidden joint keeps its last position.
            joints = np.where(np.isfinite(track.joints), track.joints, before.joints)
            track = track._replace(joints=joints)
        self._tracks[number] = track
        self._largest = max(self._largest, number)


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
