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

"""Pairs depth images and masks by stamp in bounded memory."""

from bisect import bisect_left
from collections import OrderedDict
from collections.abc import Sequence
from typing import Generic, TypeVar

DepthItem = TypeVar('DepthItem')
MaskItem = TypeVar('MaskItem')
Item = TypeVar('Item')

# Older than any stamp, nanoseconds.
_BEFORE_ALL = -(1 << 63)


class Pairing(Generic[DepthItem, MaskItem]):
    """Pairs the items of two streams by stamp. The items may be of any type.

    Items with equal stamps are always paired. Items whose stamps differ by at most the slop are
    paired at once if no two stamps have been equal yet: the streams probably use different
    clocks, and waiting would only add latency. After the first equal stamps, such items wait
    until both streams have newer items, because an item with an equal stamp may still come.

    An item without partner is dropped when `capacity` newer items of its kind have come.

    Attributes:
        slop_ns: the largest difference between the stamps of a pair, nanoseconds; can be changed.
        dropped_depth: the number of depth images without a mask.
        dropped_mask: the number of masks without a depth image.
        duplicates: the number of items left out because they repeat a stamp.
        late: the number of items left out because they are older than a pair; only with
            `in_order`.
    """

    def __init__(
        self,
        *,
        slop_ns: int = 0,
        capacity: int = 100,
        in_order: bool = False,
        last_depth: int = _BEFORE_ALL,
    ) -> None:
        """Start with no items.

        Args:
            slop_ns: the largest difference between the stamps of a pair, nanoseconds; 0 for equal
                stamps. It should be less than half the time between two images; otherwise an
                image may get the mask of its neighbour.
            capacity: how many items of each kind may wait for a partner.
            in_order: True for pairs with increasing stamps: an item that is older than the last
                pair is left out.
            last_depth: the stamp of the last depth image that has been used already.
        """
        self.slop_ns = slop_ns
        self._capacity = capacity
        self._in_order = in_order
        self._depth: OrderedDict[int, DepthItem] = OrderedDict()
        self._mask: OrderedDict[int, MaskItem] = OrderedDict()
        self._paired_depth: OrderedDict[int, None] = OrderedDict()
        self._paired_mask: OrderedDict[int, None] = OrderedDict()
        self._newest_depth = self._newest_mask = _BEFORE_ALL
        self._last_depth, self._last_mask = last_depth, _BEFORE_ALL
        self._paired_depth[last_depth] = None
        self._equal_stamps_seen = False
        self.dropped_depth = 0
        self.dropped_mask = 0
        self.duplicates = 0
        self.late = 0

    @property
    def last_depth(self) -> int:
        """The stamp of the depth image of the last pair, nanoseconds; only with `in_order`."""
        return self._last_depth

    @property
    def waiting_depth(self) -> int:
        """The number of depth images that wait for a mask."""
        return len(self._depth)

    @property
    def waiting_mask(self) -> int:
        """The number of masks that wait for a depth image."""
        return len(self._mask)

    def add_depth(self, stamp: int, item: DepthItem) -> list[tuple[int, DepthItem, MaskItem]]:
        """Add a depth image; return the pairs (stamp, depth, mask) that are now complete.

        Args:
            stamp: nanoseconds.
            item: the image.
        """
        if not self._admit(stamp, self._depth, self._paired_depth, self._last_depth):
            return []
        self._newest_depth = max(self._newest_depth, stamp)
        self._depth[stamp] = item
        pairs = self._pairs_with(stamp)
        self.dropped_depth += drop_oldest(self._depth, self._capacity)
        return pairs

    def add_mask(self, stamp: int, item: MaskItem) -> list[tuple[int, DepthItem, MaskItem]]:
        """Add a mask; return the pairs (stamp of the depth image, depth, mask) now complete.

        Args:
            stamp: nanoseconds.
            item: the mask.
        """
        if not self._admit(stamp, self._mask, self._paired_mask, self._last_mask):
            return []
        self._newest_mask = max(self._newest_mask, stamp)
        self._mask[stamp] = item
        pairs = self._pairs_with(stamp)
        self.dropped_mask += drop_oldest(self._mask, self._capacity)
        return pairs

    def take_depth(self) -> list[tuple[int, DepthItem]]:
        """Return the depth images that wait for a mask, by stamp, and wait for none of them."""
        waiting = sorted(self._depth.items(), key=lambda item: item[0])
        self._depth.clear()
        return waiting

    def finish(self) -> list[tuple[int, DepthItem, MaskItem]]:
        """Return the pairs within the slop that still waited, and count the rest as dropped."""
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
        """Return the pairs that an item with `stamp` completes."""
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
        # Kept so that a repeated image is recognised.
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
    """Return the nearest of `stamps`, which are sorted; the older of two equally near ones."""
    index = bisect_left(stamps, stamp)
    return min(stamps[max(index - 1, 0) : index + 1], key=lambda other: abs(other - stamp))


def _drop_older(items: OrderedDict[int, Item], stamp: int) -> int:
    """Remove the items older than `stamp`; return how many were removed."""
    older = [each for each in items if each < stamp]
    for each in older:
        del items[each]
    return len(older)


def drop_oldest(items: OrderedDict[int, Item], capacity: int) -> int:
    """Remove the oldest items until `capacity` are left; return how many were removed."""
    removed = 0
    while len(items) > capacity:
        items.popitem(last=False)
        removed += 1
    return removed
