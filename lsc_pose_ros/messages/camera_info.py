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
from functools import lru_cache
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import (
    EQUIDISTANT,
    LARGEST_PIXEL_LENGTH,
    LEAST_FOCAL_LENGTH,
    MOST_COEFFICIENTS,
    PLUMB_BOB,
    RATIONAL_POLYNOMIAL,
    Intrinsics,
    Lens,
    is_possible,
)
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.rectification import (
    ANY_SOURCE,
    ImageSource,
    find_rectification,
    has_camera,
)

# The cameras of so many different infos are kept; a moving region of interest changes the info.
_CAMERAS = 64

# The names of models in sensor_msgs/distortion_models.hpp, and other names for them.
_MODELS = {
    PLUMB_BOB: PLUMB_BOB,
    'radtan': PLUMB_BOB,
    'brown_conrady': PLUMB_BOB,
    RATIONAL_POLYNOMIAL: RATIONAL_POLYNOMIAL,
    EQUIDISTANT: EQUIDISTANT,
    'fisheye': EQUIDISTANT,
    'kannala_brandt4': EQUIDISTANT,
}


class RegionFields(Protocol):
    """The fields of a sensor_msgs/RegionOfInterest that are used."""

    x_offset: int
    y_offset: int
    height: int
    width: int


class CameraInfoFields(Protocol):
    """The fields of a sensor_msgs/CameraInfo that are used; the class may be of any library."""

    height: int
    width: int
    distortion_model: str
    d: Sequence[float] | NDArray[np.float64]
    k: Sequence[float] | NDArray[np.float64]
    p: Sequence[float] | NDArray[np.float64]
    binning_x: int
    binning_y: int
    roi: RegionFields


class _Calibration(NamedTuple):
    """The values of a CameraInfo, hashable; `binning` and `offset` are (x, y)."""

    size: tuple[int, int]
    model: str
    d: tuple[float, ...]
    k: tuple[float, ...]
    p: tuple[float, ...]
    binning: tuple[int, int]
    offset: tuple[int, int]
    region: tuple[int, int]


class ImageCamera(NamedTuple):
    """The camera of images.

    Attributes:
        height: of the images, pixels; 0 if it is unknown.
        width: likewise.
        camera: the intrinsics of the images.
        sensor: how the size follows from that of the sensor, for example '640 x 480 binned
            2 x 2'; '' if the images are as large as the sensor.
        choice: which matrix was taken, and why.
        warning: a sentence on what is ignored; '' for nothing.
    """

    height: int
    width: int
    camera: Intrinsics
    sensor: str = ''
    choice: str = ''
    warning: str = ''


def image_camera(info: CameraInfoFields, source: ImageSource = ANY_SOURCE) -> ImageCamera:
    """Return the camera of the images that are published with `info`.

    K and D hold for raw images, P for rectified ones. Width, height and the matrices describe the
    whole sensor. With a region of interest or binning the images are smaller, and the matrix is
    adapted to them, as by image_geometry.

    Args:
        info: the camera info.
        source: the images' topic and the user's choice between K and P.

    Raises:
        InputError: the matrix is not that of a pinhole camera, or D is not finite.
    """
    region = info.roi
    calibration = _Calibration(
        (info.width, info.height),
        info.distortion_model,
        tuple(map(float, info.d)),
        tuple(map(float, info.k)),
        tuple(map(float, info.p)),
        (max(info.binning_x, 1), max(info.binning_y, 1)),
        (region.x_offset, region.y_offset),
        (region.width, region.height),
    )
    return _image_camera(calibration, source)


@lru_cache(maxsize=_CAMERAS)
def _image_camera(calibration: _Calibration, source: ImageSource) -> ImageCamera:
    lens, warning = _read_lens(calibration)
    distorted = lens is not None or bool(warning)
    rectified, reason = find_rectification(
        source, calibration.k, calibration.p, distorted=distorted
    )
    if rectified:
        lens, warning = None, ''
    name = 'P' if rectified and has_camera(calibration.p) else 'K'
    fx, fy, cx, cy = _read_matrix(calibration, name)
    (columns, rows), (left, top) = calibration.binning, calibration.offset
    width, height = (
        (part or whole) // step
        for part, whole, step in zip(
            calibration.region, calibration.size, calibration.binning, strict=True
        )
    )
    camera = Intrinsics(fx / columns, fy / rows, (cx - left) / columns, (cy - top) / rows, lens)
    if not is_possible(*camera[:4]):
        msg = (
            f'the matrix {name} of the camera info gives the focal lengths {camera.fx:g} and '
            f'{camera.fy:g} and the principal point ({camera.cx:g}, {camera.cy:g}); a camera has '
            f'focal lengths from {LEAST_FOCAL_LENGTH:g} to {LARGEST_PIXEL_LENGTH:g} pixels and a '
            f'principal point within {LARGEST_PIXEL_LENGTH:g} pixels'
        )
        raise InputError(msg)
    what = 'rectified' if rectified else 'raw'
    distortion = f'the distortion {lens.model}' if lens else 'no distortion'
    choice = f'{what} images ({reason}): {name}, {distortion}'
    return ImageCamera(height, width, camera, _describe_sensor(calibration), choice, warning)


def _read_matrix(calibration: _Calibration, name: str) -> tuple[float, ...]:
    """Return fx, fy, cx and cy of K or P."""
    if name == 'K':
        values = tuple(calibration.k[index] for index in (0, 4, 2, 5))
    else:
        values = tuple(calibration.p[index] for index in (0, 5, 2, 6))
    if not (values[0] > 0 and values[1] > 0 and np.isfinite(values).all()):
        what = 'has no positive focal lengths' if any(values) else 'is all zero'
        msg = f'the matrix {name} of the camera info {what}; the camera must be calibrated'
        raise InputError(msg)
    return values


def _describe_sensor(calibration: _Calibration) -> str:
    """Return how the images are cut from the sensor; '' if they are not."""
    (width, height), (columns, rows) = calibration.region, calibration.binning
    parts = ['{} x {}'.format(*calibration.size)]
    if width and height:
        parts.append(f'of which {width} x {height}')
    if max(columns, rows) > 1:
        parts.append(f'binned {columns} x {rows}')
    return ', '.join(parts) if len(parts) > 1 else ''


def _read_lens(calibration: _Calibration) -> tuple[Lens | None, str]:
    """Return the lens, None for none, and a sentence if its distortion is ignored."""
    d = np.array(calibration.d)
    if not np.isfinite(d).all():
        msg = f'the distortion D of the camera info is not finite: {d.tolist()!s:.200}'
        raise InputError(msg)
    model = _MODELS.get(calibration.model.lower(), '')
    if model == PLUMB_BOB and d[5:].any():
        model = RATIONAL_POLYNOMIAL  # which continues it
    # An equidistant lens bends rays also if all its coefficients are 0.
    if not d.any() and (model != EQUIDISTANT or len(d) == 0):
        return None, ''
    if not model or d[MOST_COEFFICIENTS[model] :].any():
        return None, (
            f'the distortion model {calibration.model!r:.60} with {len(d)} coefficients is not '
            f'known, and D is ignored: joints may be centimetres off. Known are {PLUMB_BOB}, '
            f'{RATIONAL_POLYNOMIAL} and {EQUIDISTANT}; or use the rectified images'
        )
    return Lens(model, tuple(d[: MOST_COEFFICIENTS[model]].tolist())), ''
