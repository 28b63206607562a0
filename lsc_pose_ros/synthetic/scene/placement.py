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

"""Placement of camera and people: people stand on one floor, in full view, without contact."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.errors import InputError

IMAGE_MARGIN = 3.0
"""Minimum distance between a person in full view and the image edge, pixels."""

PEOPLE_GAP = 0.05
"""Minimum distance between two people, metres."""

MIN_BEARING_DIFFERENCE = float(np.radians(9.0))
"""Minimum difference between the bearings of two people, so that nobody is completely hidden."""

_TRIES = 200  # heights and tilts of the camera that are tried
_TOGETHER = 1.6  # side of the square around the first person in which others stay, metres
_POSITIONS = 8  # positions that are tried per person and try

# Horizontal directions of the planes that separate people.
_ANGLES = np.arange(16) * (np.pi / 8)
_DIRECTIONS = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=1)


class PersonExtent(NamedTuple):
    """The outermost points of a person in T frames.

    The frame is level with its origin on the floor below the person's pelvis: x right, y down, z
    away from the camera.

    Attributes:
        points: of the skin, metres, shape (T, P, 3).
        trunk: the middle of the trunk, which is always in view, metres, shape (T, 3).
    """

    points: NDArray[np.float64]
    trunk: NDArray[np.float64]


class ScenePlacement(NamedTuple):
    """The camera's tilt and the positions of N people.

    Attributes:
        tilt: rotation from the level frame to the camera's frame, shape (3, 3).
        positions: each person's origin in the level frame at the camera, metres, shape (N, 3); y
            is the camera's height above the floor.
        camera_height: above the floor, metres.
    """

    tilt: NDArray[np.float64]
    positions: NDArray[np.float64]
    camera_height: float


class CameraConstraints(NamedTuple):
    """Camera and constraints of the placement.

    Attributes:
        camera: the intrinsics.
        width: of the image, pixels.
        height: of the image, pixels.
        distance: smallest and largest distance of a person, metres.
        camera_height: smallest and largest height above the floor, metres.
        tilt: smallest and largest downward tilt, radians; negative is upward.
        cropped: whether only the trunk has to be in view.
        bearing_difference: smallest difference between the bearings of two people, radians.
        people_gap: smallest distance between two people, metres.
        together: whether all people stay close to the first one.
    """

    camera: Intrinsics
    width: int
    height: int
    distance: tuple[float, float]
    camera_height: tuple[float, float]
    tilt: tuple[float, float]
    cropped: bool
    bearing_difference: float = MIN_BEARING_DIFFERENCE
    people_gap: float = PEOPLE_GAP
    together: bool = False


def sample_placement(
    people: Sequence[PersonExtent], constraints: CameraConstraints, random: np.random.Generator
) -> ScenePlacement:
    """Sample the camera's height and tilt and the positions of `people`.

    Raises:
        InputError: no placement is found.
    """
    required_points = [_points_in_view(person, constraints) for person in people]
    extents = [_extents(person.points) for person in people]
    # Each try has its own random numbers, so that it does not depend on the previous ones.
    for uniforms in random.random((_TRIES, 1 + len(people) * _POSITIONS, 2)):
        placement = _try_placement(required_points, extents, constraints, uniforms)
        if placement is not None:
            return placement
    near, far = constraints.distance
    who = 'a person' if len(people) == 1 else f'{len(people)} people'
    msg = (
        f'no placement found for {who} in full view between {near:g} and {far:g} m; allow a '
        f"larger distance or field of view, larger ranges of the camera's height and tilt, fewer "
        f'or smaller people, or cropped ones'
    )
    raise InputError(msg)


def tilt_rotation(angle: float) -> NDArray[np.float64]:
    """Return the rotation from a level frame to that of a camera that looks down by `angle`."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])


