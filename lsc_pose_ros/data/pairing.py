"""Depth image and mask of the same moment, found by their stamps in bounded memory."""

from collections import OrderedDict
from typing import Generic, TypeVar

DepthItem = TypeVar('DepthItem')
MaskItem = TypeVar('MaskItem')


class Pairing(Generic[DepthItem, MaskItem]):
    """Joins two streams by stamp. The items may be anything; they are only handed through.

    What finds no partner before `capacity` newer items of its kind have come is dropped.

    Attributes:
        dropped_depth: depth images that found no mask.
        dropped_mask: masks that found no depth image.
        duplicates: items left out because their stamp had been there already.
    """

    def __init__(self, *, slop_ns: int = 0, capacity: int = 100) -> None:
        """Make an empty pairing.

        Args:
            slop_ns: how far apart, in nanoseconds, the stamps of a pair may be; 0 asks for equal
                stamps. It must stay below half the time between two images, or an image may
                find its neighbour's mask.
            capacity: how many items of each kind may wait for a partner.
        """
        self._slop = slop_ns
        self._capacity = capacity
        self._depth: OrderedDict[int, DepthItem] = OrderedDict()
        self._mask: OrderedDict[int, MaskItem] = OrderedDict()
        self._paired_depth: OrderedDict[int, None] = OrderedDict()
        self._paired_mask: OrderedDict[int, None] = OrderedDict()
        self.dropped_depth = 0
        self.dropped_mask = 0
        self.duplicates = 0

    @property
    def waiting_depth(self) -> int:
        """How many depth images have no mask yet."""
        return len(self._depth)

    @property
    def waiting_mask(self) -> int:
        """How many masks have no depth image yet."""
        return len(self._mask)

    def add_depth(self, stamp: int, item: DepthItem) -> list[tuple[int, DepthItem, MaskItem]]:
        """Take a depth image; return the pair (stamp, depth, mask) that it completes, if any.

        Args:
            stamp: nanoseconds.
            item: whatever stands for the image.
        """
        if stamp in self._depth or stamp in self._paired_depth:
            self.duplicates += 1
            return []
        partner = _nearest(self._mask, stamp, self._slop)
        if partner is None:
            self._depth[stamp] = item
            self.dropped_depth += _shorten(self._depth, self._capacity)
            return []
        self._remember(stamp, partner)
        return [(stamp, item, self._mask.pop(partner))]

    def add_mask(self, stamp: int, item: MaskItem) -> list[tuple[int, DepthItem, MaskItem]]:
        """Take a mask; return the pair (the depth's stamp, depth, mask) that it completes, if any.

        Args:
            stamp: nanoseconds.
            item: whatever stands for the mask.
        """
        if stamp in self._mask or stamp in self._paired_mask:
            self.duplicates += 1
            return []
        partner = _nearest(self._depth, stamp, self._slop)
        if partner is None:
            self._mask[stamp] = item
            self.dropped_mask += _shorten(self._mask, self._capacity)
            return []
        self._remember(partner, stamp)
        return [(partner, self._depth.pop(partner), item)]

    def finish(self) -> None:
        """Count what still waits as dropped: nothing more will come."""
        self.dropped_depth += len(self._depth)
        self.dropped_mask += len(self._mask)
        self._depth.clear()
        self._mask.clear()

    def _remember(self, depth_stamp: int, mask_stamp: int) -> None:
        """Keep the last pairs' stamps, so that a repeated image does not wait for ever."""
        self._paired_depth[depth_stamp] = None
        self._paired_mask[mask_stamp] = None
        _shorten(self._paired_depth, self._capacity)
        _shorten(self._paired_mask, self._capacity)


def _nearest(waiting: OrderedDict[int, MaskItem], stamp: int, slop: int) -> int | None:
    if stamp in waiting:
        return stamp
    if slop == 0 or not waiting:
        return None
    nearest = min(waiting, key=lambda other: abs(other - stamp))
    return nearest if abs(nearest - stamp) <= slop else None


def _shorten(items: OrderedDict[int, MaskItem], capacity: int) -> int:
    """Remove the oldest of `items` until they fit; return how many were removed."""
    removed = 0
    while len(items) > capacity:
        items.popitem(last=False)
        removed += 1
    return removed
