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

"""A frame: depth in metres, the label image and the camera."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.skeletons import Skeletons

NO_BODY = -1
"""The label of a pixel that shows no body."""


class Frame(NamedTuple):
    """A depth image with its label image, its camera and, if known, its ground truth.

    Attributes:
        stamp: the stamp of the depth image, nanoseconds.
        frame_id: the name of the camera's optical frame (REP-103).
        depth: metres, 0 if the sensor measured nothing, shape (H, W), float32.
        labels: the number of the body that a pixel shows, or NO_BODY, shape (H, W), int32.
        camera: the intrinsics of the depth image.
        ground_truth: the labelled skeletons, or None.
        roll: by how many degrees the camera is turned clockwise, seen from behind it: 0, 90, 180
            or 270. All other attributes are those of the upright image;
            `lsc_pose_ros.camera.roll.in_camera_frame` turns joints back.
        from_mask: whether the labels are those of a mask image; if not, bodies are numbered anew
            in each frame.
    """

    stamp: int
    frame_id: str
    depth: NDArray[np.float32]
    labels: NDArray[np.int32]
    camera: Intrinsics
    ground_truth: Skeletons | None
    roll: int = 0
    from_mask: bool = True
