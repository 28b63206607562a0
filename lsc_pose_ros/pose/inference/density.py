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

"""Parzen densities over votes, and their modes by mean-shift (eq. 14, 15)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.fast_math import exp_neg
from lsc_pose_ros.numerics.jit import kernel

# Mean-shift has converged when a step is shorter than this fraction of the bandwidth.
_CONVERGED = 1e-2
_MOST_STEPS = 50
# No mode is searched for from votes whose density is below this fraction of the largest one.
LEAST_DENSITY = np.float32(0.2)


# x, y, z in metres, single precision; as an argument also a row of an array.
Point = tuple[np.float32, np.float32, np.float32]
Position = Point | NDArray[np.float32]


class VoteCloud(NamedTuple):
    """Weighted points, one array for each coordinate so that loops over them vectorise.

    Attributes:
        x, y, z: metres, single precision, shape (M,) each.
        weight: single precision, shape (M,).
    """

    x: NDArray[np.float32]
    y: NDArray[np.float32]
    z: NDArray[np.float32]
    weight: NDArray[np.float32]


@kernel
def density(position: Position, cloud: VoteCloud, bandwidth: float) -> np.float32:
    """Return phi(x) = sum over m of w_m exp(-||x - x_m||^2 / h^2) (eq. 14, 15).

    Votes farther than four bandwidths do not count.

    Args:
        position: x, metres, shape (3,).
        cloud: the votes x_m and their weights w_m.
        bandwidth: h, metres.
    """
    scale = np.float32(1.0 / (bandwidth * bandwidth))
    x, y, z = position[0], position[1], position[2]
    total = np.float32(0)
    for m in range(cloud.x.shape[0]):
        dx = cloud.x[m] - x
        dy = cloud.y[m] - y
        dz = cloud.z[m] - z
        total += cloud.weight[m] * exp_neg(scale * (dx * dx + dy * dy + dz * dz))
    return total


@kernel
def mean_shift(position: Position, cloud: VoteCloud, bandwidth: float) -> Point:
    """Return the votes' mean under a Gaussian at `position`: one step of mean-shift.

    Returns `position` unchanged if no vote is in range. Arguments as `density`.
    """
    scale = np.float32(1.0 / (bandwidth * bandwidth))
    x, y, z = position[0], position[1], position[2]
    total, to_x, to_y, to_z = np.float32(0), np.float32(0), np.float32(0), np.float32(0)
    for m in range(cloud.x.shape[0]):
        dx = cloud.x[m] - x
        dy = cloud.y[m] - y
        dz = cloud.z[m] - z
        pull = cloud.weight[m] * exp_neg(scale * (dx * dx + dy * dy + dz * dz))
        total += pull
        to_x += pull * dx
        to_y += pull * dy
        to_z += pull * dz
    if total > 0:
        return x + to_x / total, y + to_y / total, z + to_z / total
    return x, y, z


@kernel
def squared_distance(first: Position, second: Position) -> np.float32:
    """Return the squared distance of two positions, shape (3,) each."""
    dx = first[0] - second[0]
    dy = first[1] - second[1]
    dz = first[2] - second[2]
    return dx * dx + dy * dy + dz * dz


@kernel
def climb(position: Position, cloud: VoteCloud, bandwidth: float) -> Point:
    """Return the mode of the density that mean-shift reaches from `position`, shape (3,)."""
    converged = (_CONVERGED * bandwidth) ** 2
    here = (position[0], position[1], position[2])
    for _ in range(_MOST_STEPS):
        shifted = mean_shift(here, cloud, bandwidth)
        moved = squared_distance(here, shifted)
        here = shifted
        if moved < converged:
            break
    return here


@kernel
def find_modes(cloud: VoteCloud, bandwidth: float, wanted: int) -> NDArray[np.float32]:
    """Return at most `wanted` modes of the density, the highest start first, shape (n, 3).

    The first climb starts at the vote with the largest density. The next one starts at the best
    of the votes that are farther than a bandwidth from all earlier starts and modes; the search
    ends if the density there is below LEAST_DENSITY times the largest one. Modes closer than a
    bandwidth are one.

    Args:
        cloud: the votes.
        bandwidth: h, metres.
        wanted: how many modes are enough.
    """
    count = cloud.x.shape[0]
    modes = np.empty((wanted, 3), np.float32)
    found = 0
    heights = np.empty(count, np.float32)
    for m in range(count):
        heights[m] = density(_vote(cloud, m), cloud, bandwidth)
    least = LEAST_DENSITY * heights.max() if count else np.float32(0)
    near = np.float32(bandwidth * bandwidth)
    while found < wanted and count:
        best = int(np.argmax(heights))
        if heights[best] <= least:
            break
        start = _vote(cloud, best)
        mode = climb(start, cloud, bandwidth)
        known = False
        for k in range(found):
            known = known or bool(squared_distance(mode, modes[k]) < near)
        if not known:
            modes[found, 0], modes[found, 1], modes[found, 2] = mode
            found += 1
        heights[best] = -1
        for m in range(count):
            vote = _vote(cloud, m)
            if squared_distance(vote, mode) < near or squared_distance(vote, start) < near:
                heights[m] = -1
    return modes[:found]


@kernel
def _vote(cloud: VoteCloud, m: int) -> Point:
    return cloud.x[m], cloud.y[m], cloud.z[m]
