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

"""Upright images of cameras that are mounted on their side or upside down.

The roll of a camera is the angle by which it is turned clockwise about its viewing axis, seen from
behind the camera. People then appear turned counter-clockwise:

    roll    heads point to
    0       the top of the image
    90      the left
    180     the bottom
    270     the right

The upright image is the image turned clockwise by the roll. A direction (x, y) in the camera's
optical frame (x right, y down) has the upright direction R (x, y) with the rotation
R = [[cos, -sin], [sin, cos]] of the roll.
"""

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.lens import transform_lens
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons

RIGHT_ANGLE = 90

_Pixel = TypeVar('_Pixel', np.float32, np.int32)

_COS = (1, 0, -1, 0)
_SIN = (0, 1, 0, -1)


def upright(frame: Frame, roll: int) -> Frame:
    """Return the frame of the upright image.

    Args:
        frame: as the camera took it.
        roll: 0, 90, 180 or 270 degrees.
    """
    if not roll:
        return frame
    height, width = frame.depth.shape
    truth = frame.ground_truth
    return frame._replace(
        depth=_turn_image(frame.depth, roll),
        labels=_turn_image(frame.labels, roll),
        camera=upright_camera(frame.camera, height, width, roll),
        ground_truth=None if truth is None else _turn_skeletons(truth, roll),
        roll=roll,
    )


def in_camera_frame(skeletons: Skeletons, roll: int) -> Skeletons:
    """Return joints of the upright image in the optical frame of the camera.

    Args:
        skeletons: the joints.
        roll: that of the frame in which they were estimated.
    """
    return _turn_skeletons(skeletons, -roll) if roll else skeletons


def upright_camera(camera: Intrinsics, height: int, width: int, roll: int) -> Intrinsics:
    """Return the intrinsics of the upright image.

    Args:
        camera: the intrinsics of the image as it was taken.
        height: the rows of that image.
        width: its columns.
        roll: 0, 90, 180 or 270 degrees.
    """
    fx, fy, cx, cy, lens = camera
    if lens is not None:
        lens = transform_lens(lens, turn_matrix(roll))
    if roll == RIGHT_ANGLE:
        return Intrinsics(fy, fx, height - 1 - cy, cx, lens)
    if roll == 2 * RIGHT_ANGLE:
        return Intrinsics(fx, fy, width - 1 - cx, height - 1 - cy, lens)
    if roll == 3 * RIGHT_ANGLE:
        return Intrinsics(fy, fx, cy, width - 1 - cx, lens)
    return camera


def turn_matrix(roll: int) -> NDArray[np.float64]:
    """Return R, shape (2, 2), for a multiple of 90 degrees."""
    quarter = roll // RIGHT_ANGLE % 4
    cos, sin = _COS[quarter], _SIN[quarter]
    return np.array([[cos, -sin], [sin, cos]], np.float64)


def _turn_image(image: NDArray[_Pixel], roll: int) -> NDArray[_Pixel]:
    return np.ascontiguousarray(np.rot90(image, -roll // RIGHT_ANGLE))


def _turn_skeletons(skeletons: Skeletons, roll: int) -> Skeletons:
    positions = skeletons.positions.copy()
    positions[..., :2] = positions[..., :2] @ turn_matrix(roll).T.astype(np.float32)
    return skeletons._replace(positions=positions)
