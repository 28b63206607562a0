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
from lsc_pose_ros.messages.frames import FrameTopics, error_names_topic
from lsc_pose_ros.messages.parse import (
    StampedCompressedImage,
    StampedImage,
    parse_camera_info,
    parse_compressed_image,
    parse_image,
)
from lsc_pose_ros.messages.rectification import ImageSource
from lsc_pose_ros.synchronization.frame_maker import FrameMaker

ImageMessage: TypeAlias = Image | CompressedImage


class FrameMessages(NamedTuple):
    """The messages of one frame; `mask` is None if a segmenter finds the bodies."""

    depth: ImageMessage
    mask: ImageMessage | None
    camera_info: CameraInfo


def frame_of(
    messages: FrameMessages, maker: FrameMaker, topics: FrameTopics, rectified: str
) -> Frame:
    """Return the frame that `messages` hold.

    Args:
        messages: the messages.
        maker: makes the frames of the sequence.
        topics: the topics of the messages.
        rectified: the setting.

    Raises:
        InputError: a message cannot be used; the error names its topic.
    """
    source = ImageSource(topics.depth, rectified)
    with error_names_topic(topics.camera_info):
        camera = parse_camera_info(messages.camera_info, source)
    mask = None if messages.mask is None else _parse_any(messages.mask)
    return maker.make(_parse_any(messages.depth), mask, camera)


def _parse_any(image: ImageMessage) -> StampedImage | StampedCompressedImage:
    if isinstance(image, CompressedImage):
        return parse_compressed_image(image)
    return parse_image(image)
