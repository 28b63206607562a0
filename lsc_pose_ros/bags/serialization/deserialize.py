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

"""Deserializes recorded messages into arrays and plain values."""

from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

from lsc_pose_ros.bags.serialization.type_store import typestore
from lsc_pose_ros.bags.storage.damage import DAMAGE, reason
from lsc_pose_ros.camera.transform_tree import FrameTransform
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.parse import (
    StampedCamera,
    StampedCompressedImage,
    StampedImage,
    StampedSkeletons,
    parse_camera_info,
    parse_compressed_image,
    parse_image,
    parse_skeletons,
    parse_transforms,
)
from lsc_pose_ros.messages.rectification import ANY_SOURCE, ImageSource
from lsc_pose_ros.messages.type_names import (
    CAMERA_INFO,
    COMPRESSED_IMAGE,
    IMAGE,
    POINT_CLOUD,
    TF_MESSAGE,
)

Values = TypeVar('Values')


class DamagedMessageError(InputError):
    """The bytes of a message do not fit its type."""


def read_image(data: bytes) -> StampedImage:
    """Return the sensor_msgs/Image that `data` holds.

    Raises:
        DamagedMessageError: the bytes are no such message.
    """
    return read_as(data, IMAGE, parse_image)


def read_compressed_image(data: bytes) -> StampedCompressedImage:
    """Return the sensor_msgs/CompressedImage that `data` holds.

    Raises:
        DamagedMessageError: the bytes are no such message.
    """
    return read_as(data, COMPRESSED_IMAGE, parse_compressed_image)


def read_camera_info(data: bytes, source: ImageSource = ANY_SOURCE) -> StampedCamera:
    """Return the camera of the sensor_msgs/CameraInfo that `data` holds.

    Args:
        data: the message.
        source: the images' topic and the user's choice between raw and rectified.

    Raises:
        DamagedMessageError: the bytes are no such message.
        InputError: as `image_camera`.
    """
    return read_as(data, CAMERA_INFO, partial(parse_camera_info, source=source))


def read_transforms(data: bytes) -> list[FrameTransform]:
    """Return the rotations of the tf2_msgs/TFMessage that `data` holds.

    Raises:
        DamagedMessageError: the bytes are no such message.
    """
    return read_as(data, TF_MESSAGE, parse_transforms)


def read_skeletons(data: bytes) -> StampedSkeletons:
    """Return the skeletons of the sensor_msgs/PointCloud2 that `data` holds.

    Raises:
        DamagedMessageError: the bytes are no such message.
        InputError: the cloud carries no skeletons.
    """
    return read_as(data, POINT_CLOUD, parse_skeletons)


def read_as(data: bytes, type_name: str, parse: Callable[[Any], Values]) -> Values:
    """Return what `parse` makes of the message that `data` holds.

    Raises:
        DamagedMessageError: the bytes are no message of the type `type_name`.
        InputError: as `parse`.
    """
    try:
        # A view, so that the pixels of an image are not copied.
        return parse(typestore().deserialize_cdr(memoryview(data), type_name))
    except InputError:
        raise
    except DAMAGE as error:
        msg = f'the message is no readable {type_name} ({reason(error)})'
        raise DamagedMessageError(msg) from error
