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

"""Fragments: pieces of a body that something in front of it cuts off from the rest of it.

Many segmentations give each piece a number of its own. A piece whose visible surface lies where a
known body is expected is a part of that body, if the body has a larger piece; it is no new person.
Others, such as a person who comes out from behind, stick out of where the body is expected.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.rays import ImageRays, image_rays
from lsc_pose_ros.data_types.conversion import LARGEST_BODY
from lsc_pose_ros.data_types.image_arguments import ImageArguments
from lsc_pose_ros.numerics.jit import kernel

BODY_RADIUS = 0.25
"""The surface of a body is nearer to its limbs than this, metres."""

LEAST_INSIDE = 0.8
"""Of a fragment, at least this fraction of the surface is so near."""

MOST_ELSEWHERE = 0.5
"""No more than this fraction is as near to another body."""

STRIDE = 4
"""Each so many rows and columns tell where a piece is."""


def join_fragments(
    images: ImageArguments,
    expected: Sequence[NDArray[np.float32]],
    limbs: NDArray[np.int32],
) -> NDArray[np.int32]:
    """Return the labels with fragments given to the bodies that they are parts of, shape (H, W).

    Args:
        images: depth, labels and camera.
        expected: where the joints of each known body are expected, metres, shape (J, 3).
        limbs: pairs of indices of joints, shape (E, 2).
    """
    depth, labels, camera = images
    numbers = np.unique(labels[::STRIDE, ::STRIDE])
    numbers = numbers[numbers >= 0]
    if len(numbers) < 2 or not expected or numbers[-1] > LARGEST_BODY:
        return labels
    skeletons = np.array(expected, np.float32)
    rays = image_rays(camera, *depth.shape)
    counts, inside = count_inside(depth, labels, rays, numbers, skeletons, limbs)
    wholes = fragments_of(counts, inside)
    if not wholes:
        return labels
    joined = np.arange(numbers[-1] + 1, dtype=labels.dtype)
    joined[numbers[list(wholes)]] = numbers[list(wholes.values())]
    # Small pieces, which no sampled pixel shows, can have larger numbers.
    return np.where(
        (labels >= 0) & (labels < len(joined)), joined.take(labels, mode='clip'), labels
    )


def fragments_of(counts: NDArray[np.int64], inside: NDArray[np.int64]) -> dict[int, int]:
    """Return the piece that each fragment belongs to, both as indices.

    Args:
        counts: the points of each piece, shape (P,).
        inside: how many of them are near to each body, shape (P, B).
    """
    fraction = inside / np.maximum(counts, 1)[:, None]
    of_bodies = np.where(fraction >= LEAST_INSIDE, counts[:, None], 0)
    wholes = of_bodies.argmax(axis=0)
    # MOST_ELSEWHERE is below LEAST_INSIDE, so the body itself is the one that may exceed it.
    in_one = (fraction > MOST_ELSEWHERE).sum(axis=1) == 1
    pieces = np.flatnonzero(in_one & (fraction.max(axis=1) >= LEAST_INSIDE))
    belongs = wholes[fraction[pieces].argmax(axis=1)]
    return {
        int(piece): int(whole)
        for piece, whole in zip(pieces, belongs, strict=True)
        if piece != whole
    }


@kernel
def count_inside(
    depth: NDArray[np.float32],
    labels: NDArray[np.int32],
    rays: ImageRays,
    numbers: NDArray[np.int32],
    skeletons: NDArray[np.float32],
    limbs: NDArray[np.int32],
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the number of points of each piece, (P,), and of those near to each body, (P, B).

    Args:
        depth: metres, 0 or not finite if unknown, shape (H, W).
        labels: the number of the piece of each pixel, shape (H, W).
        rays: of the pixels.
        numbers: of the pieces, ascending, shape (P,).
        skeletons: the joints of the bodies, metres, NaN if unknown, shape (B, J, 3).
        limbs: pairs of indices of joints, shape (E, 2).
    """
    counts = np.zeros(numbers.shape[0], np.int64)
    inside = np.zeros((numbers.shape[0], skeletons.shape[0]), np.int64)
    for row in range(0, depth.shape[0], STRIDE):
        for column in range(0, depth.shape[1], STRIDE):
            z = depth[row, column]
            if labels[row, column] < 0 or not 0 < z < np.inf:
                continue
            piece = np.searchsorted(numbers, labels[row, column])
            x = z * rays.right[row + 1, column + 1]
            y = z * rays.down[row + 1, column + 1]
            counts[piece] += 1
            for body in range(skeletons.shape[0]):
                if is_near(x, y, z, skeletons[body], limbs):
                    inside[piece, body] += 1
    return counts, inside


@kernel
def is_near(
    x: float,
    y: float,
    z: float,
    joints: NDArray[np.float32],
    limbs: NDArray[np.int32],
) -> bool:
    """Return whether a point is within BODY_RADIUS of a limb of a body.

    Args:
        x: metres.
        y: metres.
        z: metres.
        joints: metres, NaN if unknown, shape (J, 3).
        limbs: pairs of indices of joints, shape (E, 2).
    """
    for limb in range(limbs.shape[0]):
        first, second = joints[limbs[limb, 0]], joints[limbs[limb, 1]]
        along_x, along_y, along_z = (
            second[0] - first[0],
            second[1] - first[1],
            second[2] - first[2],
        )
        to_x, to_y, to_z = x - first[0], y - first[1], z - first[2]
        squared = along_x * along_x + along_y * along_y + along_z * along_z
        product = to_x * along_x + to_y * along_y + to_z * along_z
        where = min(max(product / squared, 0.0), 1.0) if squared > 0 else 0.0
        apart_x, apart_y = to_x - where * along_x, to_y - where * along_y
        apart_z = to_z - where * along_z
        # NaN, which is not less, without the first joint; without the second only that counts.
        if apart_x * apart_x + apart_y * apart_y + apart_z * apart_z < BODY_RADIUS * BODY_RADIUS:
            return True
    return False
