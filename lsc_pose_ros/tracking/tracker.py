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

"""Bodies keep their numbers from frame to frame, whatever numbers the mask gives them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.skeletons import Skeletons

# A body that has moved further since it was last seen is another one, metres. A person who walks
# fast moves 0.4 m between two frames at 5 Hz; two people are seldom closer together.
GATE = 0.5

# How long a body that is not seen keeps its number, nanoseconds.
MEMORY_NS = 1_000_000_000

_LARGEST = int(np.iinfo(np.uint16).max)


class _Track(NamedTuple):
    """Where a body was seen last.

    Attributes:
        stamp: when, nanoseconds.
        label: the number that the mask gave it.
        joints: its joints, metres, shape (J, 3); as far back as they were known.
    """

    stamp: int
    label: int
    joints: NDArray[np.float32]


class Tracker:
    """Assigns the bodies of each frame to those of the frames before, the nearest first."""

    def __init__(self, *, gate: float = GATE, memory_ns: int = MEMORY_NS) -> None:
        """Begin without a past.

        Args:
            gate: how far a body can have moved since it was last seen, metres.
            memory_ns: how long a body that is not seen keeps its number, nanoseconds.
        """
        self._gate = gate
        self._memory = memory_ns
        self._tracks: dict[int, _Track] = {}
        self._largest = 0

    def follow(self, stamp: int, skeletons: Skeletons) -> Skeletons:
        """Return `skeletons` with lasting numbers, in their order.

        A body that was not there before keeps the mask's number where no other body has it.

        Args:
            stamp: nanoseconds.
            skeletons: the bodies of one frame, numbered by its mask.
        """
        self._forget(stamp)
        numbers = self._recognise(skeletons)
        self._welcome(skeletons.bodies, numbers)
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
        """Return the numbers of the rows that show bodies of before."""
        numbers: dict[int, int] = {}
        for row, number in self._nearest_first(skeletons.positions):
            if row not in numbers and number not in numbers.values():
                numbers[row] = number
        # Too little is seen of some to know where they are; the mask's number must do.
        for row, label in enumerate(skeletons.bodies.tolist()):
            if row in numbers or np.isfinite(skeletons.positions[row]).any():
                continue
            for number, track in self._tracks.items():
                if track.label == label and number not in numbers.values():
                    numbers[row] = number
                    break
        return numbers

    def _nearest_first(self, positions: NDArray[np.float32]) -> list[tuple[int, int]]:
        """Return the pairs (row, number) that may be one body, the nearest first."""
        pairs = [
            (distance, row, number)
            for row, joints in enumerate(positions)
            for number, track in self._tracks.items()
            if (distance := body_distance(joints, track.joints)) <= self._gate
        ]
        return [(row, number) for _, row, number in sorted(pairs)]

    def _welcome(self, labels: NDArray[np.uint16], numbers: dict[int, int]) -> None:
        """Add numbers for the rows that show new bodies."""
        taken = {*self._tracks, *numbers.values()}
        strangers = [row for row in range(len(labels)) if row not in numbers]
        for row in strangers:
            label = int(labels[row])
            if label not in taken:
                numbers[row] = label
                taken.add(label)
        # Nor may a new number be one that the mask is about to use.
        taken.update(labels.tolist())
        for row in strangers:
            if row not in numbers:
                numbers[row] = self._new_number(taken)
                taken.add(numbers[row])

    def _new_number(self, taken: set[int]) -> int:
        """Return a number that was never used, or if there is none, one that is not in use."""
        unused = max(self._largest, *taken) + 1
        if unused <= _LARGEST:
            return unused
        return next(number for number in range(1, _LARGEST + 1) if number not in taken)

    def _keep(self, number: int, track: _Track) -> None:
        before = self._tracks.get(number)
        if before is not None:
            # What is hidden now was there a moment ago.
            joints = np.where(np.isfinite(track.joints), track.joints, before.joints)
            track = track._replace(joints=joints)
        self._tracks[number] = track
        self._largest = max(self._largest, number)


def body_distance(first: NDArray[np.float32], second: NDArray[np.float32]) -> float:
    """Return how far apart two skeletons are, metres.

    That is the mean distance of the joints that both have, or infinity where there is none.

    Args:
        first: metres, NaN where unknown, shape (J, 3).
        second: likewise.
    """
    distances = np.linalg.norm(first - second, axis=1)
    known = distances[np.isfinite(distances)]
    return float(known.mean()) if len(known) else float('inf')
