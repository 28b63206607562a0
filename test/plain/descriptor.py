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

"""The 3DLSC descriptor (eq. 3, 4), pair by pair, bin by bin."""

import math

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.features.shape_context_3d import (
    AZIMUTH_BINS,
    DESCRIPTOR_SIZE,
    RADIUS_BINS,
    ZENITH_BINS,
)


@kernel
def mean_distance(points: NDArray[np.float32]) -> float:
    """Return rho_bar, the mean distance over all pairs of `points`, shape (N, 3), in metres.

    It is 0 for fewer than two points.
    """
    count = len(points)
    if count < 2:
        return 0.0
    total = 0.0
    for i in range(count - 1):
        row = 0.0
        for j in range(i + 1, count):
            dx = points[j, 0] - points[i, 0]
            dy = points[j, 1] - points[i, 1]
            dz = points[j, 2] - points[i, 2]
            row += math.sqrt(dx * dx + dy * dy + dz * dz)
        total += row
    pairs = count * (count - 1) // 2
    return total / pairs


@kernel
def _two_bins(position: float, bins: int) -> tuple[int, int, float]:
    """Return the two bins around `position`, measured in bin centres, clamped at the ends."""
    if position <= 0:
        return 0, 0, 0.0
    if position >= bins - 1:
        return bins - 1, bins - 1, 0.0
    low = int(position)
    return low, low + 1, position - low


@kernel
def describe(
    points: NDArray[np.float32], centres: NDArray[np.int64], radius: float, inner_radius: float
) -> NDArray[np.float32]:
    """Return 3DLSC histograms, shape (Q, 360), whose rows sum to 1 (eq. 3, 4).

    The bins are radius x azimuth x zenith. Every other point within `radius` adds the weight 1,
    split over the two nearest bin centres of each dimension: the logarithm of the distance, the
    azimuth in the image plane (it wraps), and the zenith against the camera's z axis.

    Args:
        points: metres, shape (N, 3).
        centres: the indices of the points to describe, shape (Q,).
        radius: the reach of a descriptor, metres.
        inner_radius: the inner limit of the first radius bin, as a fraction of `radius`; points
            that are nearer count there.
    """
    histograms = np.zeros((centres.shape[0], DESCRIPTOR_SIZE), np.float32)
    per_log = RADIUS_BINS / -math.log(inner_radius)
    for row, i in enumerate(centres):
        total = 0
        for j in range(points.shape[0]):
            dx = points[j, 0] - points[i, 0]
            dy = points[j, 1] - points[i, 1]
            dz = points[j, 2] - points[i, 2]
            squared = dx * dx + dy * dy + dz * dz
            # Two points at one position have no direction between them.
            if squared > radius * radius or squared == 0:
                continue
            distance = math.sqrt(squared)
            ring = RADIUS_BINS + math.log(distance / radius) * per_log
            azimuth = math.atan2(dy, dx) * (AZIMUTH_BINS / (2 * math.pi))
            zenith = math.acos(min(1.0, max(-1.0, dz / distance))) * (ZENITH_BINS / math.pi)
            _add(histograms[row], ring - 0.5, azimuth - 0.5, zenith - 0.5)
            total += 1
        if total:
            histograms[row] /= np.float32(total)
    return histograms


@kernel
def _add(histogram: NDArray[np.float32], radius: float, azimuth: float, zenith: float) -> None:
    """Split the weight 1 over the eight bins around a position measured in bin centres (eq. 4)."""
    near, far, to_far = _two_bins(radius, RADIUS_BINS)
    front, back, to_back = _two_bins(zenith, ZENITH_BINS)
    floor = math.floor(azimuth)
    to_next = azimuth - floor
    here = int(floor) % AZIMUTH_BINS
    following = (here + 1) % AZIMUTH_BINS
    for r in range(2):
        radius_bin, radius_weight = (far, to_far) if r else (near, 1 - to_far)
        for a in range(2):
            azimuth_bin, azimuth_weight = (following, to_next) if a else (here, 1 - to_next)
            row = (radius_bin * AZIMUTH_BINS + azimuth_bin) * ZENITH_BINS
            weight = radius_weight * azimuth_weight
            histogram[row + front] += weight * (1 - to_back)
            histogram[row + back] += weight * to_back
