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

"""Joins depth images, masks, camera infos and ground truth by stamp, live and from recordings."""

from collections import OrderedDict, deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar

from lsc_pose_ros.synchronization.camera_infos import CameraInfos
from lsc_pose_ros.synchronization.pairing import Pairing, drop_oldest

Depth = TypeVar('Depth')
Mask = TypeVar('Mask')
CameraInfo = TypeVar('CameraInfo')
GroundTruth = TypeVar('GroundTruth')

_BEFORE_ALL = -(1 << 63)


class SynchronizerSettings(NamedTuple):
    """Settings of a Synchronizer.

    Attributes:
        slop_ns: the largest difference between the stamps of a depth image and its mask,
            nanoseconds.
        capacity: how many depth images, and how many masks, wait for their partner.
        waiting: how many frames wait for their camera info and ground truth.
        with_masks: False if there are no masks: frames do not wait for one.
        with_ground_truth: False if there is no ground truth: frames do not wait for it.
        live: True for frames with increasing stamps, as soon as possible: a late image is left
            out, and a frame takes the newest camera info if the infos have other stamps than the
            images. False for all frames of a recording, however long they wait.
    """

    slop_ns: int = 0
    capacity: int = 100
    waiting: int = 30
    with_masks: bool = True
    with_ground_truth: bool = False
    live: bool = False


class DropCounts(NamedTuple):
    """How many images were left out, by reason.

    Attributes:
        unmatched_depth: depth images without a mask; normal if masks have a lower rate.
        unmatched_masks: masks without a depth image.
        duplicates: images that repeat the stamp of another.
        late: images older than a frame that was already released; only live.
    """

    unmatched_depth: int = 0
    unmatched_masks: int = 0
    duplicates: int = 0
    late: int = 0


@dataclass(frozen=True)
class SynchronizedFrame(Generic[Depth, Mask, CameraInfo, GroundTruth]):
    """The parts of one frame; `stamp` is the depth image's, nanoseconds."""

    stamp: int
    depth: Depth
    mask: Mask | None
    camera_info: CameraInfo
    ground_truth: GroundTruth | None


@dataclass
class _WaitingFrame(Generic[Depth, Mask, CameraInfo, GroundTruth]):
    stamp: int
    depth: Depth
    mask: Mask | None
    camera_info: CameraInfo | None = None
    ground_truth: GroundTruth | None = None
    needs_ground_truth: bool = False

    @property
    def complete(self) -> bool:
        return self.camera_info is not None and not self.needs_ground_truth


