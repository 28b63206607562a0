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

"""Converts the messages of one depth image into a frame."""

from typing import NamedTuple, TypeAlias

from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.messages.frames import FrameTopics, error_names_topic, make_frame
from lsc_pose_ros.messages.parse import (
    StampedCamera,
    StampedCompressedImage,
    StampedImage,
    parse_camera_info,
    parse_compressed_image,
    parse_image,
)
from lsc_pose_ros.messages.rectification import ImageSource
from lsc_pose_ros.segmentation.segmenter import Segmenter, segmented

ImageMessage: TypeAlias = Image | CompressedImage


class FrameMessages(NamedTuple):
    """The messages of one frame; `mask` is None if a segmenter finds the bodies."""

    depth: ImageMessage
    mask: ImageMessage | None
    camera_info: CameraInfo


def camera_of(messages: FrameMessages, topics: FrameTopics, rectified: str) -> StampedCamera:
    """Return the camera of the depth image.

    Args:
        messages: the messages.
        topics: the topics of the messages.
        rectified: the setting.

    Raises:
        InputError: the camera info cannot be used; the error names its topic.
    """
    with error_names_topic(topics.camera_info):
        return parse_camera_info(messages.camera_info, ImageSource(topics.depth, rectified))


def frame_of(
    messages: FrameMessages,
    camera: StampedCamera,
    topics: FrameTopics,
    mask_background: int,
    segmenter: Segmenter | None = None,
) -> Frame:
    """Return the frame that `messages` hold.

    Args:
        messages: the messages.
        camera: the camera of the depth image.
        topics: the topics of the messages.
        mask_background: the mask's pixel value for no body.
        segmenter: finds the bodies if there is no mask; None for a frame without bodies.

    Raises:
        InputError: a message cannot be used; the error names its topic.
    """
    frame = make_frame(
        _parse_any(messages.depth),
        None if messages.mask is None else _parse_any(messages.mask),
        camera,
        topics=topics,
        mask_background=mask_background,
    )
    if messages.mask is None and segmenter is not None:
        return segmented(frame, segmenter)
    return frame


def _parse_any(image: ImageMessage) -> StampedImage | StampedCompressedImage:
    if isinstance(image, CompressedImage):
        return parse_compressed_image(image)
    return parse_image(image)
