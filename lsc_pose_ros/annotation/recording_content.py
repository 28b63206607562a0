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

"""Tells recordings apart by what they contain, whatever the names of their files."""

import hashlib

import numpy as np

from lsc_pose_ros.data_types.frame import Frame


class RecordingContent:
    """What is known of the content of a recording while its frames are read.

    Attributes:
        stamps: of all frames, nanoseconds.
    """

    def __init__(self) -> None:
        """Know nothing yet."""
        self.stamps: list[int] = []
        self._ends: list[Frame] = []

    def add(self, frame: Frame) -> None:
        """Add the next frame."""
        self.stamps.append(frame.stamp)
        self._ends = [*self._ends[:1], frame]

    def hash(self) -> str:
        """Return a hash of all stamps, and of the first and the last depth image."""
        content = hashlib.sha256(str(self.stamps).encode())
        for frame in self._ends:
            content.update(f'{frame.depth.shape}'.encode())
            content.update(np.ascontiguousarray(frame.depth, '<f4').tobytes())
        return content.hexdigest()
