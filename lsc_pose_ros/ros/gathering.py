"""Depth images, masks and camera infos joined into what the method needs; no ROS in here."""

from collections.abc import Callable
from typing import Generic, NamedTuple, TypeVar

from lsc_pose_ros.data.pairing import Pairing

Depth = TypeVar('Depth')
Mask = TypeVar('Mask')
CameraInfo = TypeVar('CameraInfo')

# A depth image this much older than the newest one: its source has begun again.
REWIND_NS = 500_000_000


class PairingSettings(NamedTuple):
    """How depth images and masks find each other.

    Attributes:
        slop_ns: how far apart, in nanoseconds, the stamps of a pair may be.
        capacity: how many of each kind wait for a partner.
    """

    slop_ns: int
    capacity: int


class Gathering(Generic[Depth, Mask, CameraInfo]):
    """Joins three streams: depth and mask by stamp, and with them the newest camera info.

    A pair that comes before any camera info waits for it, but only the newest such pair.

    Attributes:
        depth: how many depth images have come.
        masks: how many masks.
        camera_infos: how many camera infos.
        pairs: how many depth images have found their mask.
        rewinds: how often the depth images' stamps went back, as when a recording is repeated.
    """

    def __init__(
        self, settings: PairingSettings, deliver: Callable[[Depth, Mask, CameraInfo], None]
    ) -> None:
        """Start with nothing.

        Args:
            settings: of the pairing.
            deliver: called with each depth image, its mask and the camera info.
        """
        self._settings = settings
        self._deliver = deliver
        self._pairing = self._new_pairing()
        self._newest = 0
        self._camera_info: CameraInfo | None = None
        self._without_camera: tuple[Depth, Mask] | None = None
        self.depth = 0
        self.masks = 0
        self.camera_infos = 0
        self.pairs = 0
        self.rewinds = 0

    def add_depth(self, stamp: int, image: Depth) -> None:
        """Take a depth image; `stamp` in nanoseconds."""
        self.depth += 1
        if stamp < self._newest - REWIND_NS:
            self.rewinds += 1
            self._pairing = self._new_pairing()
            self._newest = stamp
        self._newest = max(self._newest, stamp)
        for _, depth, mask in self._pairing.add_depth(stamp, image):
            self._add_pair(depth, mask)

    def add_mask(self, stamp: int, image: Mask) -> None:
        """Take a mask; `stamp` in nanoseconds."""
        self.masks += 1
        for _, depth, mask in self._pairing.add_mask(stamp, image):
            self._add_pair(depth, mask)

    def add_camera_info(self, info: CameraInfo) -> None:
        """Take a camera info."""
        self.camera_infos += 1
        self._camera_info = info
        if self._without_camera is not None:
            waiting, self._without_camera = self._without_camera, None
            self._deliver(*waiting, info)

    def _add_pair(self, depth: Depth, mask: Mask) -> None:
        self.pairs += 1
        if self._camera_info is None:
            self._without_camera = (depth, mask)
        else:
            self._deliver(depth, mask, self._camera_info)

    def _new_pairing(self) -> Pairing[Depth, Mask]:
        return Pairing(slop_ns=self._settings.slop_ns, capacity=self._settings.capacity)
