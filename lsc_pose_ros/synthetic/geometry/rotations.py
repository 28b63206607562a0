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

"""Vectorised rotations: axes, quaternions, rotation vectors and interpolation.

Quaternions are (w, x, y, z) with w >= 0.
"""

import numpy as np
from numpy.typing import NDArray

_SMALL = 1e-12


def normalised(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return `vectors`, shape (..., 3) or (..., 4), with length 1; zero vectors stay zero."""
    lengths = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    return np.asarray(vectors / np.maximum(lengths, _SMALL))


def axis_rotation(axis: int, angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return rotations about axis 0, 1 or 2 by `angle`, radians, shape (...); (..., 3, 3)."""
    one, other = (axis + 1) % 3, (axis + 2) % 3
    rotation = np.zeros((*np.shape(angle), 3, 3))
    rotation[..., axis, axis] = 1.0
    rotation[..., one, one] = rotation[..., other, other] = np.cos(angle)
    rotation[..., other, one] = np.sin(angle)
    rotation[..., one, other] = -np.sin(angle)
    return rotation


def half_turns(axis: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotations by 180 degrees about unit vectors: 2 a a^T - I, shape (..., 3, 3)."""
    outer = axis[..., :, None] * axis[..., None, :]
    return np.asarray(2.0 * outer - np.eye(3))


def shortest_rotation(start: NDArray[np.float64], end: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the smallest rotations that map unit vectors to others, shape (..., 3, 3).

    R = I + [v] + [v]^2 / (1 + c), with v = start x end and c = start . end. For opposite vectors,
    it is one of the possible half turns.
    """
    v = np.cross(start, end)
    cosine = (start * end).sum(axis=-1)
    cross = np.zeros((*v.shape, 3))
    cross[..., 0, 1], cross[..., 0, 2], cross[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    cross -= np.swapaxes(cross, -1, -2)
    opposite = (cosine < -1.0 + 1e-9)[..., None, None]
    fraction = np.where(opposite, 0.0, 1.0 / np.maximum(1.0 + cosine, 1e-9)[..., None, None])
    # Orthogonal to `start`: it is not parallel to at least one of these axes.
    one, other = np.cross(start, [0.0, 0.0, 1.0]), np.cross(start, [1.0, 0.0, 0.0])
    across = normalised(np.where(np.abs(start[..., 2:]) < 0.9, one, other))
    return np.where(opposite, half_turns(across), np.eye(3) + cross + fraction * (cross @ cross))


def limb_frames(along: NDArray[np.float64], ahead: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotations that map -y to `along` and z as near to `ahead` as possible.

    Both are unit vectors, shape (..., 3).
    """
    forward = normalised(ahead - (ahead * along).sum(axis=-1, keepdims=True) * along)
    return np.stack([np.cross(-along, forward), -along, forward], axis=-1)


def to_quaternions(rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the quaternions of rotations, (..., 3, 3) to (..., 4).

    Four times the square of each component is a sum along the diagonal; the largest component is
    the divisor (Shepperd, Quaternion from rotation matrix, 1978).
    """
    r = rotations
    x, y, z = r[..., 0, 0], r[..., 1, 1], r[..., 2, 2]
    products = np.empty((*r.shape[:-2], 4, 4))
    products[..., 0, 0], products[..., 1, 1] = 1 + x + y + z, 1 + x - y - z
    products[..., 2, 2], products[..., 3, 3] = 1 - x + y - z, 1 - x - y + z
    for one, other, value in (
        (0, 1, r[..., 2, 1] - r[..., 1, 2]),
        (0, 2, r[..., 0, 2] - r[..., 2, 0]),
        (0, 3, r[..., 1, 0] - r[..., 0, 1]),
        (1, 2, r[..., 0, 1] + r[..., 1, 0]),
        (1, 3, r[..., 0, 2] + r[..., 2, 0]),
        (2, 3, r[..., 1, 2] + r[..., 2, 1]),
    ):
        products[..., one, other] = products[..., other, one] = value
    diagonal = np.diagonal(products, axis1=-2, axis2=-1)
    largest = np.argmax(np.round(diagonal, 9), axis=-1)
    quaternions = normalised(
        np.take_along_axis(products, largest[..., None, None], axis=-2)[..., 0, :]
    )
    return np.where(quaternions[..., :1] < 0, -quaternions, quaternions)


def from_quaternions(quaternions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotations of unit quaternions, (..., 4) to (..., 3, 3)."""
    w, x, y, z = np.moveaxis(quaternions, -1, 0)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def continuous_signs(quaternions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return quaternions, shape (T, ..., 4), with signs without jumps over time."""
    cosine = (quaternions[1:] * quaternions[:-1]).sum(axis=-1, keepdims=True)
    signs = np.cumprod(np.where(cosine < 0, -1.0, 1.0), axis=0)
    return np.concatenate([quaternions[:1], signs * quaternions[1:]])


def slerp(
    start: NDArray[np.float64], end: NDArray[np.float64], fraction: NDArray[np.float64] | float
) -> NDArray[np.float64]:
    """Return the spherical linear interpolation along the shorter arc, (..., 4).

    Args:
        start: unit quaternions.
        end: unit quaternions.
        fraction: of the way, 0 to 1, broadcast over (...).
    """
    opposite = (start * end).sum(axis=-1, keepdims=True) < 0
    return signed_slerp(start, np.where(opposite, -end, end), fraction)


def signed_slerp(
    start: NDArray[np.float64], end: NDArray[np.float64], fraction: NDArray[np.float64] | float
) -> NDArray[np.float64]:
    """Return the spherical linear interpolation with the given signs, even along the longer arc.

    (sin((1 - s) a) p + sin(s a) q) / sin a, with cos a = p . q (Shoemake, 1985).
    """
    angle = np.arccos(np.clip((start * end).sum(axis=-1), -1.0 + 1e-9, 1.0))
    near = angle < 1e-4
    sine = np.where(near, 1.0, np.sin(angle))
    before = np.where(near, 1.0 - fraction, np.sin((1.0 - fraction) * angle) / sine)
    after = np.where(near, fraction, np.sin(fraction * angle) / sine)
    return normalised(before[..., None] * start + after[..., None] * end)


def interpolate_rotations(
    start: NDArray[np.float64], end: NDArray[np.float64], fraction: NDArray[np.float64] | float
) -> NDArray[np.float64]:
    """Return rotations between `start` and `end` along the shortest way, shape (..., 3, 3)."""
    return from_quaternions(slerp(to_quaternions(start), to_quaternions(end), fraction))


def rotation_vectors(rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return axis times angle, radians, of rotations, (..., 3, 3) to (..., 3)."""
    quaternions = to_quaternions(rotations)
    imaginary = quaternions[..., 1:]
    sine = np.sqrt((imaginary * imaginary).sum(axis=-1))
    angle = 2.0 * np.arctan2(sine, quaternions[..., 0])
    return np.asarray(normalised(imaginary) * angle[..., None])


def from_rotation_vectors(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotations of axis times angle, radians, (..., 3) to (..., 3, 3)."""
    angle = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    quaternions = np.concatenate(
        [np.cos(angle / 2), normalised(vectors) * np.sin(angle / 2)], axis=-1
    )
    return from_quaternions(quaternions)
