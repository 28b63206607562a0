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

"""A frame with two bodies in front of a wall."""

import numpy as np

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.skeletons import Skeletons

CAMERA = Intrinsics(100.0, 100.0, 50.0, 40.0)


def frame(ground_truth: Skeletons | None = None) -> Frame:
    """Two bodies of 10 x 20 and 10 x 30 pixels in front of a wall."""
    depth = np.full((80, 100), 5.0, np.float32)
    labels = np.full((80, 100), NO_BODY, np.int32)
    depth[20:40, 10:20], labels[20:40, 10:20] = 2.0, 1
    depth[20:50, 60:70], labels[20:50, 60:70] = 3.0, 7
    depth[0] = 0
    return Frame(0, '', depth, labels, CAMERA, ground_truth)
