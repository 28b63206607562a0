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

"""The motion capture clips of a folder, read and analysed on demand."""

from collections import OrderedDict
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.geometry.rotations import from_quaternions
from lsc_pose_ros.synthetic.mocap.distinct_poses import distinct_poses, reference_joints
from lsc_pose_ros.synthetic.mocap.mocap_clip import MocapClip, read_clip
from lsc_pose_ros.synthetic.mocap.mocap_mapping import MocapMapping

MIN_DIFFERENCE = 0.05
"""Smallest distance of the farthest joint between any two distinct poses of a clip, metres.

As in J. Shotton et al., Real-time human pose recognition in parts from single depth images, 2011.
"""

_CACHED_CLIPS = 256
"""Number of clips that are kept in memory."""


class ClipLibrary:
    """The clips in a folder and its subfolders; each is read when it is needed."""

    def __init__(self, folder: Path, files: Mapping[str, Path], mapping: MocapMapping) -> None:
        """Use the clips `files`, by name, in `folder` with one mapping for all."""
        self.folder = folder
        self.files = files
        self._mapping = mapping
        self._cache: OrderedDict[str, CachedClip] = OrderedDict()

    def clip(self, name: str) -> 'CachedClip':
        """Return a clip, from the cache if possible."""
        if name not in self._cache:
            self._cache[name] = CachedClip(read_clip(self.files[name], self._mapping))
            if len(self._cache) > _CACHED_CLIPS:
                self._cache.popitem(last=False)
        self._cache.move_to_end(name)
        return self._cache[name]


class CachedClip:
    """A clip with the results of its analysis."""

    def __init__(self, clip: MocapClip) -> None:
        """Analyse `clip` on demand."""
        self.clip = clip

    @cached_property
    def reference_joints(self) -> NDArray[np.float64]:
        """The joints of an average person in each frame, metres, shape (T, 14, 3)."""
        return reference_joints(from_quaternions(self.clip.orientations.astype(np.float64)))

    @cached_property
    def distinct(self) -> NDArray[np.intp]:
        """The valid frames whose poses differ from each other by at least `MIN_DIFFERENCE`."""
        return distinct_poses(
            self.reference_joints, np.flatnonzero(self.clip.valid), MIN_DIFFERENCE
        )

    @cached_property
    def runs(self) -> list[tuple[int, int]]:
        """Runs of valid frames, as first and one past the last, the longest first."""
        edges = np.flatnonzero(np.diff(np.concatenate([[0], self.clip.valid, [0]])))
        runs = [(int(first), int(last)) for first, last in edges.reshape(-1, 2)]
        return sorted(runs, key=lambda run: run[0] - run[1])
