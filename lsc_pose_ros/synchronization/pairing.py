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

"""Depth image and mask of the same moment, found by their stamps in bounded memory."""

from bisect import bisect_left
from collections import OrderedDict
from collections.abc import Sequence
from typing import Generic, TypeVar

DepthItem = TypeVar('DepthItem')
MaskItem = TypeVar('MaskItem')
Item = TypeVar('Item')

# No stamp is as old, nanoseconds.
_BEFORE_ALL = -(1 << 63)


class Pairing(Generic[DepthItem, MaskItem]):
    """Joins two streams by stamp. The items may be anything; they are only handed through.

    Equal stamps come first. A pair whose stamps differ, within the slop, is made at once as long
    as no two stamps have ever been equal: then the streams are stamped by different clocks, and
    waiting would only make the answer older. Once stamps have been equal, such a pair waits until
    both streams have gone past it, for an equal stamp may still come.

    What finds no partner before `capacity` newer items of its kind have come is dropped.

    Attributes:
        slop_ns: how far apart, in nanoseconds, the stamps of a pair may be; may be changed.
        dropped_depth: depth images that found no mask.
        dropped_mask: masks that found no depth image.
        duplicates: items left out because their stamp had been there already.
        late: items left out because a newer pair had been made already; only with `in_order`.
    """

    def __init__(self, *, slop_ns: int = 0, capacity: int = 100, in_order: bool = False) -> None:
        """Make an empty pairing.

        Args:
            slop_ns: how far apart, in nanoseconds, the stamps of a pair may be; 0 asks for equal
                stamps. It should stay below half the time between two images, or an image may
                find its neighbour's mask.
            capacity: how many items of each kind may wait for a partner.
            in_order: whether pairs come only with increasing stamps, so that what is older than
                the last pair is left out at once.
        """
        self.slop_ns = slop_ns
        self._capacity = capacity
        self._in_order = in_order
        self._depth: OrderedDict[int, DepthItem] = OrderedDict()
        self._mask: OrderedDict[int, MaskItem] = OrderedDict()
        self._paired_depth: OrderedDict[int, None] = OrderedDict()
        self._paired_mask: OrderedDict[int, None] = OrderedDict()
        self._newest_depth = self._newest_mask = _BEFORE_ALL
        self._last_depth = self._last_mask = _BEFORE_ALL
        self._equal_stamps_seen = False
        self.dropped_depth = 0
        self.dropped_mask = 0
        self.duplicates = 0
        self.late = 0

    @property
    def waiting_depth(self) -> int:
        """How many depth images have no mask yet."""
        return len(self._depth)

    @property
    def waiting_mask(self) -> int:
        """How many masks have no depth image yet."""
        return len(self._mask)

    def add_depth(self, stamp: int, item: DepthItem) -> list[tuple[int, DepthItem, MaskItem]]:
        """Take a depth image; return the pairs (stamp, depth, mask) that are now complete.

        Args:
            stamp: nanoseconds.
            item: whatever stands for the image.
        """
        if not self._admit(stamp, self._depth, self._paired_depth, self._last_depth):
            return []
        self._newest_depth = max(self._newest_depth, stamp)
        self._depth[stamp] = item
        pairs = self._pairs_with(stamp)
        self.dropped_depth += drop_oldest(self._depth, self._capacity)
        return pairs

    def add_mask(self, stamp: int, item: MaskItem) -> list[tuple[int, DepthItem, MaskItem]]:
        """Take a mask; return the pairs (the depth's stamp, depth, mask) that are now complete.

        Args:
            stamp: nanoseconds.
            item: whatever stands for the mask.
        """
        if not self._admit(stamp, self._mask, self._paired_mask, self._last_mask):
            return []
        self._newest_mask = max(self._newest_mask, stamp)
        self._mask[stamp] = item
        pairs = self._pairs_with(stamp)
        self.dropped_mask += drop_oldest(self._mask, self._capacity)
        return pairs

    def finish(self) -> list[tuple[int, DepthItem, MaskItem]]:
        """Return the pairs that still waited for better ones, and count the rest as dropped."""
        pairs = self._near_pairs(sorted(self._depth), sorted(self._mask))
        self.dropped_depth += len(self._depth)
        self.dropped_mask += len(self._mask)
        self._depth.clear()
        self._mask.clear()
        return pairs

    def _admit(
        self,
        stamp: int,
        waiting: OrderedDict[int, Item],
        paired: OrderedDict[int, None],
        last: int,
    ) -> bool:
        if stamp in waiting or stamp in paired:
            self.duplicates += 1
            return False
        if self._in_order and stamp < last:
            self.late += 1
            return False
        return True

    def _pairs_with(self, stamp: int) -> list[tuple[int, DepthItem, MaskItem]]:
        """Return the pairs that are complete now that an item of `stamp` has come."""
        if stamp in self._depth and stamp in self._mask:
            self._equal_stamps_seen = True
            return [self._take(stamp, stamp)]
        if not self.slop_ns:
            return []
        depth, mask = sorted(self._depth), sorted(self._mask)
        if self._equal_stamps_seen:
            depth = [each for each in depth if each <= self._newest_mask]
            mask = [each for each in mask if each <= self._newest_depth]
        return self._near_pairs(depth, mask)

    def _near_pairs(
        self, depth: Sequence[int], mask: Sequence[int]
    ) -> list[tuple[int, DepthItem, MaskItem]]:
        """Return the pairs among these stamps, sorted, each of which is the other's nearest."""
        if not depth or not mask:
            return []
        found = [(stamp, _nearest(mask, stamp)) for stamp in depth]
        return [
            self._take(own, other)
            for own, other in found
            if abs(own - other) <= self.slop_ns and _nearest(depth, other) == own
        ]

    def _take(self, depth_stamp: int, mask_stamp: int) -> tuple[int, DepthItem, MaskItem]:
        pair = depth_stamp, self._depth.pop(depth_stamp), self._mask.pop(mask_stamp)
        # Kept for a while, so that a repeated image does not wait for ever.
        self._paired_depth[depth_stamp] = None
        self._paired_mask[mask_stamp] = None
        drop_oldest(self._paired_depth, self._capacity)
        drop_oldest(self._paired_mask, self._capacity)
        if self._in_order:
            self._last_depth, self._last_mask = depth_stamp, mask_stamp
            self.dropped_depth += _drop_older(self._depth, depth_stamp)
            self.dropped_mask += _drop_older(self._mask, mask_stamp)
        return pair


def _nearest(stamps: Sequence[int], stamp: int) -> int:
    """Return the one of `stamps`, sorted, that is nearest; the older one of two as near."""
    place = bisect_left(stamps, stamp)
    return min(stamps[max(place - 1, 0) : place + 1], key=lambda other: abs(other - stamp))


def _drop_older(items: OrderedDict[int, Item], stamp: int) -> int:
    """Remove those of `items` that are older than `stamp`; return how many."""
    older = [each for each in items if each < stamp]
    for each in older:
        del items[each]
    return len(older)


def drop_oldest(items: OrderedDict[int, Item], capacity: int) -> int:
    """Remove the oldest of `items` until they fit; return how many were removed."""
    removed = 0
    while len(items) > capacity:
        items.popitem(last=False)
        removed += 1
    return removed
