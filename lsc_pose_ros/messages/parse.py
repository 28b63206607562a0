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

"""Reads the fields of ROS messages into arrays and plain values.

The messages may be of any library: rclpy's in the node, rosbags' in recordings. Pixels are not
copied.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.transform_tree import FrameTransform, Rotation
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.skeletons import GROUND_TRUTH_DTYPE, POINT_DTYPE, Skeletons, unpack
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.camera_info import image_camera
from lsc_pose_ros.messages.codecs.image_encodings import ImageLayout
from lsc_pose_ros.messages.rectification import ImageSource
from lsc_pose_ros.messages.stamps import nanoseconds

# The numbers of the types in sensor_msgs/PointField.
POINT_FIELD_TYPES = {1: 'i1', 2: 'u1', 3: 'i2', 4: 'u2', 5: 'i4', 6: 'u4', 7: 'f4', 8: 'f8'}


class StampedImage(NamedTuple):
    """A sensor_msgs/Image; `stamp` in nanoseconds, `data` of shape (bytes,)."""

    stamp: int
    frame_id: str
    layout: ImageLayout
    data: NDArray[np.uint8]


class StampedCompressedImage(NamedTuple):
    """A sensor_msgs/CompressedImage; `stamp` in nanoseconds, `data` of shape (bytes,)."""

    stamp: int
    frame_id: str
    format: str
    data: NDArray[np.uint8]


class StampedCamera(NamedTuple):
    """The camera of a sensor_msgs/CameraInfo; the attributes are those of `ImageCamera`."""

    stamp: int
    height: int
    width: int
    camera: Intrinsics
    sensor: str = ''
    choice: str = ''
    warning: str = ''


class StampedSkeletons(NamedTuple):
    """A sensor_msgs/PointCloud2 that carries skeletons."""

    stamp: int
    skeletons: Skeletons


def parse_image(message: Any) -> StampedImage:  # noqa: ANN401
    """Return the values of a sensor_msgs/Image."""
    layout = ImageLayout(
        message.encoding, message.height, message.width, message.step, bool(message.is_bigendian)
    )
    return StampedImage(*_parse_header(message), layout, np.frombuffer(message.data, np.uint8))


def parse_compressed_image(message: Any) -> StampedCompressedImage:  # noqa: ANN401
    """Return the values of a sensor_msgs/CompressedImage."""
    data = np.frombuffer(message.data, np.uint8)
    return StampedCompressedImage(*_parse_header(message), message.format, data)


def parse_camera_info(message: Any, source: ImageSource) -> StampedCamera:  # noqa: ANN401
    """Return the camera of the images that a sensor_msgs/CameraInfo belongs to.

    Args:
        message: the camera info.
        source: the images' topic and the user's choice between raw and rectified.

    Raises:
        InputError: as `image_camera`.
    """
    return StampedCamera(nanoseconds(message.header.stamp), *image_camera(message, source))


def parse_transforms(message: Any) -> list[FrameTransform]:  # noqa: ANN401
    """Return the rotations of a tf2_msgs/TFMessage."""
    return [
        FrameTransform(
            each.header.frame_id,
            each.child_frame_id,
            Rotation(*(float(getattr(each.transform.rotation, axis)) for axis in 'xyzw')),
        )
        for each in message.transforms
    ]


MOST_JOINTS = 1 << 16
"""Joints of a body, whose numbers have 16 bits; a cloud without bodies can claim any width."""


def parse_skeletons(message: Any) -> StampedSkeletons:  # noqa: ANN401
    """Return the skeletons of a sensor_msgs/PointCloud2.

    Raises:
        InputError: the cloud carries no skeletons.
        Exception: the message contradicts itself; the type depends on the contradiction.
    """
    fields = {field.name: field for field in message.fields}
    missing = [name for name in POINT_DTYPE.names or () if name not in fields]
    if missing:
        msg = f'the point cloud carries no skeletons: it has no field {", ".join(missing)}'
        raise InputError(msg)
    points = _parse_points(message, fields)
    return StampedSkeletons(nanoseconds(message.header.stamp), unpack(points))


def _parse_header(message: Any) -> tuple[int, str]:  # noqa: ANN401
    return nanoseconds(message.header.stamp), message.header.frame_id


def _parse_points(message: Any, fields: dict[str, Any]) -> NDArray[np.void]:  # noqa: ANN401
    """Return the cloud's points, shape (H, W), whatever the fields' offsets.

    They are those of POINT_DTYPE, or of GROUND_TRUTH_DTYPE if the cloud has visibility.
    """
    wanted = GROUND_TRUTH_DTYPE if 'visibility' in fields else POINT_DTYPE
    order = '>' if message.is_bigendian else '<'
    names = list(wanted.names or ())
    for name in names:
        _check_field(fields[name], message.point_step)
    point = np.dtype(
        {
            'names': names,
            'formats': [f'{order}{POINT_FIELD_TYPES[fields[name].datatype]}' for name in names],
            'offsets': [fields[name].offset for name in names],
            'itemsize': message.point_step,
        }
    )
    height, width = message.height, message.width
    data = np.frombuffer(message.data, np.uint8)
    # Rows without bytes would make any number of bodies of nothing.
    if height * max(message.row_step, 1) > len(data) or width > MOST_JOINTS:
        msg = (
            f'the point cloud has {len(data)} bytes, but claims {height} bodies of {width} joints'
        )
        raise InputError(msg)
    rows = data[: height * message.row_step].reshape(height, message.row_step)
    used = np.ascontiguousarray(rows[:, : width * message.point_step])
    return used.view(point).reshape(height, width).astype(wanted)


def _check_field(field: Any, point_step: int) -> None:  # noqa: ANN401
    """Raise InputError if a point has no room for `field`; numpy does not check it safely."""
    size = np.dtype(POINT_FIELD_TYPES.get(field.datatype, 'V0')).itemsize
    if not size or not 0 <= field.offset <= point_step - size:
        msg = (
            f'the field {field.name!r:.50} of the point cloud, type {field.datatype} at offset '
            f'{field.offset}, does not fit a point of {point_step} bytes'
        )
        raise InputError(msg)
