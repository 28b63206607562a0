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

"""Builds depth images, masks and camera infos."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import PLUMB_BOB, Intrinsics, Lens
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.build.headers import build_header
from lsc_pose_ros.messages.message_classes import MessageClasses
from lsc_pose_ros.messages.type_names import CAMERA_INFO, IMAGE, REGION_OF_INTEREST

_MILLIMETRES_PER_METRE = 1000
_ENCODINGS = {'u1': 'mono8', 'u2': '16UC1'}


def build_depth_image(
    classes: MessageClasses, stamp: int, frame_id: str, depth: NDArray[np.float32]
) -> Any:  # noqa: ANN401
    """Return a depth image as a sensor_msgs/Image, 16UC1 (REP-118).

    Args:
        classes: the message classes.
        stamp: nanoseconds.
        frame_id: the camera's optical frame.
        depth: metres, shape (H, W); invalid values and those beyond 65.535 m become 0.
    """
    metres = np.nan_to_num(depth, nan=0, posinf=0, neginf=0)
    millimetres = np.rint(metres * _MILLIMETRES_PER_METRE)
    in_range = (millimetres >= 0) & (millimetres <= np.iinfo(np.uint16).max)
    pixels = np.where(in_range, millimetres, 0).astype('<u2')
    return _build_image(classes, stamp, frame_id, pixels)


def build_mask(
    classes: MessageClasses,
    stamp: int,
    frame_id: str,
    labels: NDArray[np.int32],
    background: int = 0,
) -> Any:  # noqa: ANN401
    """Return a mask as a sensor_msgs/Image: mono8 if all body numbers fit, else 16UC1.

    Args:
        classes: the message classes.
        stamp: nanoseconds.
        frame_id: the camera's optical frame.
        labels: the body that each pixel shows, or NO_BODY, shape (H, W).
        background: the pixel value for NO_BODY.

    Raises:
        InputError: a body has the number of the background, or one above 65535.
    """
    if (labels == background).any():
        msg = (
            f'the body number {background} cannot be written, because it is the value of the '
            "mask's background; choose another mask_background"
        )
        raise InputError(msg)
    pixels = np.where(labels == NO_BODY, np.int32(background), labels)
    largest = int(pixels.max(initial=0))
    if largest > np.iinfo(np.uint16).max:
        msg = f'the body number {largest} cannot be written; the largest possible is 65535'
        raise InputError(msg)
    pixel_type = 'u1' if largest <= np.iinfo(np.uint8).max else '<u2'
    return _build_image(classes, stamp, frame_id, pixels.astype(pixel_type))


def build_camera_info(
    classes: MessageClasses, stamp: int, frame_id: str, camera: Intrinsics, shape: tuple[int, ...]
) -> Any:  # noqa: ANN401
    """Return a sensor_msgs/CameraInfo; its P is the same camera without distortion.

    Args:
        classes: the message classes.
        stamp: nanoseconds.
        frame_id: the camera's optical frame.
        camera: the intrinsics.
        shape: height and width of the images.
    """
    fx, fy, cx, cy, lens = camera
    if lens is None:
        lens = Lens(PLUMB_BOB, (0.0,) * 5)
    return classes.find(CAMERA_INFO)(
        header=build_header(classes, stamp, frame_id),
        height=int(shape[0]),
        width=int(shape[1]),
        distortion_model=lens.model,
        d=np.array(lens.coefficients, np.float64),
        k=np.array([fx, 0, cx, 0, fy, cy, 0, 0, 1], np.float64),
        r=np.eye(3).reshape(-1),
        p=np.array([fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0], np.float64),
        binning_x=0,
        binning_y=0,
        roi=classes.find(REGION_OF_INTEREST)(
            x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        ),
    )


def _build_image(
    classes: MessageClasses, stamp: int, frame_id: str, pixels: NDArray[np.generic]
) -> Any:  # noqa: ANN401
    height, width = pixels.shape
    return classes.find(IMAGE)(
        header=build_header(classes, stamp, frame_id),
        height=height,
        width=width,
        encoding=_ENCODINGS[pixels.dtype.str[1:]],
        is_bigendian=0,
        step=width * pixels.itemsize,
        data=classes.octets(pixels.tobytes()),
    )