class Synchronizer(Generic[Depth, Mask, CameraInfo, GroundTruth]):
    """Joins four streams in bounded memory. The items may be of any type.

    Each `add_` method and `finish` return the frames that have become complete, in the order in
    which depth images and masks were paired.

    A frame waits for the camera info and the ground truth of its own stamp until they come, or
    newer ones come, or `waiting` newer frames wait. Without an own camera info it gets the last
    one that came before the newer one, or the first of all; so one camera info is enough for a
    whole recording. See `CameraInfos` for live streams.

    Attributes:
        pairs: how many depth images have got their mask, or need none.
        without_camera_info: frames that were dropped because no camera info had come.
    """

    def __init__(
        self,
        settings: SynchronizerSettings,
        find_first_info: Callable[[], CameraInfo | None] | None = None,
    ) -> None:
        """Start with no items.

        Args:
            settings: the settings.
            find_first_info: returns the first camera info that will come, None if there is none;
                called at most once, for frames before it. None if the future is unknown.
        """
        self._settings = settings
        self._find_first_info = find_first_info
        self._future_info: CameraInfo | None = None
        self._last_stamp = _BEFORE_ALL
        self._pairing: Pairing[Depth, Mask] = self._new_pairing()
        self._waiting: deque[_WaitingFrame[Depth, Mask, CameraInfo, GroundTruth]] = deque()
        self._camera_infos: CameraInfos[CameraInfo] = CameraInfos(
            2 * settings.capacity, live=settings.live
        )
        self._ground_truths: OrderedDict[int, GroundTruth] = OrderedDict()
        self._dropped_before = DropCounts()
        self.pairs = 0
        self.without_camera_info = 0

    @property
    def dropped(self) -> DropCounts:
        """How many images were left out."""
        pairing, before = self._pairing, self._dropped_before
        return DropCounts(
            before.unmatched_depth + pairing.dropped_depth,
            before.unmatched_masks + pairing.dropped_mask,
            before.duplicates + pairing.duplicates,
            before.late + pairing.late,
        )

    @property
    def slop_ns(self) -> int:
        """The largest difference between the stamps of a pair, nanoseconds; can be changed."""
        return self._settings.slop_ns

    @slop_ns.setter
    def slop_ns(self, slop_ns: int) -> None:
        self._settings = self._settings._replace(slop_ns=slop_ns)
        self._pairing.slop_ns = slop_ns

    @property
    def with_masks(self) -> bool:
        """Whether depth images wait for their masks."""
        return self._settings.with_masks

    def use_masks(
        self, *, with_masks: bool
    ) -> list[SynchronizedFrame[Depth, Mask, CameraInfo, GroundTruth]]:
        """Let depth images wait for masks from now on, or no longer.

        Args:
            with_masks: whether they wait. If not, the images that wait become frames without a
                mask.
        """
        if with_masks == self._settings.with_masks:
            return []
        self._settings = self._settings._replace(with_masks=with_masks)
        waiting = self._pairing.take_depth()
        self._pairing.finish()
        self._last_stamp = max(self._last_stamp, self._pairing.last_depth)
        self._dropped_before = self.dropped
        self._pairing = self._new_pairing()
        return [frame for stamp, depth in waiting for frame in self.add_depth(stamp, depth)]

    def add_depth(
        self, stamp: int, depth: Depth
    ) -> list[SynchronizedFrame[Depth, Mask, CameraInfo, GroundTruth]]:
        """Add a depth image; `stamp` in nanoseconds."""
        self._camera_infos.add_image(stamp)
        if self._settings.with_masks:
            return self._add_pairs(self._pairing.add_depth(stamp, depth))
        if self._settings.live and not self._is_newer(stamp):
            return self._release()
        return self._add_pairs([(stamp, depth, None)])

    def add_mask(
        self, stamp: int, mask: Mask
    ) -> list[SynchronizedFrame[Depth, Mask, CameraInfo, GroundTruth]]:
        """Add a mask; `stamp` in nanoseconds."""
        return self._add_pairs(self._pairing.add_mask(stamp, mask))

    def add_camera_info(
        self, stamp: int, info: CameraInfo
    ) -> list[SynchronizedFrame[Depth, Mask, CameraInfo, GroundTruth]]:
        """Add a camera info; `stamp` in nanoseconds."""
        previous = self._camera_infos.newest
        self._camera_infos.add(stamp, info)
        for frame in self._waiting:
            if frame.camera_info is None and frame.stamp < stamp:
                frame.camera_info = info if previous is None else previous
        return self._release()

    def add_ground_truth(
        self, stamp: int, ground_truth: GroundTruth
    ) -> list[SynchronizedFrame[Depth, Mask, CameraInfo, GroundTruth]]:
        """Add ground truth; `stamp` in nanoseconds."""
        for frame in self._waiting:
            if frame.needs_ground_truth and frame.stamp <= stamp:
                frame.ground_truth = ground_truth if frame.stamp == stamp else None
                frame.needs_ground_truth = False
        self._ground_truths[stamp] = ground_truth
        drop_oldest(self._ground_truths, 2 * self._settings.capacity)
        return self._release()

    def finish(self) -> list[SynchronizedFrame[Depth, Mask, CameraInfo, GroundTruth]]:
        """Return the frames that still wait, because nothing more will come."""
        frames = self._add_pairs(self._pairing.finish())
        return frames + self._release(0)

    def restart(self) -> list[SynchronizedFrame[Depth, Mask, CameraInfo, GroundTruth]]:
        """Return the frames that still wait, and forget all stamps, for streams that start over.

        The newest camera info and the counts are kept.
        """
        frames = self.finish()
        self._dropped_before = self.dropped
        self._last_stamp = _BEFORE_ALL
        self._pairing = self._new_pairing()
        self._camera_infos.forget_stamps()
        self._ground_truths.clear()
        return frames

    def _first_info(self) -> CameraInfo | None:
        """Return the first camera info of the future, None if there is none or it is unknown."""
        if self._find_first_info is not None:
            self._future_info = self._find_first_info()
            self._find_first_info = None
        return self._future_info

    def _new_pairing(self) -> Pairing[Depth, Mask]:
        settings = self._settings
        return Pairing(
            slop_ns=settings.slop_ns,
            capacity=settings.capacity,
            in_order=settings.live,
            last_depth=self._last_stamp,
        )

    def _is_newer(self, stamp: int) -> bool:
        """Return whether a depth image without mask is newer than the last one; else count it."""
        before = self._dropped_before
        if stamp == self._last_stamp:
            self._dropped_before = before._replace(duplicates=before.duplicates + 1)
        elif stamp < self._last_stamp:
            self._dropped_before = before._replace(late=before.late + 1)
        else:
            self._last_stamp = stamp
            return True
        return False

    def _add_pairs(
        self, pairs: list[tuple[int, Depth, Mask]] | list[tuple[int, Depth, None]]
    ) -> list[SynchronizedFrame[Depth, Mask, CameraInfo, GroundTruth]]:
        released = self._release()
        for stamp, depth, mask in pairs:
            self.pairs += 1
            ground_truth = self._ground_truths.get(stamp)
            needed = self._settings.with_ground_truth and ground_truth is None
            self._waiting.append(
                _WaitingFrame(
                    stamp, depth, mask, ground_truth=ground_truth, needs_ground_truth=needed
                )
            )
            released += self._release()
        return released

    def _release(
        self, most_waiting: int | None = None
    ) -> list[SynchronizedFrame[Depth, Mask, CameraInfo, GroundTruth]]:
        """Return the frames that need to wait no longer.

        Args:
            most_waiting: how many frames may wait; None for the settings.
        """
        if most_waiting is None:
            # Without any camera info, which may never come, a live stream keeps the newest frame.
            no_info = self._settings.live and self._camera_infos.newest is None
            most_waiting = 1 if no_info else self._settings.waiting
        for frame in self._waiting:
            if frame.camera_info is None:
                frame.camera_info = self._camera_infos.find(frame.stamp)
        released = []
        while self._waiting and (self._waiting[0].complete or len(self._waiting) > most_waiting):
            frame = self._waiting.popleft()
            info = self._camera_infos.newest if frame.camera_info is None else frame.camera_info
            if info is None:
                info = self._first_info()
            if info is None:
                self.without_camera_info += 1
            else:
                released.append(
                    SynchronizedFrame(
                        frame.stamp, frame.depth, frame.mask, info, frame.ground_truth
                    )
                )
        return released
