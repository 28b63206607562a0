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

"""Lower confidence for people of whom a part is cut off or hidden by something nearer.

The part of the body beyond the cut is invisible, and its joints are estimated where the visible
body ends. So the closer an estimated joint is to a cut, the less reliable it is. A cut is where
the body borders on unknown pixels (NaN): those outside of the image, and those that
`silhouette/cuts.py` marks.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.rays import ImageRays
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.silhouette.preprocessing import Window

FEWEST_CUTS = 3
"""Fewer cuts than this are noise, for example at the feet, where the floor comes nearer."""

# At these distances of a joint from a cut, metres, the confidence is multiplied by these factors:
# measured on 635 synthetic people in rooms and at the edge of the image, of whom 81 % were cut.
_DISTANCES = (0.1, 0.2, 0.4, 0.9)
_FACTORS = (0.29, 0.55, 0.77, 1.0)

# Legs that are hidden are estimated as short legs that end at the cut. For a knee, ankle or foot
# within this distance of a cut, the length of the thigh, or of the shorter of thigh and shank,
# decides instead; measured on the same people.
_LEG_NEAR_CUT = 0.4
_THIGHS, _KNEE_FACTORS = (0.2, 0.27, 0.35), (0.05, 0.2, 0.62)
_BONES, _FOOT_FACTORS = (0.22, 0.27, 0.35, 0.45), (0.07, 0.2, 0.52, 0.82)


_LEGS = tuple(
    tuple(JOINT_NUMBERS[f'{side}_{name}'] for name in ('hip', 'knee', 'ankle', 'foot'))
    for side in 'lr'
)


class Cuts(NamedTuple):
    """The pixels of a body that have an unknown pixel above, below or beside them.

    Attributes:
        rays: X / Z and Y / Z of each pixel, shape (n, 2).
        hidden: the direction to the hidden side: the sum of the steps to the unknown pixels, to
            the right and down, shape (n, 2).
    """

    rays: NDArray[np.float32]
    hidden: NDArray[np.float32]


NO_CUTS = Cuts(np.zeros((0, 2), np.float32), np.zeros((0, 2), np.float32))
"""The cuts of a body that is in full view."""


def find_cuts(window: Window, rays: ImageRays) -> Cuts:
    """Return the cuts of the body in a window; none if there are fewer than FEWEST_CUTS.

    Args:
        window: the body, with its cuts marked; its border row and column hold no body.
        rays: the rays of the whole image.
    """
    found = _find_cuts(window, rays)
    return NO_CUTS if len(found) < FEWEST_CUTS else Cuts(found[:, :2], found[:, 2:])


@kernel
def _find_cuts(window: Window, rays: ImageRays) -> NDArray[np.float32]:
    depth = window.depth
    cuts = np.empty((depth.size, 4), np.float32)
    count = 0
    for i in range(1, depth.shape[0] - 1):
        for j in range(1, depth.shape[1] - 1):
            if not math.isfinite(depth[i, j]):
                continue
            left, right = math.isnan(depth[i, j - 1]), math.isnan(depth[i, j + 1])
            above, below = math.isnan(depth[i - 1, j]), math.isnan(depth[i + 1, j])
            if left or right or above or below:
                at = window.row + i + 1, window.column + j + 1  # the rays have a margin
                cuts[count, 0], cuts[count, 1] = rays.right[at], rays.down[at]
                cuts[count, 2] = int(right) - int(left)
                cuts[count, 3] = int(below) - int(above)
                count += 1
    return cuts[:count].copy()


def truncation_factor(
    joints: NDArray[np.float32], cuts: Cuts, numbers: NDArray[np.unsignedinteger]
) -> NDArray[np.float32]:
    """Return the factor for the confidence in each joint, from 0.05 to 1, shape (J,).

    Args:
        joints: of one body in the optical frame, metres, NaN if not estimated, shape (J, 3).
        cuts: of the body.
        numbers: the number of each joint, shape (J,).
    """
    if not len(cuts.rays):
        return np.ones(len(joints), np.float32)
    nearest = distances_from_cuts(joints, cuts)
    factors: NDArray[np.float32] = np.interp(nearest, _DISTANCES, _FACTORS).astype(np.float32)
    for column, factor in _leg_factors(joints, numbers).items():
        if nearest[column] < _LEG_NEAR_CUT:
            factors[column] = factor
    return np.where(np.isnan(nearest), np.float32(1), factors)


def _leg_factors(
    joints: NDArray[np.float32], numbers: NDArray[np.unsignedinteger]
) -> dict[int, float]:
    """Return the factor of each knee, ankle and foot by its column, if the leg is estimated."""
    columns = {int(number): column for column, number in enumerate(numbers)}
    factors: dict[int, float] = {}
    for leg in _LEGS:
        hip, knee, ankle, foot = (columns.get(number, -1) for number in leg)
        if min(hip, knee) < 0:
            continue
        thigh = float(np.linalg.norm(joints[hip] - joints[knee]))
        if not math.isnan(thigh):
            factors[knee] = float(np.interp(thigh, _THIGHS, _KNEE_FACTORS))
        bone = float(np.minimum(thigh, np.linalg.norm(joints[knee] - joints[ankle])))
        if ankle >= 0 and not math.isnan(bone):  # NaN if one of the two is
            factor = float(np.interp(bone, _BONES, _FOOT_FACTORS))
            factors.update({column: factor for column in (ankle, foot) if column >= 0})
    return factors


@kernel
def distances_from_cuts(joints: NDArray[np.float32], cuts: Cuts) -> NDArray[np.float32]:
    """Return the distance of each joint from the nearest cut, metres, shape (J,).

    It is measured in parallel to the image, at the depth of the joint. It is 0 for a joint on the
    hidden side of the nearest cut and NaN for a joint that is not estimated.

    Args:
        joints: as `truncation_factor`.
        cuts: of the body, at least one.
    """
    distances = np.full(len(joints), np.nan, np.float32)
    for joint in range(len(joints)):
        x, y, z = joints[joint]
        least, side = np.inf, 0.0
        for n in range(len(cuts.rays)):
            right, down = x - z * cuts.rays[n, 0], y - z * cuts.rays[n, 1]
            squared = right * right + down * down
            if squared < least:  # not if it is NaN
                least = squared
                side = right * cuts.hidden[n, 0] + down * cuts.hidden[n, 1]
        if least < np.inf:
            distances[joint] = 0.0 if side > 0 else math.sqrt(least)
    return distances
