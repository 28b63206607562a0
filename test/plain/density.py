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

"""Parzen densities over votes and their modes (eq. 14), with the library's exponential."""

import math

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.inference.density import LEAST_DENSITY, squared_distance

# Mean-shift has converged when a step is shorter than this fraction of the bandwidth.
_CONVERGED = 1e-2
_MOST_STEPS = 50


@kernel
def density(
    position: NDArray[np.float32],
    votes: NDArray[np.float32],
    weights: NDArray[np.float32],
    bandwidth: float,
) -> float:
    """Return phi(x) = sum over m of w_m exp(-||x - x_m||^2 / h^2) (eq. 14, 15).

    Args:
        position: x, metres, shape (3,).
        votes: x_m, metres, shape (M, 3).
        weights: w_m, shape (M,).
        bandwidth: h, metres.
    """
    total = 0.0
    scale = -1.0 / (bandwidth * bandwidth)
    for m in range(votes.shape[0]):
        dx = position[0] - votes[m, 0]
        dy = position[1] - votes[m, 1]
        dz = position[2] - votes[m, 2]
        total += weights[m] * math.exp(scale * (dx * dx + dy * dy + dz * dz))
    return total


@kernel
def mean_shift(
    position: NDArray[np.float32],
    votes: NDArray[np.float32],
    weights: NDArray[np.float32],
    bandwidth: float,
) -> NDArray[np.float32]:
    """Return the votes' mean under a Gaussian at `position`: one step of mean-shift.

    Returns `position` unchanged if no vote is in range. Arguments as `density`.
    """
    scale = -1.0 / (bandwidth * bandwidth)
    total, x, y, z = 0.0, 0.0, 0.0, 0.0
    for m in range(votes.shape[0]):
        dx = position[0] - votes[m, 0]
        dy = position[1] - votes[m, 1]
        dz = position[2] - votes[m, 2]
        weight = weights[m] * math.exp(scale * (dx * dx + dy * dy + dz * dz))
        total += weight
        x += weight * votes[m, 0]
        y += weight * votes[m, 1]
        z += weight * votes[m, 2]
    shifted = position.copy()
    if total > 1e-30:
        shifted[0] = x / total
        shifted[1] = y / total
        shifted[2] = z / total
    return shifted


@kernel
def climb(
    position: NDArray[np.float32],
    votes: NDArray[np.float32],
    weights: NDArray[np.float32],
    bandwidth: float,
) -> NDArray[np.float32]:
    """Return the mode of the density that mean-shift reaches from `position`, shape (3,)."""
    converged = (_CONVERGED * bandwidth) ** 2
    for _ in range(_MOST_STEPS):
        shifted = mean_shift(position, votes, weights, bandwidth)
        moved = squared_distance(position, shifted)
        position = shifted
        if moved < converged:
            break
    return position


@kernel
def find_modes(
    votes: NDArray[np.float32], weights: NDArray[np.float32], bandwidth: float, wanted: int
) -> NDArray[np.float32]:
    """Return at most `wanted` modes of the density, as `pose.inference.density.find_modes`."""
    modes = np.empty((wanted, 3), np.float32)
    found = 0
    heights = np.empty(votes.shape[0], np.float64)
    for m in range(votes.shape[0]):
        heights[m] = density(votes[m], votes, weights, bandwidth)
    least = LEAST_DENSITY * heights.max() if len(heights) else 0.0
    near = bandwidth * bandwidth
    while found < wanted and len(heights):
        best = np.argmax(heights)
        if heights[best] <= least:
            break
        mode = climb(votes[best], votes, weights, bandwidth)
        known = False
        for k in range(found):
            known = known or bool(squared_distance(mode, modes[k]) < near)
        if not known:
            modes[found] = mode
            found += 1
        heights[best] = -1
        for m in range(votes.shape[0]):
            if squared_distance(votes[m], mode) < near:
                heights[m] = -1
            if squared_distance(votes[m], votes[best]) < near:
                heights[m] = -1
    return modes[:found]
