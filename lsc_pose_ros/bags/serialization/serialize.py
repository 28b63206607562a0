"""Plain values to serialised ROS messages: the inverse of `messages`."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.bags.serialization.deserialize import POINT_FIELD_TYPES
from lsc_pose_ros.bags.serialization.type_store import message_class, typestore
from lsc_pose_ros.bags.storage.serialized_messages import (
    CAMERA_INFO,
    IMAGE,
    MARKER_ARRAY,
    POINT_CLOUD,
)
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.skeletons import POINT_DTYPE, Skeletons, pack
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.markers import MarkerShape

_MILLIMETRES = 1000
_FIELD_NUMBERS = {name: number for number, name in POINT_FIELD_TYPES.items()}
_MARKER_KINDS = {'spheres': 7, 'lines': 5}  # SPHERE_LIST, LINE_LIST
_MARKER_ACTIONS = {'add': 0, 'delete': 2}
_ENCODINGS = {'u1': 'mono8', 'u2': '16UC1'}


def depth_message(stamp: int, frame_id: str, depth: NDArray[np.float32]) -> bytes:
    """Return `depth`, metres, shape (H, W), as a serialised sensor_msgs/Image, 16UC1.

    Args:
        stamp: nanoseconds.
        frame_id: the camera's optical frame.
        depth: what is invalid or beyond 65.535 m becomes 0.
    """
    millimetres = np.rint(np.nan_to_num(depth, nan=0, posinf=0, neginf=0) * _MILLIMETRES)
    within = (millimetres >= 0) & (millimetres <= np.iinfo(np.uint16).max)
    return _image(stamp, frame_id, np.where(within, millimetres, 0).astype('<u2'))


def mask_message(
    stamp: int, frame_id: str, labels: NDArray[np.int32], background: int = 0
) -> bytes:
    """Return `labels`, shape (H, W), as a serialised sensor_msgs/Image, mono8 or 16UC1.

    Args:
        stamp: nanoseconds.
        frame_id: the camera's optical frame.
        labels: the body that each pixel shows, or NO_BODY.
        background: the pixel value for NO_BODY.

    Raises:
        InputError: a body has the background's number, or one beyond 65535.
    """
    if (labels == background).any():
        msg = (
            f'the body number {background} cannot be written: it means background in a mask; '
            'choose another mask_background'
        )
        raise InputError(msg)
    pixels = np.where(labels == NO_BODY, np.int32(background), labels)
    largest = int(pixels.max(initial=0))
    if largest > np.iinfo(np.uint16).max:
        msg = f'the body number {largest} cannot be written: the largest is 65535'
        raise InputError(msg)
    return _image(stamp, frame_id, pixels.astype('u1' if largest < 256 else '<u2'))


def camera_info_message(
    stamp: int, frame_id: str, camera: Intrinsics, shape: tuple[int, ...]
) -> bytes:
    """Return `camera` as a serialised sensor_msgs/CameraInfo without distortion.

    Args:
        stamp: nanoseconds.
        frame_id: the camera's optical frame.
        camera: the intrinsics.
        shape: the image's height and width.
    """
    fx, fy, cx, cy = camera
    region = message_class('sensor_msgs/msg/RegionOfInterest')
    message = message_class(CAMERA_INFO)(
        header=_header(stamp, frame_id),
        height=int(shape[0]),
        width=int(shape[1]),
        distortion_model='plumb_bob',
        d=np.zeros(5),
        k=np.array([fx, 0, cx, 0, fy, cy, 0, 0, 1], np.float64),
        r=np.eye(3).reshape(-1),
        p=np.array([fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0], np.float64),
        binning_x=0,
        binning_y=0,
        roi=region(x_offset=0, y_offset=0, height=0, width=0, do_rectify=False),
    )
    return _serialise(message, CAMERA_INFO)


def skeletons_message(stamp: int, frame_id: str, skeletons: Skeletons) -> bytes:
    """Return `skeletons` as a serialised, organised sensor_msgs/PointCloud2.

    Args:
        stamp: nanoseconds, the depth image's.
        frame_id: the camera's optical frame.
        skeletons: B bodies of J joints: the cloud's height and width.
    """
    points = pack(skeletons)
    bodies, joints = points.shape
    message = message_class(POINT_CLOUD)(
        header=_header(stamp, frame_id),
        height=bodies,
        width=joints,
        fields=_point_fields(),
        is_bigendian=False,
        point_step=POINT_DTYPE.itemsize,
        row_step=POINT_DTYPE.itemsize * joints,
        data=np.frombuffer(points.tobytes(), np.uint8),
        is_dense=bool(np.isfinite(skeletons.positions).all()),
    )
    return _serialise(message, POINT_CLOUD)


def markers_message(stamp: int, frame_id: str, markers: list[MarkerShape]) -> bytes:
    """Return `markers` as a serialised visualization_msgs/MarkerArray.

    Args:
        stamp: nanoseconds, the depth image's.
        frame_id: the camera's optical frame.
        markers: the shapes.
    """
    header = _header(stamp, frame_id)
    array = message_class(MARKER_ARRAY)(markers=[_marker(header, shape) for shape in markers])
    return _serialise(array, MARKER_ARRAY)


def _image(stamp: int, frame_id: str, pixels: NDArray[np.generic]) -> bytes:
    height, width = pixels.shape
    message = message_class(IMAGE)(
        header=_header(stamp, frame_id),
        height=height,
        width=width,
        encoding=_ENCODINGS[pixels.dtype.str[1:]],
        is_bigendian=0,
        step=width * pixels.itemsize,
        data=np.ascontiguousarray(pixels).view(np.uint8).reshape(-1),
    )
    return _serialise(message, IMAGE)


def _marker(header: Any, shape: MarkerShape) -> Any:  # noqa: ANN401
    point, color = (
        message_class('geometry_msgs/msg/Point'),
        message_class('std_msgs/msg/ColorRGBA'),
    )
    # A line list knows one size only, its width; RViz wants the others not to be 0.
    size = dict.fromkeys('xyz', shape.size)
    return message_class('visualization_msgs/msg/Marker')(
        header=header,
        ns=shape.namespace,
        id=shape.identifier,
        type=_MARKER_KINDS[shape.kind],
        action=_MARKER_ACTIONS[shape.action],
        pose=_no_pose(),
        scale=message_class('geometry_msgs/msg/Vector3')(**size),
        color=color(r=1.0, g=1.0, b=1.0, a=1.0),
        lifetime=_seconds('builtin_interfaces/msg/Duration', shape.lifetime_ns),
        frame_locked=False,
        points=[point(x=x, y=y, z=z) for x, y, z in shape.points.tolist()],
        colors=[color(r=r, g=g, b=b, a=a) for r, g, b, a in shape.colours.tolist()],
        texture_resource='',
        texture=_no_texture(),
        uv_coordinates=[],
        text='',
        mesh_resource='',
        mesh_file=message_class('visualization_msgs/msg/MeshFile')(
            filename='', data=np.zeros(0, np.uint8)
        ),
        mesh_use_embedded_materials=False,
    )


def _no_pose() -> Any:  # noqa: ANN401
    return message_class('geometry_msgs/msg/Pose')(
        position=message_class('geometry_msgs/msg/Point')(x=0.0, y=0.0, z=0.0),
        orientation=message_class('geometry_msgs/msg/Quaternion')(x=0.0, y=0.0, z=0.0, w=1.0),
    )


def _no_texture() -> Any:  # noqa: ANN401
    return message_class('sensor_msgs/msg/CompressedImage')(
        header=_header(0, ''), format='', data=np.zeros(0, np.uint8)
    )


def _point_fields() -> list[Any]:
    field = message_class('sensor_msgs/msg/PointField')
    layout: Any = POINT_DTYPE.fields
    return [
        field(name=name, offset=place[1], datatype=_FIELD_NUMBERS[place[0].str[1:]], count=1)
        for name, place in layout.items()
    ]


def _header(stamp: int, frame_id: str) -> Any:  # noqa: ANN401
    return message_class('std_msgs/msg/Header')(
        stamp=_seconds('builtin_interfaces/msg/Time', stamp), frame_id=frame_id
    )


def _seconds(type_name: str, nanoseconds: int) -> Any:  # noqa: ANN401
    seconds, rest = divmod(int(nanoseconds), 1_000_000_000)
    return message_class(type_name)(sec=seconds, nanosec=rest)


def _serialise(message: Any, type_name: str) -> bytes:  # noqa: ANN401
    # Little endian on every machine: what rosbag2's own readers expect, and the same bytes.
    return bytes(typestore().serialize_cdr(message, type_name, little_endian=True))
