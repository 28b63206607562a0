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

"""Labels whose sides are exchanged, or whose x axis is that of a mirrored image."""

from collections.abc import Sequence

import numpy as np

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.labels.tracks import LabelSource

NAMES, X = 'names', 'x'

MIRRORS = {NAMES: 'exchange left and right', X: 'negate x'}
"""What can be undone."""

_OTHER_SIDE = [
    JOINT_NUMBERS[{'l_': 'r_', 'r_': 'l_'}.get(name[:2], name[:2]) + name[2:]]
    for name in JOINT_NAMES
]


class MirroredLabels:
    """The labels of another source, mirrored."""

    def __init__(self, source: LabelSource, mirror: str) -> None:
        """Mirror `source` as MIRRORS says."""
        self._source = source
        self._mirror = mirror

    @property
    def warnings(self) -> Sequence[str]:
        """Those of the other source."""
        return self._source.warnings

    def at(self, number: int, frame: Frame) -> Skeletons:
        """Return the labelled bodies of a frame; as `LabelSource.at`."""
        skeletons = self._source.at(number, frame)
        if self._mirror == NAMES:
            return skeletons._replace(
                positions=skeletons.positions[:, _OTHER_SIDE],
                confidence=skeletons.confidence[:, _OTHER_SIDE],
            )
        flipped = skeletons.positions * np.array([-1, 1, 1], np.float32)
        return skeletons._replace(positions=flipped)

    def why_none(self, number: int, frame: Frame) -> str:
        """Return why a frame has no label; as `LabelSource.why_none`."""
        return self._source.why_none(number, frame)
