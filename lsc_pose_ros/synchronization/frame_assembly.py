"""Depth, mask, camera and truth put together into frames, by stamp and in bounded memory."""

from collections import OrderedDict, deque
from dataclasses import dataclass
from typing import Generic, TypeVar

from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.messages.parse import StampedCamera
from lsc_pose_ros.synchronization.pairing import Pairing

Item = TypeVar('Item')


@dataclass
class Assembled(Generic[Item]):
    """What belongs to one stamp.

    Attributes:
        stamp: the depth image's, nanoseconds.
        depth: whatever stands for the depth image.
        mask: whatever stands for the mask, None where there is none.
        camera: the camera info of the same stamp, or else the last one before.
        ground_truth: the labelled skeletons of the same stamp, None where there are none.
    """

    stamp: int
    depth: Item
    mask: Item | None
    camera: StampedCamera | None = None
    ground_truth: Skeletons | None = None
    camera_settled: bool = False
    ground_truth_settled: bool = False

    @property
    def settled(self) -> bool:
        """Whether nothing better can come."""
        return self.camera_settled and self.ground_truth_settled


class Assembly(Generic[Item]):
    """Puts frames together; each method returns the frames that are complete, in order.

    A frame waits until its camera info and truth have come, or newer ones have, or `capacity`
    newer frames wait; so a camera info that comes once only, or after the images, is found too.

    Attributes:
        pairing: how depth images and masks were joined; its counters say what found no partner.
        without_camera: frames dropped because no camera info had come for so long.
    """

    def __init__(self, *, with_mask: bool, with_ground_truth: bool, capacity: int = 30) -> None:
        """Make an empty assembly.

        Args:
            with_mask: whether masks will come; otherwise frames do not wait for one.
            with_ground_truth: whether ground truth will come.
            capacity: how many frames may wait.
        """
        self.pairing: Pairing[Item, Item] = Pairing()
        self.without_camera = 0
        self._with_mask = with_mask
        self._with_ground_truth = with_ground_truth
        self._capacity = capacity
        self._waiting: deque[Assembled[Item]] = deque()
        self._cameras: OrderedDict[int, StampedCamera] = OrderedDict()
        self._truths: OrderedDict[int, Skeletons] = OrderedDict()
        self._last_camera: StampedCamera | None = None

    def add_depth(self, stamp: int, item: Item) -> list[Assembled[Item]]:
        """Take a depth image."""
        if not self._with_mask:
            return self._add_pair(stamp, item, None)
        return [
            frame
            for pair in self.pairing.add_depth(stamp, item)
            for frame in self._add_pair(*pair)
        ]

    def add_mask(self, stamp: int, item: Item) -> list[Assembled[Item]]:
        """Take a mask."""
        return [
            frame for pair in self.pairing.add_mask(stamp, item) for frame in self._add_pair(*pair)
        ]

    def add_camera(self, info: StampedCamera) -> list[Assembled[Item]]:
        """Take a camera info."""
        for frame in self._waiting:
            if frame.camera_settled or frame.stamp > info.stamp:
                continue
            exact = frame.stamp == info.stamp or self._last_camera is None
            frame.camera = info if exact else self._last_camera
            frame.camera_settled = True
        self._last_camera = info
        _keep(self._cameras, info.stamp, info, 2 * self._capacity)
        return self._release()

    def add_ground_truth(self, stamp: int, skeletons: Skeletons) -> list[Assembled[Item]]:
        """Take labelled skeletons."""
        for frame in self._waiting:
            if frame.ground_truth_settled or frame.stamp > stamp:
                continue
            frame.ground_truth = skeletons if frame.stamp == stamp else None
            frame.ground_truth_settled = True
        _keep(self._truths, stamp, skeletons, 2 * self._capacity)
        return self._release()

    def finish(self) -> list[Assembled[Item]]:
        """Return what still waits: nothing more will come."""
        self.pairing.finish()
        for frame in self._waiting:
            frame.camera_settled = frame.ground_truth_settled = True
        return self._release()

    def _add_pair(self, stamp: int, depth: Item, mask: Item | None) -> list[Assembled[Item]]:
        camera, ground_truth = self._cameras.get(stamp), self._truths.get(stamp)
        self._waiting.append(
            Assembled(
                stamp,
                depth,
                mask,
                camera,
                ground_truth,
                camera_settled=camera is not None,
                ground_truth_settled=ground_truth is not None or not self._with_ground_truth,
            )
        )
        return self._release()

    def _release(self) -> list[Assembled[Item]]:
        complete = []
        while self._waiting and (self._waiting[0].settled or len(self._waiting) > self._capacity):
            frame = self._waiting.popleft()
            frame.camera = frame.camera or self._last_camera
            if frame.camera is None:
                self.without_camera += 1
            else:
                complete.append(frame)
        return complete


def _keep(items: OrderedDict[int, Item], stamp: int, item: Item, capacity: int) -> None:
    items[stamp] = item
    while len(items) > capacity:
        items.popitem(last=False)
