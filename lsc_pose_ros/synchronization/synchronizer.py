"""Depth images, masks and camera infos joined into what the method needs; no ROS in here."""

from collections.abc import Callable
from typing import Generic, NamedTuple, TypeVar

from lsc_pose_ros.synchronization.frame_loss import Cadence
from lsc_pose_ros.synchronization.pairing import Pairing

Depth = TypeVar('Depth')
Mask = TypeVar('Mask')
CameraInfo = TypeVar('CameraInfo')

# A depth image this much older than the newest one: its source has begun again.
REWIND_NS = 500_000_000

_BEFORE_ALL = -1


class PairingSettings(NamedTuple):
    """How depth images and masks find each other.

    Attributes:
        slop_ns: how far apart, in nanoseconds, the stamps of a pair may be.
        capacity: how many of each kind wait for a partner.
        with_masks: whether there are masks at all; if not, each depth image is complete alone.
    """

    slop_ns: int
    capacity: int
    with_masks: bool = True


class LeftOut(NamedTuple):
    """How many images were left out, and why.

    Attributes:
        unmatched_depth: depth images for which no mask came; ordinary where masks are slower.
        unmatched_masks: masks for which no depth image came.
        duplicates: images whose stamp had been there already.
        late: images that came after a newer pair had been delivered.
    """

    unmatched_depth: int = 0
    unmatched_masks: int = 0
    duplicates: int = 0
    late: int = 0


class Gathering(Generic[Depth, Mask, CameraInfo]):
    """Joins three streams: depth and mask by stamp, and with them the newest camera info.

    Pairs are delivered with increasing stamps, so that whoever follows bodies over time never
    goes back. A pair that comes before any camera info waits for it, but only the newest does.

    Attributes:
        depth: how many depth images have come.
        masks: how many masks.
        camera_infos: how many camera infos.
        pairs: how many depth images have found their mask, or are complete without one.
        rewinds: how often the depth images' stamps went back, as when a recording is repeated.
        out_of_order: how many depth images and masks came after a newer one of their kind.
    """

    def __init__(
        self,
        settings: PairingSettings,
        deliver: Callable[[Depth, Mask | None, CameraInfo], None],
    ) -> None:
        """Start with nothing.

        Args:
            settings: of the pairing.
            deliver: called with each depth image, its mask and the camera info.
        """
        self._settings = settings
        self._deliver = deliver
        self._pairing = self._new_pairing()
        self._earlier = LeftOut()
        self._cadence = Cadence()
        self._newest_depth = self._newest_mask = 0
        self._newest_alone = _BEFORE_ALL
        self._camera_info: CameraInfo | None = None
        self._without_camera: tuple[Depth, Mask | None] | None = None
        self.depth = 0
        self.masks = 0
        self.camera_infos = 0
        self.pairs = 0
        self.rewinds = 0
        self.out_of_order = 0

    @property
    def missing(self) -> int:
        """How many depth images must be missing, by the gaps between the stamps."""
        return self._cadence.missing

    @property
    def left_out(self) -> LeftOut:
        """How many images were left out, and why."""
        pairing = self._pairing
        earlier = self._earlier
        return LeftOut(
            earlier.unmatched_depth + pairing.dropped_depth,
            earlier.unmatched_masks + pairing.dropped_mask,
            earlier.duplicates + pairing.duplicates,
            earlier.late + pairing.late,
        )

    @property
    def slop_ns(self) -> int:
        """How far apart, in nanoseconds, the stamps of a pair may be; may be changed."""
        return self._settings.slop_ns

    @slop_ns.setter
    def slop_ns(self, slop_ns: int) -> None:
        self._settings = self._settings._replace(slop_ns=slop_ns)
        self._pairing.slop_ns = slop_ns

    def add_depth(self, stamp: int, image: Depth) -> None:
        """Take a depth image; `stamp` in nanoseconds."""
        self.depth += 1
        if stamp < self._newest_depth - REWIND_NS:
            self._begin_again()
        if stamp > self._newest_depth:
            self._newest_depth = stamp
            self._cadence.add(stamp)
        elif stamp < self._newest_depth:
            self.out_of_order += 1
        if self._settings.with_masks:
            self._add_pairs(self._pairing.add_depth(stamp, image))
        else:
            self._add_alone(stamp, image)

    def add_mask(self, stamp: int, image: Mask) -> None:
        """Take a mask; `stamp` in nanoseconds."""
        self.masks += 1
        if stamp < self._newest_mask:
            self.out_of_order += 1
        self._newest_mask = max(self._newest_mask, stamp)
        self._add_pairs(self._pairing.add_mask(stamp, image))

    def add_camera_info(self, info: CameraInfo) -> None:
        """Take a camera info."""
        self.camera_infos += 1
        self._camera_info = info
        if self._without_camera is not None:
            waiting, self._without_camera = self._without_camera, None
            self._deliver(*waiting, info)

    def _add_alone(self, stamp: int, depth: Depth) -> None:
        """Take a depth image that needs no mask."""
        left_out = self._earlier
        if stamp == self._newest_alone:
            self._earlier = left_out._replace(duplicates=left_out.duplicates + 1)
        elif stamp < self._newest_alone:
            self._earlier = left_out._replace(late=left_out.late + 1)
        else:
            self._newest_alone = stamp
            self._add_pair(depth, None)

    def _add_pairs(self, pairs: list[tuple[int, Depth, Mask]]) -> None:
        for _, depth, mask in pairs:
            self._add_pair(depth, mask)

    def _add_pair(self, depth: Depth, mask: Mask | None) -> None:
        self.pairs += 1
        if self._camera_info is None:
            self._without_camera = (depth, mask)
        else:
            self._deliver(depth, mask, self._camera_info)

    def _begin_again(self) -> None:
        self.rewinds += 1
        self._pairing.finish()
        self._earlier = self.left_out
        self._pairing = self._new_pairing()
        self._cadence.restart()
        self._newest_depth = self._newest_mask = 0
        self._newest_alone = _BEFORE_ALL

    def _new_pairing(self) -> Pairing[Depth, Mask]:
        settings = self._settings
        return Pairing(slop_ns=settings.slop_ns, capacity=settings.capacity, in_order=True)
