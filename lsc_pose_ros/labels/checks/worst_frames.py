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

"""The frames whose labels have most problems, apart from each other in time."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.labels.checks.problems import SHORT_KINDS

# Frames nearer to each other show the same, nanoseconds.
_APART = 500_000_000

# In the ranking, an exchange of left and right counts as so many joints.
_EXCHANGE_WEIGHT = 6


class WorstFrame(NamedTuple):
    """A frame with problems.

    Attributes:
        number: in the recording, from 0.
        frame: with its labels.
        estimate: of the model; None if it was not estimated.
        reasons: what is wrong, in words.
        marked: the labelled joints that have a problem, metres, shape (n, 3).
    """

    number: int
    frame: Frame
    estimate: Skeletons | None
    reasons: str
    marked: NDArray[np.float32]


class WorstFrames:
    """Keeps the worst frames of those that are added in the order of time."""

    def __init__(self, most: int) -> None:
        """Keep at most `most` frames."""
        self._most = most
        self._kept: list[tuple[int, WorstFrame]] = []

    def add(
        self,
        number: int,
        frame: Frame,
        estimate: Skeletons | None,
        problems: Mapping[str, NDArray[np.bool_]],
        exchanged: int,
    ) -> None:
        """Keep a frame if it is among the worst: of frames at about the same time, only the worst.

        Args:
            number: of the frame in the recording.
            frame: with its labels, with all 20 joints.
            estimate: of the model; None if it was not estimated.
            problems: which joints have each kind of problem, shape (B, 20) each, as
                `find_problems` returns them.
            exchanged: how many bodies have left and right exchanged.
        """
        badness = sum(int(joints.sum()) for joints in problems.values())
        badness += _EXCHANGE_WEIGHT * exchanged
        apart = [each for each in self._kept if abs(each[1].frame.stamp - frame.stamp) >= _APART]
        near = [each for each in self._kept if abs(each[1].frame.stamp - frame.stamp) < _APART]
        if not badness or any(other >= badness for other, _ in near):
            return
        labels = frame.ground_truth
        any_problem = np.logical_or.reduce(list(problems.values()))
        marked = np.zeros((0, 3), np.float32) if labels is None else labels.positions[any_problem]
        worst = WorstFrame(number, frame, estimate, _reasons(problems, exchanged), marked)
        ranked = sorted([*apart, (badness, worst)], key=lambda each: (-each[0], each[1].number))
        self._kept = ranked[: self._most]

    def found(self) -> list[WorstFrame]:
        """Return the worst frames, the worst first."""
        return [each for _, each in self._kept]


def _reasons(problems: Mapping[str, NDArray[np.bool_]], exchanged: int) -> str:
    counts = {kind: int(joints.sum()) for kind, joints in problems.items() if joints.any()}
    words = [
        f'{count} {"joint" if count == 1 else "joints"} {SHORT_KINDS[kind]}'
        for kind, count in counts.items()
    ]
    return ', '.join([*words, 'left and right exchanged'] if exchanged else words)
