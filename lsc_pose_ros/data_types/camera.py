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

"""The intrinsics of a camera and the distortion of its lens."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from lsc_pose_ros.errors import InputError

PLUMB_BOB = 'plumb_bob'
RATIONAL_POLYNOMIAL = 'rational_polynomial'
EQUIDISTANT = 'equidistant'

MOST_COEFFICIENTS = {PLUMB_BOB: 5, RATIONAL_POLYNOMIAL: 12, EQUIDISTANT: 4}
"""The models of distortion, with the largest number of coefficients that a `Lens` holds.

OpenCV's last two, of a tilted sensor, are not among them.
"""


LEAST_FOCAL_LENGTH = 1.0
"""Pixels; the angle of view of an image of 4 pixels would be 127 degrees."""

LARGEST_PIXEL_LENGTH = 1e6
"""The largest focal length, and distance of the principal point from the corner, in pixels."""


def is_possible(fx: float, fy: float, cx: float, cy: float) -> bool:
    """Return whether a camera can have these focal lengths and this principal point, in pixels."""
    return (
        min(fx, fy) >= LEAST_FOCAL_LENGTH
        and max(fx, fy) <= LARGEST_PIXEL_LENGTH
        and max(abs(cx), abs(cy)) <= LARGEST_PIXEL_LENGTH
        and not np.isnan([fx, fy, cx, cy]).any()
    )


class Lens(NamedTuple):
    """The distortion of a lens (distortion_model and D of CameraInfo).

    Attributes:
        model: PLUMB_BOB, RATIONAL_POLYNOMIAL or EQUIDISTANT. `lsc_pose_ros.camera.lens` has the
            equations.
        coefficients: as in CameraInfo and OpenCV: k1 k2 p1 p2 k3 of PLUMB_BOB; also k4 k5 k6 and
            s1 s2 s3 s4 of RATIONAL_POLYNOMIAL; k1 k2 k3 k4 of EQUIDISTANT. Missing ones are 0.
    """

    model: str
    coefficients: tuple[float, ...]


class Intrinsics(NamedTuple):
    """Focal lengths, principal point and lens of a camera (K and D of CameraInfo).

    Attributes:
        fx: horizontal focal length, pixels.
        fy: vertical focal length, pixels.
        cx: column of the principal point, pixels.
        cy: row of the principal point, pixels.
        lens: the distortion; None for a pinhole camera and for rectified images.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    lens: Lens | None = None

    @classmethod
    def from_matrix(cls, matrix: ArrayLike, lens: Lens | None = None) -> 'Intrinsics':
        """Return the intrinsics in an intrinsic matrix K.

        Args:
            matrix: [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], shape (3, 3), or its 9 numbers row by
                row, as the field k of a CameraInfo. For a rectified image: the left three columns
                of its projection matrix P.
            lens: the distortion; None for a pinhole camera and for rectified images.

        Raises:
            InputError: `matrix` is not such a matrix.
        """
        values = np.asarray(matrix, np.float64)
        k = values.reshape(3, 3) if values.size == 9 else np.zeros((3, 3))
        fx, fy, cx, cy = (float(k[index]) for index in ((0, 0), (1, 1), (0, 2), (1, 2)))
        expected = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
        if not (fx > 0 and fy > 0 and np.isfinite(k).all() and np.allclose(k, expected)):
            msg = (
                f'{values.tolist()} is not an intrinsic matrix '
                '[[fx, 0, cx], [0, fy, cy], [0, 0, 1]] in pixels'
            )
            raise InputError(msg)
        return cls(fx, fy, cx, cy, lens)
