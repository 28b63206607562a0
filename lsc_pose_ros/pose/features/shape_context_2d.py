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

"""The 2-D shape context of silhouette points: 2DSC, a rival of the paper's feature.

It is the paper's descriptor without depth. A. Agarwal and B. Triggs, "Recovering 3D human pose
from monocular images", PAMI 28(1), 2006, use the same 5 radius and 12 azimuth bins over the
silhouette in the image, also without rotation to the local direction.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel

RADIUS_BINS = 5
AZIMUTH_BINS = 12
SIZE = RADIUS_BINS * AZIMUTH_BINS

# A bin is quantised to the byte LEVEL_SCALE * sqrt(h). One of 60 bins holds more than one of 360,
# so, unlike in the 3-D descriptor, the scale covers all values up to 1.
LEVEL_SCALE = 255.0


@kernel
def describe_in_image(
    pixels: NDArray[np.float32],
    centres: NDArray[np.int64],
    radius: float,
    inner_radius: float,
) -> NDArray[np.uint8]:
    """Return the quantised 2-D shape contexts of some of the points, shape (Q, 60).

    The bins are radius x azimuth. Every other point within `radius` adds the weight 1, split over
    the two nearest bin centres of both dimensions: the logarithm of the distance (clamped at the
    ends), and the azimuth (it wraps). A bin is quantised to round(LEVEL_SCALE sqrt(h)), h its
    fraction of all weight.

    Args:
        pixels: column and row of each point, shape (N, 2).
        centres: the indices of the points to describe, shape (Q,); all points are their context.
        radius: the reach of a descriptor, pixels.
        inner_radius: the inner limit of the first radius bin, as a fraction of `radius`; points
            that are nearer count there.
    """
    quantised = np.empty((centres.shape[0], SIZE), np.uint8)
    histogram = np.empty((RADIUS_BINS, AZIMUTH_BINS))
    per_log = RADIUS_BINS / -math.log(inner_radius)
    for q in range(centres.shape[0]):
        histogram[:] = 0
        total = 0
        for j in range(pixels.shape[0]):
            dx = pixels[j, 0] - pixels[centres[q], 0]
            dy = pixels[j, 1] - pixels[centres[q], 1]
            squared = dx * dx + dy * dy
            # Two points at one position have no direction between them.
            if squared > radius * radius or squared == 0:
                continue
            ring = RADIUS_BINS - 0.5 + 0.5 * math.log(squared / (radius * radius)) * per_log
            _add(histogram, ring, math.atan2(dy, dx) * (AZIMUTH_BINS / (2 * math.pi)) - 0.5)
            total += 1
        scale = LEVEL_SCALE / math.sqrt(max(total, 1))
        for k in range(SIZE):
            level = scale * math.sqrt(histogram[k // AZIMUTH_BINS, k % AZIMUTH_BINS]) + 0.5
            quantised[q, k] = np.uint8(min(255.0, level))
    return quantised


@kernel
def _add(histogram: NDArray[np.float64], radius: float, azimuth: float) -> None:
    """Split the weight 1 over the four bins around a position measured in bin centres."""
    radius = min(max(radius, 0.0), RADIUS_BINS - 1.0)
    near = max(min(int(radius), RADIUS_BINS - 2), 0)  # NaN becomes some integer
    to_far = radius - near
    floor = math.floor(azimuth)
    to_next = azimuth - floor
    here = int(floor) % AZIMUTH_BINS
    following = (here + 1) % AZIMUTH_BINS
    histogram[near, here] += (1 - to_far) * (1 - to_next)
    histogram[near, following] += (1 - to_far) * to_next
    histogram[near + 1, here] += to_far * (1 - to_next)
    histogram[near + 1, following] += to_far * to_next
