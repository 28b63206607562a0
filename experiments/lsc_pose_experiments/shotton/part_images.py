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

"""Bodies as images of their own, and the body part at each pixel of a labelled body."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.shotton.part_labels import parts_at
from lsc_pose_experiments.shotton.part_samples import PartImage
from lsc_pose_ros.body_parts.classes import NOT_A_PERSON
from lsc_pose_ros.camera.projection import back_project
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.image_arguments import ImageArguments
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.pose.silhouette.silhouette import cut_out
from lsc_pose_ros.training.samples import select_joints


def body_image(images: ImageArguments, body: int) -> tuple[NDArray[np.float32], Intrinsics] | None:
    """Return the depth image of one body alone, and the intrinsics of that image.

    The image is as large as the body. All other pixels have depth 0, so a probe beyond the
    outline finds a large constant depth (Shotton et al., section 3.1).

    Args:
        images: depth, labels and camera.
        body: the number of the body.

    Returns:
        None if no pixel of the body has a depth.
    """
    window = cut_out(images.depth, images.labels, body)
    if window is None:
        return None
    camera = images.camera
    moved = camera._replace(cx=camera.cx - window.column, cy=camera.cy - window.row)
    return np.where(np.isfinite(window.depth), window.depth, np.float32(0)), moved


def part_images(frame: Frame) -> Iterator[PartImage]:
    """Yield the labelled bodies of `frame` with the body part at each pixel."""
    if frame.ground_truth is None:
        return
    images = ImageArguments(frame.depth, frame.labels, frame.camera)
    every_joint = np.arange(len(JOINT_NAMES), dtype=np.uint16)
    positions = select_joints(frame.ground_truth, every_joint)
    for row, body in enumerate(frame.ground_truth.bodies.tolist()):
        cut = body_image(images, body)
        if cut is None:
            continue
        depth, camera = cut
        rows, columns = np.nonzero(depth)
        points = back_project(columns, rows, depth[rows, columns], camera)
        parts = np.full(depth.shape, NOT_A_PERSON, np.uint8)
        parts[rows, columns] = parts_at(points, positions[row])
        yield PartImage(depth, parts, camera)
