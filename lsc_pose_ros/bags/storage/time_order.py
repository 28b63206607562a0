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

"""Merges parts of a recording that overlap in time into one stream in the order of log time."""

import heapq
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple, TypeVar

LARGEST_OVERLAP = 1 << 29
"""Parts that overlap in time are in memory together; not more than so many bytes of them."""


class TimedPart(NamedTuple):
    """A part of a recording: a chunk, a message outside of chunks, or a file.

    Attributes:
        start: the earliest log time, nanoseconds.
        end: the latest log time, nanoseconds.
        size: the bytes that it needs in memory while it is read.
        position: its position in the recording, for equal times.
    """

    start: int
    end: int
    size: int
    position: int


Item = TypeVar('Item')


def in_time_order(
    parts: Iterable[TimedPart],
    read: Callable[[TimedPart], Iterator[Item]],
    log_time: Callable[[Item], int],
) -> Iterator[Item]:
    """Yield the items of all parts in the order of log time, and of position for equal times.

    A part is read when the first item that it can hold is due, so that only parts that overlap in
    time are in memory together.

    Args:
        parts: the parts.
        read: returns the items of a part in the order of log time.
        log_time: returns the log time of an item, nanoseconds.
    """
    waiting = sorted(parts, key=lambda part: (part.start, part.position), reverse=True)
    opened: list[tuple[int, int, Item, Iterator[Item]]] = []

    def push(position: int, items: Iterator[Item]) -> None:
        for item in items:
            # Two parts never have the same position, so items are not compared.
            heapq.heappush(opened, (log_time(item), position, item, items))
            return

    while waiting or opened:
        while waiting and (not opened or waiting[-1].start <= opened[0][0]):
            part = waiting.pop()
            push(part.position, read(part))
        if opened:
            _, position, item, items = heapq.heappop(opened)
            yield item
            push(position, items)


def largest_overlap(parts: Iterable[TimedPart]) -> int:
    """Return the largest sum of the sizes of parts that overlap at one time, bytes."""
    events = [event for part in parts for event in ((part.start, 0, part), (part.end, 1, part))]
    events.sort(key=lambda event: event[:2])
    largest = current = 0
    for _, ends, part in events:
        current += -part.size if ends else part.size
        largest = max(largest, current)
    return largest
