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

"""Serializes arrays and plain values as ROS messages (CDR)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.bags.serialization.type_store import ROSBAGS_CLASSES, typestore
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.messages.build.images import build_camera_info, build_depth_image, build_mask
from lsc_pose_ros.messages.build.markers import build_markers
from lsc_pose_ros.messages.build.skeletons import build_skeletons
from lsc_pose_ros.messages.build.transforms import build_transforms
from lsc_pose_ros.messages.markers import MarkerShape
from lsc_pose_ros.messages.transforms import Transform
from lsc_pose_ros.messages.type_names import (
    CAMERA_INFO,
    IMAGE,
    MARKER_ARRAY,
    POINT_CLOUD,
    TF_MESSAGE,
)


def depth_message(stamp: int, frame_id: str, depth: NDArray[np.float32]) -> bytes:
    """Return a serialized sensor_msgs/Image, 16UC1; arguments as `build_depth_image`."""
    return serialize(build_depth_image(ROSBAGS_CLASSES, stamp, frame_id, depth), IMAGE)


def mask_message(
    stamp: int, frame_id: str, labels: NDArray[np.int32], background: int = 0
) -> bytes:
    """Return a serialized sensor_msgs/Image, mono8 or 16UC1; arguments as `build_mask`.

    Raises:
        InputError: a body has the number of the background, or one above 65535.
    """
    return serialize(build_mask(ROSBAGS_CLASSES, stamp, frame_id, labels, background), IMAGE)


def camera_info_message(
    stamp: int, frame_id: str, camera: Intrinsics, shape: tuple[int, ...]
) -> bytes:
    """Return a serialized sensor_msgs/CameraInfo; arguments as `build_camera_info`."""
    message = build_camera_info(ROSBAGS_CLASSES, stamp, frame_id, camera, shape)
    return serialize(message, CAMERA_INFO)


def skeletons_message(stamp: int, frame_id: str, skeletons: Skeletons) -> bytes:
    """Return a serialized sensor_msgs/PointCloud2; arguments as `build_skeletons`."""
    return serialize(build_skeletons(ROSBAGS_CLASSES, stamp, frame_id, skeletons), POINT_CLOUD)


def markers_message(stamp: int, frame_id: str, shapes: list[MarkerShape]) -> bytes:
    """Return a serialized visualization_msgs/MarkerArray; arguments as `build_markers`."""
    return serialize(build_markers(ROSBAGS_CLASSES, stamp, frame_id, shapes), MARKER_ARRAY)


def transforms_message(stamp: int, transforms: list[Transform]) -> bytes:
    """Return a serialized tf2_msgs/TFMessage; arguments as `build_transforms`."""
    return serialize(build_transforms(ROSBAGS_CLASSES, stamp, transforms), TF_MESSAGE)


def serialize(message: Any, type_name: str) -> bytes:  # noqa: ANN401
    """Return a message of rosbags' classes as little-endian CDR, which rosbag2 expects."""
    return bytes(typestore().serialize_cdr(message, type_name, little_endian=True))
