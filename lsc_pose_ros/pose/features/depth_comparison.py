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

"""Depth comparison features: DCF, a rival of the paper's feature.

J. Shotton et al., "Real-time human pose recognition in parts from single depth images", CVPR
2011, eq. 1: f(I, x) = d(x + u / d(x)) - d(x + v / d(x)), the difference of the depths at two
offsets from a pixel; everything but the body is very far away. There each split draws its own
pairs (u, v). Here offsets and pairs are drawn once, so the pairs are numbered features like the
bins of a histogram. Many pairs share few offsets because reading the depths takes the time.
"""

import random
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.silhouette.preprocessing import Window

# The number of offsets that the pairs share. The number of pairs and the reach of offsets are
# settings. On real people, trained on 600 and 2,000 frames, pools of 300 to 2,000 pairs differ by
# no more than other seeds do, so there are as many pairs as the paper's feature has bins. Offsets
# up to 0.25, 0.5 and 0.8 m differ little; the mean error is smallest with 0.5 m.
OFFSETS = 128

# The depth beside the body, metres.
FAR = 10.0

# A difference is quantised to the byte MIDDLE + difference / DEPTH_STEP. The range is +-1 m, more
# than an arm stretched to the camera; the step is 8 mm, less than a sensor's noise. If one depth
# is beside the body, the byte is 0 or 255; if both are, it is MIDDLE.
DEPTH_STEP = 0.008
MIDDLE = 128


class OffsetPool(NamedTuple):
    """Offsets, and the pairs of offsets that are compared.

    Attributes:
        offsets: x and y in metres, shape (OFFSETS + 1, 2); the first is 0, the point itself.
        first, second: the indices of the two offsets of each pair, shape (pairs,) each.
    """

    offsets: NDArray[np.float32]
    first: NDArray[np.int32]
    second: NDArray[np.int32]


@lru_cache(maxsize=8)
def offset_pool(pairs: int, reach: float, seed: int) -> OffsetPool:
    """Return random offsets and pairs.

    Offsets are drawn evenly from the square of half side `reach`. An offset in metres, times the
    focal length and divided by the depth, is one in pixels, whatever the camera. In every other
    pair the second offset is 0: the point itself is compared.

    Args:
        pairs: the number of pairs.
        reach: the largest offset in x and in y, metres.
        seed: the seed of the random numbers.
    """
    # Python's own generator because its `random` gives the same numbers in every version: a model
    # file holds the seed, not the pool.
    draw = random.Random(seed).random  # noqa: S311 - nothing secret
    offsets = np.zeros((OFFSETS + 1, 2))
    offsets[1:] = [[reach * (2 * draw() - 1) for _ in range(2)] for _ in range(OFFSETS)]
    chosen = np.array([[1 + int(draw() * OFFSETS) for _ in range(2)] for _ in range(pairs)])
    chosen[1::2, 1] = 0
    first, second = chosen.T.astype(np.int32, order='C')
    pool = OffsetPool(offsets.astype(np.float32), first, second)
    for array in pool:
        array.flags.writeable = False  # the cache returns it again
    return pool


@kernel
def compare_depths(
    window: Window, pixels: NDArray[np.int32], pool: OffsetPool, focal_lengths: tuple[float, float]
) -> NDArray[np.uint8]:
    """Return the quantised depth comparisons of some of the body's pixels, shape (Q, pairs).

    Each is MIDDLE + (d(x + u f / d(x)) - d(x + v f / d(x))) / DEPTH_STEP, rounded and clipped to a
    byte; d is FAR beside the body and outside of the image.

    Args:
        window: the body.
        pixels: row and column in the window, each on the body, shape (Q, 2).
        pool: pairs of offsets.
        focal_lengths: fx and fy, pixels. The distortion of a lens is ignored over the short
            distance of an offset.
    """
    quantised = np.empty((pixels.shape[0], pool.first.shape[0]), np.uint8)
    found = np.empty(pool.offsets.shape[0], np.float32)
    for q in range(pixels.shape[0]):
        row, column = pixels[q, 0], pixels[q, 1]
        depth = window.depth[row, column]
        per_metre_x, per_metre_y = focal_lengths[0] / depth, focal_lengths[1] / depth
        for k in range(found.shape[0]):
            x, y = pool.offsets[k, 0] * per_metre_x, pool.offsets[k, 1] * per_metre_y
            found[k] = _probe(window.depth, row + y, column + x)
        for k in range(quantised.shape[1]):
            difference = found[pool.first[k]] - found[pool.second[k]]
            level = difference * np.float32(1 / DEPTH_STEP) + np.float32(MIDDLE + 0.5)
            quantised[q, k] = np.uint8(min(max(level, np.float32(0)), np.float32(255)))
    return quantised


@kernel
def _probe(depth: NDArray[np.float32], row: float, column: float) -> np.float32:
    """Return the depth at the pixel nearest to a position in the window."""
    # Compared before conversion: positions far outside do not fit into an integer.
    row, column = row + 0.5, column + 0.5
    if not (0 <= row < depth.shape[0] and 0 <= column < depth.shape[1]):
        return np.float32(FAR)
    found = depth[int(row), int(column)]
    return found if np.isfinite(found) else np.float32(FAR)
