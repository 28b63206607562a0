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

"""Synchronizes live streams, and counts what comes, what is missing and what is out of order."""

from collections.abc import Callable
from typing import Generic

from lsc_pose_ros.synchronization.frame_loss import FrameLoss
from lsc_pose_ros.synchronization.synchronizer import (
    CameraInfo,
    Depth,
    DropCounts,
    Mask,
    SynchronizedFrame,
    Synchronizer,
    SynchronizerSettings,
)

# A depth image this much older than the newest one means that its source has started over.
REWIND_NS = 500_000_000


class LiveSynchronizer(Generic[Depth, Mask, CameraInfo]):
    """Delivers frames with increasing stamps, until the source of the depth images starts over.

    Attributes:
        depth: number of depth images.
        masks: number of masks.
        camera_infos: number of camera infos.
        rewinds: how often the stamps of the depth images went back, as when a recording is
            played again.
        out_of_order: number of depth images and masks that came after a newer one.
    """

    def __init__(
        self,
        settings: SynchronizerSettings,
        deliver: Callable[[SynchronizedFrame[Depth, Mask, CameraInfo, None]], None],
    ) -> None:
        """Start with no items.

        Args:
            settings: of the synchronizer; `live` is set.
            deliver: called with each frame.
        """
        self._synchronizer: Synchronizer[Depth, Mask, CameraInfo, None] = Synchronizer(
            settings._replace(live=True)
        )
        self._deliver = deliver
        self._frame_loss = FrameLoss()
        self._newest_depth = self._newest_mask = 0
        self.depth = 0
        self.masks = 0
        self.camera_infos = 0
        self.rewinds = 0
        self.out_of_order = 0

    @property
    def pairs(self) -> int:
        """Number of depth images that have got their mask, or need none."""
        return self._synchronizer.pairs

    @property
    def missing(self) -> int:
        """Number of depth images that are missing, according to the gaps between stamps."""
        return self._frame_loss.missing

    @property
    def dropped(self) -> DropCounts:
        """Numbers of images that were left out, by reason."""
        return self._synchronizer.dropped

    @property
    def slop_ns(self) -> int:
        """The largest difference between the stamps of a pair, nanoseconds; can be changed."""
        return self._synchronizer.slop_ns

    @slop_ns.setter
    def slop_ns(self, slop_ns: int) -> None:
        self._synchronizer.slop_ns = slop_ns

    @property
    def with_masks(self) -> bool:
        """Whether depth images wait for their masks; can be changed.

        When they no longer wait, those that did are delivered without a mask.
        """
        return self._synchronizer.with_masks

    @with_masks.setter
    def with_masks(self, with_masks: bool) -> None:
        self._deliver_all(self._synchronizer.use_masks(with_masks=with_masks))

    def add_depth(self, stamp: int, depth: Depth) -> None:
        """Add a depth image; `stamp` in nanoseconds."""
        self.depth += 1
        if stamp < self._newest_depth - REWIND_NS:
            self._restart()
        if stamp > self._newest_depth:
            self._newest_depth = stamp
            self._frame_loss.add(stamp)
        elif stamp < self._newest_depth:
            self.out_of_order += 1
        self._deliver_all(self._synchronizer.add_depth(stamp, depth))

    def add_mask(self, stamp: int, mask: Mask) -> None:
        """Add a mask; `stamp` in nanoseconds."""
        self.masks += 1
        if stamp < self._newest_mask:
            self.out_of_order += 1
        self._newest_mask = max(self._newest_mask, stamp)
        self._deliver_all(self._synchronizer.add_mask(stamp, mask))

    def add_camera_info(self, stamp: int, info: CameraInfo) -> None:
        """Add a camera info; `stamp` in nanoseconds."""
        self.camera_infos += 1
        self._deliver_all(self._synchronizer.add_camera_info(stamp, info))

    def _restart(self) -> None:
        self.rewinds += 1
        self._deliver_all(self._synchronizer.restart())
        self._frame_loss.restart()
        self._newest_depth = self._newest_mask = 0

    def _deliver_all(self, frames: list[SynchronizedFrame[Depth, Mask, CameraInfo, None]]) -> None:
        for frame in frames:
            self._deliver(frame)
