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

"""Finds the camera info that belongs to an image."""

from collections import OrderedDict
from typing import Generic, TypeVar

from lsc_pose_ros.synchronization.pairing import drop_oldest

CameraInfo = TypeVar('CameraInfo')

# So many successive camera infos can be lost before a live stream stops waiting for them.
_MOST_LOST = 3


class CameraInfos(Generic[CameraInfo]):
    """The latest camera infos by stamp.

    An image gets the camera info of its own stamp. In a recording it waits for it. In a live
    stream it waits only while recent images have had one; otherwise the infos have other stamps,
    or were published once, and the image takes the newest at once.

    Attributes:
        newest: the camera info that came last, None before the first.
    """

    def __init__(self, capacity: int, *, live: bool) -> None:
        """Start with no camera infos.

        Args:
            capacity: how many camera infos are kept.
            live: True for a live stream, False for a recording.
        """
        self._capacity = capacity
        self._live = live
        self._infos: OrderedDict[int, CameraInfo] = OrderedDict()
        self._image_stamps: OrderedDict[int, None] = OrderedDict()
        self._images_since_match = 0
        self._stamps_match = False
        self.newest: CameraInfo | None = None

    def __len__(self) -> int:
        """Return how many camera infos are kept."""
        return len(self._infos)

    def add_image(self, stamp: int) -> None:
        """Note that an image has come; `stamp` in nanoseconds."""
        if stamp in self._image_stamps:
            return
        self._image_stamps[stamp] = None
        drop_oldest(self._image_stamps, self._capacity)
        self._images_since_match += 1
        if stamp in self._infos:
            self._note_match()

    def add(self, stamp: int, info: CameraInfo) -> None:
        """Add a camera info; `stamp` in nanoseconds."""
        self.newest = info
        self._infos[stamp] = info
        self._infos.move_to_end(stamp)
        drop_oldest(self._infos, self._capacity)
        if stamp in self._image_stamps:
            self._note_match()

    def find(self, stamp: int) -> CameraInfo | None:
        """Return the camera info for the image with `stamp`, None if it should wait for it."""
        own = self._infos.get(stamp)
        return self.newest if own is None and not self._expects_own else own

    def forget_stamps(self) -> None:
        """Forget all stamps, because the next ones do not follow them; keep the newest info.

        It may have come before the first image after the jump, to which it belongs.
        """
        while len(self._infos) > 1:
            self._infos.popitem(last=False)
        self._image_stamps.clear()

    @property
    def _expects_own(self) -> bool:
        lapsed = self._images_since_match > _MOST_LOST
        return not self._live or (self._stamps_match and not lapsed)

    def _note_match(self) -> None:
        """Note that an image and a camera info have the same stamp."""
        self._stamps_match = self._images_since_match <= _MOST_LOST
        self._images_since_match = 0
