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

"""The 3DLSC descriptor without multi-binning: each point counts in one bin only.

The paper's Fig. 11 compares it with eq. 4, which splits each point over the eight bins around it.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.features.shape_context_3d import (
    AZIMUTH_BINS,
    DESCRIPTOR_SIZE,
    LEVEL_SCALE,
    RADIUS_BINS,
    ZENITH_BINS,
)


@kernel
def describe_by_nearest_bin(
    points: NDArray[np.float32], centres: NDArray[np.int64], radius: float, inner_radius: float
) -> NDArray[np.float32]:
    """Return histograms of some of the points, shape (Q, 360), whose rows sum to 1 (eq. 3).

    Each point within `radius` adds 1 to the bin that it lies in. Bins and arguments are those of
    `shape_context_3d.describe`.
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
            far = RADIUS_BINS + math.log(distance / radius) * per_log
            azimuth = math.atan2(dy, dx) * (AZIMUTH_BINS / (2 * math.pi))
            zenith = math.acos(min(1.0, max(-1.0, dz / distance))) * (ZENITH_BINS / math.pi)
            _add_to_one(histograms[row], far, azimuth, zenith)
            total += 1
        if total:
            histograms[row] /= np.float32(total)
    return histograms


@kernel
def _add_to_one(
    histogram: NDArray[np.float32], radius: float, azimuth: float, zenith: float
) -> None:
    """Add 1 to the bin at a position that is measured in bins."""
    ring = min(max(math.floor(radius), 0), RADIUS_BINS - 1) * AZIMUTH_BINS
    sector = (ring + math.floor(azimuth) % AZIMUTH_BINS) * ZENITH_BINS
    histogram[sector + min(max(math.floor(zenith), 0), ZENITH_BINS - 1)] += 1


@kernel
def quantise(histograms: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return histograms as bytes, min(255, round(LEVEL_SCALE sqrt(h))), shape as given.

    The order of values is kept, so the forest's comparisons (eq. 7) mean the same.
    """
    quantised = np.empty(histograms.shape, np.uint8)
    for i in range(histograms.shape[0]):
        for k in range(histograms.shape[1]):
            quantised[i, k] = min(255.0, LEVEL_SCALE * math.sqrt(histograms[i, k]) + 0.5)
    return quantised
