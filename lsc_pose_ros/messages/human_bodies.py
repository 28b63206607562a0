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

"""The bodies of an image as ROS4HRI (REP-155) describes them: ids, regions and keypoints."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.camera.roll import upright_camera
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.data_types.skeletons import Skeletons

KEYPOINTS: tuple[str, ...] = (
    'nose', 'neck', 'r_shoulder', 'r_elbow', 'r_wrist', 'l_shoulder', 'l_elbow', 'l_wrist',
    'r_hip', 'r_knee', 'r_ankle', 'l_hip', 'l_knee', 'l_ankle', 'l_eye', 'r_eye', 'l_ear', 'r_ear',
)  # fmt: skip
"""The points of a hri_msgs/Skeleton2D in their order; nose, eyes and ears are no joints here."""


class BodyImage(NamedTuple):
    """The image in which the bodies of a frame were found, as the camera took it.

    Attributes:
        labels: the label of each pixel, shape (H, W).
        camera: the intrinsics.
        labels_of: the label of each body, by the number with which it is published.
    """

    labels: NDArray[np.int32]
    camera: Intrinsics
    labels_of: dict[int, int]

    @classmethod
    def of(cls, frame: Frame, labels_of: dict[int, int]) -> 'BodyImage':
        """Return the image of a frame; a frame's own is upright.

        Args:
            frame: the frame.
            labels_of: as the attribute.
        """
        height, width = frame.depth.shape
        camera = upright_camera(frame.camera, height, width, -frame.roll % 360)
        return cls(np.rot90(frame.labels, frame.roll // 90), camera, labels_of)


class Region(NamedTuple):
    """A rectangle in fractions of the image's width and height, from its top left corner."""

    xmin: float
    ymin: float
    xmax: float
    ymax: float


def body_id(number: int) -> str:
    """Return the id of the body with this number.

    It is part of the names of topics, and such a part must not begin with a digit in ROS 2.
    """
    return f'b{number}'


def body_region(image: BodyImage, number: int) -> Region | None:
    """Return the smallest rectangle with all pixels of a body, or None if it has no pixel.

    Args:
        image: the image.
        number: that of the body.
    """
    label = image.labels_of.get(number)
    if label is None:
        return None
    inside = image.labels == label
    rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
    if not len(rows):
        return None
    height, width = inside.shape
    return Region(
        float(columns[0] / width),
        float(rows[0] / height),
        float((columns[-1] + 1) / width),
        float((rows[-1] + 1) / height),
    )


def keypoints(skeletons: Skeletons, image: BodyImage) -> NDArray[np.float32]:
    """Return the joints as KEYPOINTS in the image, shape (B, 18, 3): x, y and confidence.

    x and y are fractions of the image's width and height, from its top left corner. A point that
    is unknown or outside of the image is 0, 0, 0, as OpenPose has it.

    Args:
        skeletons: the bodies, in the camera's optical frame.
        image: the image.
    """
    points = np.zeros((len(skeletons.bodies), len(KEYPOINTS), 3), np.float32)
    columns = {name: column for column, name in enumerate(names_of(skeletons.joints))}
    rows = [row for row, name in enumerate(KEYPOINTS) if name in columns]
    used = [columns[KEYPOINTS[row]] for row in rows]
    height, width = image.labels.shape
    # The centre of the first pixel is 0 in pixels, and half a pixel from the corner.
    pixels = project(skeletons.positions[:, used], image.camera)
    places = (pixels + np.float32(0.5)) / np.array([width, height], np.float32)
    inside = (places >= 0) & (places <= 1)
    visible = inside[..., 0] & inside[..., 1]
    points[:, rows, :2] = np.where(visible[..., None], places, 0)
    points[:, rows, 2] = np.where(visible, skeletons.confidence[:, used], 0)
    return points
