"""Real ROS messages to what the method takes."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple, TypeAlias

import numpy as np
from builtin_interfaces.msg import Time
from numpy.typing import NDArray
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from lsc_pose_ros.bags.serialization.deserialize import CompressedImageMessage, ImageMessage
from lsc_pose_ros.bags.serialization.image_messages import depth_of, labels_of
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.camera_info import image_camera
from lsc_pose_ros.messages.codecs.image_encodings import ImageLayout
from lsc_pose_ros.ros.health.stream_warnings import TopicNames
from lsc_pose_ros.segmentation.segmenter import Segmenter, segment

AnyImage: TypeAlias = Image | CompressedImage

NANOSECONDS = 1_000_000_000


class FrameMessages(NamedTuple):
    """The messages that make up a frame; no mask where bodies are found without."""

    depth: AnyImage
    mask: AnyImage | None
    camera_info: CameraInfo


def nanoseconds(stamp: Time) -> int:
    """Return `stamp` in nanoseconds."""
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)


def frame_of(
    pair: FrameMessages,
    topics: TopicNames,
    mask_background: int,
    segmenter: Segmenter | None = None,
) -> Frame:
    """Return the frame that the messages of `pair` hold.

    Args:
        pair: the messages.
        topics: where they came from.
        mask_background: the mask's pixel value that shows no body.
        segmenter: what finds the bodies where `pair` has no mask.

    Raises:
        InputError: a message cannot be used; the sentence names its topic.
    """
    header = pair.depth.header
    stamp = nanoseconds(header.stamp)
    with _naming(topics.depth):
        depth = depth_of(_plain(pair.depth))
    labels = None
    if pair.mask is not None:
        with _naming(topics.mask):
            labels = labels_of(_plain(pair.mask), mask_background)
            _check_size(labels.shape, depth.shape, topics.depth)
    with _naming(topics.camera_info):
        height, width, camera = image_camera(pair.camera_info)
        if height and width:
            _check_size((height, width), depth.shape, topics.depth)
    if labels is None:
        labels = _labels_without_mask(segmenter, stamp, depth, camera)
    return Frame(stamp, header.frame_id, depth, labels, camera, None)


@contextmanager
def _naming(topic: str) -> Iterator[None]:
    """Let an InputError begin with the topic that it is about."""
    try:
        yield
    except InputError as error:
        msg = f'{topic}: {error}'
        raise InputError(msg) from error


def _labels_without_mask(
    segmenter: Segmenter | None, stamp: int, depth: NDArray[np.float32], camera: Intrinsics
) -> NDArray[np.int32]:
    if segmenter is None:
        return np.full(depth.shape, NO_BODY, np.int32)
    return segment(segmenter, stamp, depth, camera)


def _plain(image: AnyImage) -> ImageMessage | CompressedImageMessage:
    """Return `image` as a recording would give it; the pixels are not copied."""
    stamp, frame_id = nanoseconds(image.header.stamp), image.header.frame_id
    data = np.frombuffer(image.data, np.uint8)
    if isinstance(image, CompressedImage):
        return CompressedImageMessage(stamp, frame_id, image.format, data)
    layout = ImageLayout(
        image.encoding, image.height, image.width, image.step, bool(image.is_bigendian)
    )
    return ImageMessage(stamp, frame_id, layout, data)


def _check_size(size: tuple[int, ...], wanted: tuple[int, ...], depth_topic: str) -> None:
    if size != wanted:
        msg = (
            f'it is for {size[1]} x {size[0]} pixels, but the images of {depth_topic} have '
            f'{wanted[1]} x {wanted[0]}; publish it at the size of the depth image'
        )
        raise InputError(msg)
