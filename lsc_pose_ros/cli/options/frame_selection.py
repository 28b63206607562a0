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

"""Selects frames of a recording: evenly distributed, or by number."""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.pose.silhouette.silhouette import choose_uniformly


class NumberedFrame(NamedTuple):
    """A frame and its number in the recording, from 0."""

    number: int
    frame: Frame


def spread(
    frames: Iterable[Frame], wanted: int, suitable: Callable[[Frame], bool] = lambda _: True
) -> list[NumberedFrame]:
    """Return `wanted` evenly distributed ones of the suitable frames, or all if there are fewer.

    One pass over any number of frames, of which fewer than 4 `wanted` are held: every frame at
    first, and each time that these become too many, every second of them is let go.
    """
    kept: list[NumberedFrame] = []
    stride = 1
    numbered = (each for each in enumerate(frames) if suitable(each[1]))
    for place, (number, frame) in enumerate(numbered):
        if place % stride == 0:
            kept.append(NumberedFrame(number, frame))
            if len(kept) == 4 * wanted:
                kept = kept[::2]
                stride *= 2
    return [kept[index] for index in choose_uniformly(len(kept), wanted)]


def pick(frames: Iterable[Frame], numbers: Sequence[int], where: str) -> list[NumberedFrame]:
    """Return the frames with these numbers, in the order of `numbers`.

    Args:
        frames: the frames; they are read up to the last number.
        numbers: counted from 0.
        where: the name of the recording, for errors.

    Raises:
        InputError: a number is too large.
    """
    found: dict[int, Frame] = {}
    missing = set(numbers)
    count = 0
    for number, frame in enumerate(frames):
        count = number + 1
        if number in missing:
            found[number] = frame
            missing.remove(number)
        if not missing:
            break
    if missing:
        msg = (
            f'{where} has no frame {min(missing)}; '
            f'its {count} frames are numbered from 0 to {count - 1}'
        )
        raise InputError(msg)
    return [NumberedFrame(number, found[number]) for number in numbers]