def _try_placement(
    required_points: list[NDArray[np.float64]],
    extents: list[NDArray[np.float64]],
    constraints: CameraConstraints,
    uniforms: NDArray[np.float64],
) -> ScenePlacement | None:
    tilt = tilt_rotation(_interpolate(constraints.tilt, uniforms[0, 0]))
    height = _interpolate(constraints.camera_height, uniforms[0, 1])
    positions: list[NDArray[np.float64]] = []
    for person, points in enumerate(required_points):
        frustum = _ImageFrustum(points, tilt, constraints)
        near, far = frustum.distances(height, constraints.distance)
        if near > far:
            return None
        for sideways, away in uniforms[1 + person * _POSITIONS :][:_POSITIONS]:
            distance = _interpolate((near, far), away)
            if constraints.together and positions:
                distance = positions[0][2] + (away - 0.5) * _TOGETHER
            left, right = frustum.sideways(height, distance)
            lateral = _interpolate((left, right), sideways)
            if constraints.together and positions:
                lateral = positions[0][0] + (sideways - 0.5) * _TOGETHER
            if not (near <= distance <= far and left <= lateral <= right):
                continue
            position = np.array([lateral, height, distance])
            if _is_free(extents, positions, position, constraints):
                positions.append(position)
                break
        else:
            return None
    return ScenePlacement(tilt, np.array(positions).reshape(-1, 3), height)


def _interpolate(ends: tuple[float, float], fraction: float) -> float:
    return float(ends[0] + (ends[1] - ends[0]) * fraction)


class _ImageFrustum:
    """The four planes through the camera and the image edges, tested against one person.

    A point p is on the inner side of the plane with normal n if n . p <= 0. In the level frame,
    with the person at (X, h, Z), this is linear in X, h and Z.
    """

    def __init__(
        self,
        points: NDArray[np.float64],
        tilt: NDArray[np.float64],
        constraints: CameraConstraints,
    ) -> None:
        camera = constraints.camera
        margin = 0.0 if constraints.cropped else IMAGE_MARGIN
        left = (camera.cx - margin) / camera.fx
        right = (constraints.width - 1 - margin - camera.cx) / camera.fx
        top = (camera.cy - margin) / camera.fy
        bottom = (constraints.height - 1 - margin - camera.cy) / camera.fy
        normals = np.array([[-1, 0, -left], [1, 0, -right], [0, -1, -top], [0, 1, -bottom]])
        # n . (R p) = (R^T n) . p
        self.normals = normals @ tilt
        self.extent = (points @ self.normals.T).max(axis=0)

    def distances(self, height: float, within: tuple[float, float]) -> tuple[float, float]:
        """Return the nearest and the farthest distance at which the person fits vertically."""
        near, far = within
        for normal, extent in zip(self.normals[2:], self.extent[2:], strict=True):
            fixed, slope = extent + normal[1] * height, normal[2]
            if slope < 0:  # the farther, the better
                near = max(near, -fixed / slope)
            elif slope > 0:
                far = min(far, -fixed / slope)
            elif fixed > 0:
                return 1.0, 0.0
        return float(near), float(far)

    def sideways(self, height: float, distance: float) -> tuple[float, float]:
        """Return the leftmost and the rightmost position at which the person fits."""
        moved = self.extent + self.normals @ np.array([0.0, height, distance])
        left = moved[0] / -self.normals[0, 0]
        right = -moved[1] / self.normals[1, 0]
        return float(left), float(right)


def _points_in_view(person: PersonExtent, constraints: CameraConstraints) -> NDArray[np.float64]:
    """Return the points that must be in view, shape (N, 3)."""
    points = person.points
    if constraints.cropped:
        corners = np.array([(x, y, 0.0) for x in (-0.15, 0.15) for y in (-0.15, 0.15)])
        points = person.trunk[:, None] + corners
    return points.reshape(-1, 3)


def _extents(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a person's extent in each of `_DIRECTIONS`, metres, shape (T, 16)."""
    level = points[..., [0, 2]]
    extent: NDArray[np.float64] = (level @ _DIRECTIONS.T).max(axis=1)
    return extent


def _is_free(
    extents: list[NDArray[np.float64]],
    positions: list[NDArray[np.float64]],
    position: NDArray[np.float64],
    constraints: CameraConstraints,
) -> bool:
    """Return whether the next person, at `position`, is apart from all previous people.

    Two people are apart if a vertical plane separates them and their bearings differ enough.
    """
    opposite = (np.arange(len(_DIRECTIONS)) + len(_DIRECTIONS) // 2) % len(_DIRECTIONS)
    own = extents[len(positions)][:, opposite]
    for extent, other in zip(extents, positions, strict=False):
        bearings = np.arctan2([other[0], position[0]], [other[2], position[2]])
        if abs(bearings[0] - bearings[1]) < constraints.bearing_difference:
            return False
        distances = _DIRECTIONS @ (position - other)[[0, 2]] - extent - own
        if (distances.max(axis=1) < constraints.people_gap).any():
            return False
    return True
