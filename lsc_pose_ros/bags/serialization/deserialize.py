"""Serialised ROS messages to plain values: images, camera infos, labelled skeletons."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.bags.serialization.type_store import typestore
from lsc_pose_ros.bags.storage.damage import DAMAGE, reason
from lsc_pose_ros.bags.storage.serialized_messages import (
    CAMERA_INFO,
    COMPRESSED_IMAGE,
    IMAGE,
    POINT_CLOUD,
)
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.skeletons import POINT_DTYPE, Skeletons, unpack
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.camera_info import image_camera
from lsc_pose_ros.messages.codecs.image_encodings import ImageLayout

# sensor_msgs/PointField's numbers of the types.
POINT_FIELD_TYPES = {1: 'i1', 2: 'u1', 3: 'i2', 4: 'u2', 5: 'i4', 6: 'u4', 7: 'f4', 8: 'f8'}


class DamagedMessageError(InputError):
    """A message's bytes are not what its type asks for."""


class ImageMessage(NamedTuple):
    """A sensor_msgs/Image."""

    stamp: int
    frame_id: str
    layout: ImageLayout
    data: NDArray[np.uint8]


class CompressedImageMessage(NamedTuple):
    """A sensor_msgs/CompressedImage."""

    stamp: int
    frame_id: str
    format: str
    data: NDArray[np.uint8]


class CameraInfoMessage(NamedTuple):
    """A sensor_msgs/CameraInfo: the images' size in pixels, 0 if it is not given, and camera."""

    stamp: int
    height: int
    width: int
    camera: Intrinsics


class SkeletonsMessage(NamedTuple):
    """A sensor_msgs/PointCloud2 that carries skeletons."""

    stamp: int
    skeletons: Skeletons


def read_image(data: bytes) -> ImageMessage:
    """Return the sensor_msgs/Image that `data` serialises; its pixels are not copied.

    Raises:
        DamagedMessageError: the bytes are no such message.
    """
    message = _deserialise(data, IMAGE)
    layout = ImageLayout(
        message.encoding, message.height, message.width, message.step, bool(message.is_bigendian)
    )
    return ImageMessage(_stamp(message), message.header.frame_id, layout, message.data)


def read_compressed_image(data: bytes) -> CompressedImageMessage:
    """Return the sensor_msgs/CompressedImage that `data` serialises.

    Raises:
        DamagedMessageError: the bytes are no such message.
    """
    message = _deserialise(data, COMPRESSED_IMAGE)
    return CompressedImageMessage(
        _stamp(message), message.header.frame_id, message.format, message.data
    )


def read_camera_info(data: bytes) -> CameraInfoMessage:
    """Return the sensor_msgs/CameraInfo that `data` serialises, for the images as they come.

    Raises:
        DamagedMessageError: the bytes are no such message.
        InputError: K is no pinhole camera's.
    """
    message = _deserialise(data, CAMERA_INFO)
    return CameraInfoMessage(_stamp(message), *image_camera(message))


def read_skeletons(data: bytes) -> SkeletonsMessage:
    """Return the skeletons in the sensor_msgs/PointCloud2 that `data` serialises.

    Raises:
        DamagedMessageError: the bytes are no such message.
        InputError: the cloud carries no skeletons.
    """
    message = _deserialise(data, POINT_CLOUD)
    fields = {field.name: field for field in message.fields}
    missing = [name for name in POINT_DTYPE.names or () if name not in fields]
    if missing:
        msg = f'the point cloud carries no skeletons: it has no field {", ".join(missing)}'
        raise InputError(msg)
    try:
        points = _points(message, fields)
    except DAMAGE as error:
        msg = f'the point cloud is damaged ({reason(error)})'
        raise DamagedMessageError(msg) from error
    return SkeletonsMessage(_stamp(message), unpack(points))


def _points(message: Any, fields: dict[str, Any]) -> NDArray[np.void]:  # noqa: ANN401
    """Return the cloud's points as POINT_DTYPE, shape (H, W), wherever its fields lie."""
    order = '>' if message.is_bigendian else '<'
    names = list(POINT_DTYPE.names or ())
    point = np.dtype(
        {
            'names': names,
            'formats': [f'{order}{POINT_FIELD_TYPES[fields[name].datatype]}' for name in names],
            'offsets': [fields[name].offset for name in names],
            'itemsize': message.point_step,
        }
    )
    height, width = message.height, message.width
    rows = message.data[: height * message.row_step].reshape(height, message.row_step)
    used = np.ascontiguousarray(rows[:, : width * message.point_step])
    return used.view(point).reshape(height, width).astype(POINT_DTYPE)


def _deserialise(data: bytes, type_name: str) -> Any:  # noqa: ANN401
    try:
        # A view, so that an image's pixels are not copied on the way.
        return typestore().deserialize_cdr(memoryview(data), type_name)
    except DAMAGE as error:
        msg = f'the message is no readable {type_name} ({reason(error)})'
        raise DamagedMessageError(msg) from error


def _stamp(message: Any) -> int:  # noqa: ANN401
    stamp = message.header.stamp
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
