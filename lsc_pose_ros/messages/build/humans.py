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

"""Builds the messages of ROS4HRI (REP-155) that describe bodies."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.messages.build.headers import build_header
from lsc_pose_ros.messages.human_bodies import Region
from lsc_pose_ros.messages.message_classes import MessageClasses
from lsc_pose_ros.messages.type_names import (
    IDS_LIST,
    JOINT_STATE,
    NORMALIZED_POINT,
    NORMALIZED_REGION,
    SKELETON_2D,
)


def build_ids(classes: MessageClasses, stamp: int, frame_id: str, ids: list[str]) -> Any:  # noqa: ANN401
    """Return the ids of the tracked bodies as a hri_msgs/IdsList.

    Args:
        classes: the message classes.
        stamp: the depth image's, nanoseconds.
        frame_id: the camera's optical frame.
        ids: the ids.
    """
    return classes.find(IDS_LIST)(header=build_header(classes, stamp, frame_id), ids=ids)


def build_region(
    classes: MessageClasses, stamp: int, frame_id: str, region: Region, confidence: float
) -> Any:  # noqa: ANN401
    """Return a region as a hri_msgs/NormalizedRegionOfInterest2D.

    Args:
        classes: the message classes.
        stamp: the depth image's, nanoseconds.
        frame_id: the camera's optical frame.
        region: the rectangle.
        confidence: 0 to 1.
    """
    return classes.find(NORMALIZED_REGION)(
        header=build_header(classes, stamp, frame_id), **region._asdict(), c=confidence
    )


def build_skeleton2d(
    classes: MessageClasses, stamp: int, frame_id: str, points: NDArray[np.float32]
) -> Any:  # noqa: ANN401
    """Return the keypoints of one body as a hri_msgs/Skeleton2D.

    Args:
        classes: the message classes.
        stamp: the depth image's, nanoseconds.
        frame_id: the camera's optical frame.
        points: x, y and confidence of each of KEYPOINTS, shape (18, 3).
    """
    point = classes.find(NORMALIZED_POINT)
    return classes.find(SKELETON_2D)(
        header=build_header(classes, stamp, frame_id),
        skeleton=[point(x=x, y=y, c=confidence) for x, y, confidence in points.tolist()],
    )


def build_joint_state(
    classes: MessageClasses, stamp: int, frame_id: str, angles: Mapping[str, float]
) -> Any:  # noqa: ANN401
    """Return the angles of one body as a sensor_msgs/JointState.

    Args:
        classes: the message classes.
        stamp: the depth image's, nanoseconds.
        frame_id: the camera's optical frame.
        angles: radians, by the names of the joints in the URDF.
    """
    return classes.find(JOINT_STATE)(
        header=build_header(classes, stamp, frame_id),
        name=list(angles),
        position=classes.doubles(list(angles.values())),
        velocity=classes.doubles([]),
        effort=classes.doubles([]),
    )
