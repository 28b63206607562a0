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

"""The distortion of a lens: from the direction of a ray to its place in the image, and back.

The direction of a ray is (x, y) = (X / Z, Y / Z). The lens moves it to (x', y'), which the focal
lengths and the principal point turn into a pixel. With r^2 = x^2 + y^2, the models are those of
OpenCV and of sensor_msgs/CameraInfo:

    plumb_bob, rational_polynomial (Brown and Conrady; its denominator is 1 for plumb_bob):
        radial = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
        x' = x radial + 2 p1 x y + p2 (r^2 + 2 x^2) + s1 r^2 + s2 r^4
        y' = y radial + p1 (r^2 + 2 y^2) + 2 p2 x y + s3 r^2 + s4 r^4
    equidistant (Kannala and Brandt), with theta = atan(r):
        (x', y') = (x, y) / r * theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import EQUIDISTANT, Lens
from lsc_pose_ros.numerics.jit import kernel

# A depth image with z depth shows nothing at larger angles from the optical axis, radians.
_LARGEST_ANGLE = math.radians(80.0)

# The field is searched for its limit in steps of this angle, radians.
_ANGLE_STEP = math.radians(0.05)

# Newton's method for r doubles the right digits in each step; the bound is for bisection, its
# fallback. Each step for tangential and prism distortion, which are small, adds a digit or more.
_RADIAL_STEPS = 60
_OUTER_STEPS = 12

# Both iterations end when a ray moves less than this, relative to Z.
_SETTLED = 1e-10


class Distortion(NamedTuple):
    """A lens in the form that the kernels use.

    Attributes:
        equidistant: whether the model is equidistant.
        radial: k1 k2 k3 k4 k5 k6, or k1 k2 k3 k4 0 0 of an equidistant lens, shape (6,).
        tangential: p2 and p1, in the order of the axes that they move, shape (2,).
        prism: s1 and s3 (r^2), s2 and s4 (r^4), shape (2, 2).
        farthest: the largest r that the lens maps uniquely.
    """

    equidistant: bool
    radial: NDArray[np.float64]
    tangential: NDArray[np.float64]
    prism: NDArray[np.float64]
    farthest: float


def distortion_of(lens: Lens) -> Distortion:
    """Return `lens` in the form that the kernels use."""
    given = np.zeros(12)
    given[: len(lens.coefficients)] = lens.coefficients
    if lens.model == EQUIDISTANT:
        unlimited = Distortion(True, given[:6], np.zeros(2), np.zeros((2, 2)), math.inf)  # noqa: FBT003
    else:
        radial, tangential = given[[0, 1, 4, 5, 6, 7]], given[[3, 2]]
        unlimited = Distortion(False, radial, tangential, given[[[8, 10], [9, 11]]], math.inf)  # noqa: FBT003
    return unlimited._replace(farthest=_farthest(unlimited))


def distort(directions: NDArray[np.float64], lens: Lens) -> NDArray[np.float64]:
    """Return the distorted directions (x', y') of rays, shape (..., 2).

    Args:
        directions: x and y of the rays, shape (..., 2). NaN, and a ray outside of the field that
            the lens maps uniquely, give NaN.
        lens: the lens.
    """
    flat = np.ascontiguousarray(directions, np.float64).reshape(-1, 2)
    return _distort_all(flat, distortion_of(lens)).reshape(directions.shape)


def undistort(distorted: NDArray[np.float64], lens: Lens) -> NDArray[np.float64]:
    """Return the directions (x, y) of rays whose distorted directions are given, shape (..., 2).

    A place in the image that no ray reaches has the direction of the closest ray at the limit of
    the field.

    Args:
        distorted: x' and y', shape (..., 2).
        lens: the lens.
    """
    flat = np.ascontiguousarray(distorted, np.float64).reshape(-1, 2)
    return _undistort_all(flat, distortion_of(lens)).reshape(distorted.shape)


def transform_lens(lens: Lens, matrix: NDArray[np.float64]) -> Lens:
    """Return the lens of an image that is turned or mirrored about its principal point.

    Radial distortion does not change; (p2, p1), (s1, s3) and (s2, s4) turn like vectors.

    Args:
        lens: the lens.
        matrix: orthogonal, shape (2, 2): what it does to the direction (x, y) of a ray.
    """
    if lens.model == EQUIDISTANT:
        return lens
    given = np.zeros(12)
    given[: len(lens.coefficients)] = lens.coefficients
    for pair in ([3, 2], [8, 10], [9, 11]):
        given[pair] = matrix @ given[pair]
    used = len(lens.coefficients)
    return lens._replace(coefficients=tuple(given[: max(used, 4)].tolist()))


@kernel
def _distort_all(directions: NDArray[np.float64], lens: Distortion) -> NDArray[np.float64]:
    distorted = np.empty_like(directions)
    for index in range(len(directions)):
        x, y = directions[index]
        distorted[index] = _distort(x, y, lens)
    return distorted


@kernel
def _distort(x: float, y: float, lens: Distortion) -> tuple[float, float]:
    r = math.hypot(x, y)
    if not r <= lens.farthest:
        return math.nan, math.nan
    factor = _distorted_radius(r, lens) / r if r > 0 else 1.0
    moved_x, moved_y = _decentre(x, y, lens)
    return x * factor + moved_x, y * factor + moved_y


@kernel
def _decentre(x: float, y: float, lens: Distortion) -> tuple[float, float]:
    """Return by how much tangential and prism distortion move a ray."""
    square = x * x + y * y
    p2, p1 = lens.tangential
    along = 2 * (p2 * x + p1 * y)
    moved_x = p2 * square + along * x + lens.prism[0, 0] * square + lens.prism[1, 0] * square**2
    moved_y = p1 * square + along * y + lens.prism[0, 1] * square + lens.prism[1, 1] * square**2
    return moved_x, moved_y


@kernel
def _distorted_radius(r: float, lens: Distortion) -> float:
    """Return r times `radial`, or the distorted angle of an equidistant lens."""
    k1, k2, k3, k4, k5, k6 = lens.radial
    if lens.equidistant:
        angle = math.atan(r)
        square = angle * angle
        series: float = 1 + square * (k1 + square * (k2 + square * (k3 + square * k4)))
        return angle * series
    square = r * r
    numerator: float = 1 + square * (k1 + square * (k2 + square * k3))
    denominator: float = 1 + square * (k4 + square * (k5 + square * k6))
    return r * numerator / denominator


@kernel
def _farthest(lens: Distortion) -> float:
    """Return the largest r up to which the distorted radius grows with r."""
    farthest = before = 0.0
    for step in range(1, int(_LARGEST_ANGLE / _ANGLE_STEP) + 1):
        r = math.tan(step * _ANGLE_STEP)
        distorted = _distorted_radius(r, lens)
        if not before < distorted < math.inf:
            break
        farthest, before = r, distorted
    return farthest


@kernel
def _undistort_all(distorted: NDArray[np.float64], lens: Distortion) -> NDArray[np.float64]:
    directions = np.empty_like(distorted)
    limit = _distorted_radius(lens.farthest, lens)
    r = 0.0  # of the ray before, which is close to the next one in an image
    for index in range(len(distorted)):
        x, y = 0.0, 0.0
        for _ in range(_OUTER_STEPS):
            moved_x, moved_y = _decentre(x, y, lens)
            radial_x, radial_y = distorted[index, 0] - moved_x, distorted[index, 1] - moved_y
            radius = math.hypot(radial_x, radial_y)
            r = _undistorted_radius(min(radius, limit), lens, r)
            factor = r / radius if radius > 0 else 1.0
            moved = abs(radial_x * factor - x) + abs(radial_y * factor - y)
            x, y = radial_x * factor, radial_y * factor
            if moved < _SETTLED:
                break
        directions[index, 0], directions[index, 1] = x, y
    return directions


@kernel
def _undistorted_radius(distorted: float, lens: Distortion, start: float) -> float:
    """Return r of a distorted radius, by Newton's method between bounds that enclose r.

    Args:
        distorted: the distorted radius, at most that of the limit of the field.
        lens: the lens.
        start: a value near r, if there is one.
    """
    low, high = 0.0, lens.farthest
    r = start if 0 < start < high else min(distorted, high)
    for _ in range(_RADIAL_STEPS):
        error = _distorted_radius(r, lens) - distorted
        low, high = (low, r) if error > 0 else (r, high)
        step = 1e-6 * (1 + r)
        rise = _distorted_radius(r + step, lens) - _distorted_radius(r - step, lens)
        better = r - 2 * step * error / rise
        if not low <= better <= high:
            better = 0.5 * (low + high)
        settled = abs(better - r) < _SETTLED
        r = better
        if settled:
            break
    return r
