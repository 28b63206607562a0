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

"""Computes the camera of the images that belong to a sensor_msgs/CameraInfo."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.errors import InputError


class Region(Protocol):
    """The fields of a sensor_msgs/RegionOfInterest that are used."""

    x_offset: int
    y_offset: int
    height: int
    width: int


class CameraInfoFields(Protocol):
    """The fields of a sensor_msgs/CameraInfo that are used; the class may be of any library."""

    height: int
    width: int
    k: Sequence[float] | NDArray[np.float64]
    binning_x: int
    binning_y: int
    roi: Region


class ImageCamera(NamedTuple):
    """The size of the published images in pixels, 0 if it is unknown, and their intrinsics."""

    height: int
    width: int
    camera: Intrinsics


def image_camera(info: CameraInfoFields) -> ImageCamera:
    """Return the camera of the images that are published with `info`.

    Width, height and K of a CameraInfo describe the whole sensor. With a region of interest or
    binning the images are smaller, and K is adapted to them.

    Raises:
        InputError: K is not the matrix of a pinhole camera.
    """
    fx, fy, cx, cy = (float(info.k[index]) for index in (0, 4, 2, 5))
    if not (fx > 0 and fy > 0 and np.isfinite([fx, fy, cx, cy]).all()):
        what = 'is all zero' if not np.any(info.k) else 'has no positive focal lengths'
        msg = f'the matrix K of the camera info {what}; the camera must be calibrated'
        raise InputError(msg)
    columns, rows = max(info.binning_x, 1), max(info.binning_y, 1)
    region = info.roi
    return ImageCamera(
        (region.height or info.height) // rows,
        (region.width or info.width) // columns,
        Intrinsics(
            fx / columns,
            fy / rows,
            (cx - region.x_offset) / columns,
            (cy - region.y_offset) / rows,
        ),
    )
