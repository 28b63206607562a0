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

"""Position and orientation of a body: the body frame of REP-155."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS

# Shorter vectors give no reliable direction, metres.
_SHORTEST = 0.02

# Directions in the optical frame: up, the left of a person who faces the camera, and forward.
_CAMERA_UP = np.array([0.0, -1.0, 0.0])
_CAMERA_LEFT = np.array([1.0, 0.0, 0.0])
_CAMERA_FORWARD = np.array([0.0, 0.0, 1.0])


class BodyFrame(NamedTuple):
    """The body frame in the camera's optical frame.

    Attributes:
        origin: metres, midway between the hips, shape (3,).
        axes: x (forward, out of the body), y (left) and z (towards the head) as the columns of a
            rotation, shape (3, 3).
    """

    origin: NDArray[np.float64]
    axes: NDArray[np.float64]

    def inside(self, points: NDArray[np.float32]) -> NDArray[np.float64]:
        """Return `points`, metres in the camera's optical frame, in this frame, shape (..., 3)."""
        return (points - self.origin) @ self.axes


def body_frame(joints: NDArray[np.uint16], positions: NDArray[np.float32]) -> BodyFrame | None:
    """Return the frame of one body, or None if neither its hips nor its pelvis are known.

    z points from the hips to the neck, and y from the right hip to the left hip. If one of these
    joints is unknown, other joints replace it, and finally the axes of the camera.

    Args:
        joints: the numbers of the joints, shape (J,).
        positions: metres in the camera's optical frame, NaN if unknown, shape (J, 3).
    """
    named = _NamedPositions(joints, positions)
    origin = named.middle('hip')
    if np.isnan(origin).any():
        origin = named.one('pelvis')
    if np.isnan(origin).any():
        return None
    z = _first(upper - origin for upper in named.above())
    y = _first(left - (left @ z) * z for left in named.leftwards())
    return BodyFrame(origin, np.stack([np.cross(y, z), y, z], axis=1))


def quaternion(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the unit quaternion (x, y, z, w), w >= 0, of a rotation matrix, shape (3, 3).

    It is the eigenvector of Bar-Itzhack's symmetric matrix (J. Guidance, 23(6), 2000), which has
    no singularity.
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation.tolist()
    symmetric = np.array(
        [
            [xx - yy - zz, 0, 0, 0],
            [yx + xy, yy - xx - zz, 0, 0],
            [zx + xz, zy + yz, zz - xx - yy, 0],
            [zy - yz, xz - zx, yx - xy, xx + yy + zz],
        ]
    )
    # eigh reads only the lower triangle; the largest eigenvalue is the last.
    vector: NDArray[np.float64] = np.linalg.eigh(symmetric)[1][:, -1]
    return vector if vector[3] >= 0 else -vector


class _NamedPositions:
    """The positions of the joints of one body by name; NaN if unknown."""

    def __init__(self, joints: NDArray[np.uint16], positions: NDArray[np.float32]) -> None:
        self._rows = {number: row for row, number in enumerate(joints.tolist())}
        self._positions = positions.astype(np.float64)

    def one(self, name: str) -> NDArray[np.float64]:
        row = self._rows.get(JOINT_NUMBERS[name])
        return np.full(3, np.nan) if row is None else self._positions[row]

    def middle(self, name: str) -> NDArray[np.float64]:
        return (self.one(f'l_{name}') + self.one(f'r_{name}')) / 2

    def above(self) -> Iterator[NDArray[np.float64]]:
        """Yield points in the direction of the head, the most reliable first."""
        yield self.one('neck')
        yield self.middle('shoulder')
        yield self.one('head')
        yield self.one('torso')

    def leftwards(self) -> Iterator[NDArray[np.float64]]:
        """Yield directions to the person's left, the most reliable first."""
        yield self.one('l_hip') - self.one('r_hip')
        yield self.one('l_shoulder') - self.one('r_shoulder')
        yield _CAMERA_LEFT
        yield _CAMERA_FORWARD


def _first(directions: Iterator[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the first direction that is long enough, normalised, or else the camera's up."""
    for direction in directions:
        length = np.linalg.norm(direction)
        if length > _SHORTEST:  # false for NaN
            unit: NDArray[np.float64] = direction / length
            return unit
    return _CAMERA_UP
