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

"""Combines a depth image, a mask and a camera into a frame, live and from recordings."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

import numpy as np

from lsc_pose_ros.camera.rays import pixels_outside_field
from lsc_pose_ros.data_types.conversion import DepthRange, keep_in_range
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.image_pixels import AnyImage, depth_of, labels_of
from lsc_pose_ros.messages.parse import StampedCamera

_DEPTH_RANGE = DepthRange()


class FrameTopics(Protocol):
    """The topics of a frame's messages, for error messages."""

    @property
    def depth(self) -> str:
        """The topic of the depth image."""

    @property
    def camera_info(self) -> str:
        """The topic of the camera info."""

    @property
    def mask(self) -> str:
        """The topic of the mask."""


def make_frame(
    depth: AnyImage,
    mask: AnyImage | None,
    camera: StampedCamera,
    ground_truth: Skeletons | None = None,
    *,
    topics: FrameTopics,
    mask_background: int = 0,
    depth_range: DepthRange = _DEPTH_RANGE,
) -> Frame:
    """Return the frame that the messages hold; it has the stamp of the depth image.

    Args:
        depth: the depth image.
        mask: the mask, None for a frame whose labels are all NO_BODY.
        camera: the camera of the depth image.
        ground_truth: the labelled skeletons, if any.
        topics: the topics of the messages.
        mask_background: the mask's pixel value for no body.
        depth_range: pixels with another depth have none.

    Raises:
        InputError: a message cannot be used; the error names its topic.
    """
    with error_names_topic(topics.depth):
        metres = keep_in_range(depth_of(depth), depth_range)
    if mask is None:
        labels = np.full(metres.shape, NO_BODY, np.int32)
    else:
        with error_names_topic(topics.mask):
            labels = labels_of(mask, mask_background)
            _check_size(labels.shape, metres.shape, topics.depth)
    if camera.height and camera.width:
        with error_names_topic(topics.camera_info):
            sensor = f' ({camera.sensor or "no binning, no region of interest"})'
            _check_size((camera.height, camera.width), metres.shape, topics.depth, sensor)
    outside = pixels_outside_field(camera.camera, *metres.shape)
    if outside is not None:
        metres[outside] = 0
    return Frame(depth.stamp, depth.frame_id, metres, labels, camera.camera, ground_truth)


@contextmanager
def error_names_topic(topic: str) -> Iterator[None]:
    """Prefix an InputError that is raised inside with `topic`."""
    try:
        yield
    except InputError as error:
        msg = f'{topic}: {error}'
        raise InputError(msg) from error


def _check_size(
    size: tuple[int, ...], depth_size: tuple[int, ...], depth_topic: str, sensor: str = ''
) -> None:
    if size != depth_size:
        msg = (
            f'it is for {size[1]} x {size[0]} pixels{sensor}, but the images of {depth_topic} '
            f'have {depth_size[1]} x {depth_size[0]}; both must have the same size'
        )
        raise InputError(msg)
