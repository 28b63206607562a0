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

"""The 3-D Local Shape Context of silhouette points (paper, section 2.2).

A point is described in three passes: gather the points in reach, compute the bins of all of them
with arithmetic that vectorises, and add their weights to the bins one by one.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.fast_math import log2_from_bits, polynomial
from lsc_pose_ros.numerics.jit import kernel

RADIUS_BINS = 5
AZIMUTH_BINS = 12
ZENITH_BINS = 6
DESCRIPTOR_SIZE = RADIUS_BINS * AZIMUTH_BINS * ZENITH_BINS

# A descriptor's bins are quantised to bytes, LEVEL_SCALE * sqrt(h): the square root spends most
# levels on small values (a bin holds 1/360 on average and rarely more than a quarter).
LEVEL_SCALE = 512.0

# While it is filled, a histogram has a thirteenth azimuth bin as the neighbour of the last one; it
# is added to the first bin in the end.
_RING = (AZIMUTH_BINS + 1) * ZENITH_BINS

_SINGLE: Any = np.float32
_ZERO, _HALF, _ONE = map(_SINGLE, (0, 0.5, 1))
_PI, _HALF_PI = map(_SINGLE, (math.pi, math.pi / 2))
_PER_AZIMUTH = _SINGLE(AZIMUTH_BINS / (2 * math.pi))
_PER_ZENITH = _SINGLE(ZENITH_BINS / math.pi)

# Coefficients, the constant first, for arguments from 0 to 1: atan(t) / t in t^2 (Chebyshev), and
# acos(v) / sqrt(1 - v) (Abramowitz and Stegun, 4.4.46).
_ARC_TANGENT = tuple(
    map(_SINGLE, (0.999994835, -0.332957110, 0.195346590, -0.120448585, 0.056589985, -0.013130382))
)
_ARC_COSINE = tuple(
    map(
        _SINGLE,
        (
            1.5707963050,
            -0.2145988016,
            0.0889789874,
            -0.0501743046,
            0.0308918810,
            -0.0170881256,
            0.0066700901,
            -0.0012624911,
        ),
    )
)


class _Reach(NamedTuple):
    """The points in reach of one point, relative to it; only the first `found` are valid.

    Attributes:
        x, y, z, squared: offset in metres and its squared length, shape (N,).
        bits: a view of `squared` as integers.
    """

    x: NDArray[np.float32]
    y: NDArray[np.float32]
    z: NDArray[np.float32]
    squared: NDArray[np.float32]
    bits: NDArray[np.int32]


class _Bins(NamedTuple):
    """The bins that those points fall into, shape (N,) each.

    Attributes:
        lowest: the lowest of the eight bins.
        radius, azimuth, zenith: the fraction of the weight for the next bin.
    """

    lowest: NDArray[np.int32]
    radius: NDArray[np.float32]
    azimuth: NDArray[np.float32]
    zenith: NDArray[np.float32]


@kernel
def mean_distance(points: NDArray[np.float32]) -> float:
    """Return rho_bar, the mean distance over all pairs of `points`, shape (N, 3), in metres.

    It is 0 for fewer than two points.
    """
    count = len(points)
    if count < 2:
        return 0.0
    x, y, z = points.T.copy()
    total = 0.0
    for i in range(count - 1):
        row = _ZERO
        for j in range(i + 1, count):
            dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
            row += math.sqrt(dx * dx + dy * dy + dz * dz)
        total += row
    pairs = count * (count - 1) // 2
    return total / pairs


@kernel
def describe(
    points: NDArray[np.float32],
    centres: NDArray[np.int64],
    radius: float,
    inner_radius: float,
) -> NDArray[np.uint8]:
    """Return the quantised 3DLSC descriptors of some of the points, shape (Q, 360) (eq. 3, 4).

    The bins are radius x azimuth x zenith. Every other point within `radius` adds the weight 1,
    split over the two nearest bin centres of each dimension: the logarithm of the distance, the
    azimuth in the image plane (it wraps), and the zenith against the camera's z axis. A bin is
    quantised to min(255, round(LEVEL_SCALE sqrt(h))), h its fraction of all weight; the rounding
    may be off by one level.

    Args:
        points: metres, shape (N, 3).
        centres: the indices of the points to describe, shape (Q,); all points are their context.
        radius: the reach of a descriptor, metres.
        inner_radius: the inner limit of the first radius bin, as a fraction of `radius`; points
            that are nearer count there.
    """
    count = len(points)
    x, y, z = points.T.copy()
    near = np.empty((4, count + 1), np.float32)
    reach = _Reach(near[0], near[1], near[2], near[3], near[3].view(np.int32))
    fractions = np.empty((3, count), np.float32)
    bins = _Bins(np.empty(count, np.int32), fractions[0], fractions[1], fractions[2])
    histogram = np.empty(RADIUS_BINS * _RING, np.float32)
    quantised = np.empty((len(centres), DESCRIPTOR_SIZE), np.uint8)
    # log2 of a squared distance, times `per_log`, plus `shift`, counts radius bins.
    bins_per_octave = RADIUS_BINS / -np.log2(inner_radius)
    per_log = _SINGLE(0.5 * bins_per_octave)
    shift = _SINGLE(RADIUS_BINS - 0.5 - np.log2(radius) * bins_per_octave)
    for q in range(len(centres)):
        found = _gather(x, y, z, centres[q], _SINGLE(radius * radius), reach)
        _measure(reach, found, per_log, shift, bins)
        histogram[:] = 0
        _scatter(bins, found, histogram)
        _to_quantised(histogram, found, quantised[q])
    return quantised


@kernel
def _gather(
    x: NDArray[np.float32],
    y: NDArray[np.float32],
    z: NDArray[np.float32],
    i: int,
    farthest: float,
    reach: _Reach,
) -> int:
    """Fill `reach` with the points within the squared distance `farthest`; return their number."""
    found = 0
    for j in range(len(x)):
        dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
        squared = dx * dx + dy * dy + dz * dz
        # Always written, and overwritten if out of reach: half of the points are in reach, and an
        # unpredictable branch costs more. Points at one position have no direction between them.
        reach.x[found], reach.y[found], reach.z[found] = dx, dy, dz
        reach.squared[found] = squared
        found += (squared <= farthest) & (squared > _ZERO)
    return found


@kernel
def _measure(reach: _Reach, found: int, per_log: float, shift: float, bins: _Bins) -> None:
    """Compute bins and fractions from offsets, without branches so that the loop vectorises."""
    for j in range(found):
        radius = log2_from_bits(reach.bits[j]) * per_log + shift
        radius = min(max(radius, _ZERO), _SINGLE(RADIUS_BINS - 1))
        azimuth = _angle(reach.x[j], reach.y[j]) * _PER_AZIMUTH + _SINGLE(AZIMUTH_BINS - 0.5)
        azimuth -= _SINGLE(AZIMUTH_BINS) if azimuth >= _SINGLE(AZIMUTH_BINS) else _ZERO
        cosine = reach.z[j] / math.sqrt(reach.squared[j])
        zenith = _arc_cosine(cosine) * _PER_ZENITH - _HALF
        zenith = min(max(zenith, _ZERO), _SINGLE(ZENITH_BINS - 1))
        # The very end of the scale is expressed as the last bin but one with fraction 1.
        # NaN becomes some integer, so each bin is bounded below as well.
        near = max(min(np.int32(radius), np.int32(RADIUS_BINS - 2)), np.int32(0))
        first = max(min(np.int32(azimuth), np.int32(AZIMUTH_BINS - 1)), np.int32(0))
        front = max(min(np.int32(zenith), np.int32(ZENITH_BINS - 2)), np.int32(0))
        bins.radius[j] = radius - _SINGLE(near)
        bins.azimuth[j] = azimuth - _SINGLE(first)
        bins.zenith[j] = zenith - _SINGLE(front)
        bins.lowest[j] = near * _RING + first * ZENITH_BINS + front


@kernel
def _scatter(bins: _Bins, found: int, histogram: NDArray[np.float32]) -> None:
    """Split the weight 1 of each point over its eight bins (eq. 4)."""
    for j in range(found):
        low = bins.lowest[j]
        to_far, to_next, to_back = bins.radius[j], bins.azimuth[j], bins.zenith[j]
        # Eight lines because a loop over the four corners takes a third more time.
        weight = (_ONE - to_far) * (_ONE - to_next)
        histogram[low] += weight * (_ONE - to_back)
        histogram[low + 1] += weight * to_back
        weight = (_ONE - to_far) * to_next
        histogram[low + ZENITH_BINS] += weight * (_ONE - to_back)
        histogram[low + ZENITH_BINS + 1] += weight * to_back
        weight = to_far * (_ONE - to_next)
        histogram[low + _RING] += weight * (_ONE - to_back)
        histogram[low + _RING + 1] += weight * to_back
        weight = to_far * to_next
        histogram[low + _RING + ZENITH_BINS] += weight * (_ONE - to_back)
        histogram[low + _RING + ZENITH_BINS + 1] += weight * to_back


@kernel
def _to_quantised(
    histogram: NDArray[np.float32], found: int, quantised: NDArray[np.uint8]
) -> None:
    """Divide a histogram by the sum of weights (eq. 3), and quantise it."""
    scale = _SINGLE(LEVEL_SCALE * LEVEL_SCALE / max(found, 1))
    for r in range(RADIUS_BINS):
        ring = histogram[r * _RING : (r + 1) * _RING]
        for k in range(ZENITH_BINS):
            ring[k] += ring[AZIMUTH_BINS * ZENITH_BINS + k]
        for k in range(AZIMUTH_BINS * ZENITH_BINS):
            level = min(_SINGLE(255), math.sqrt(ring[k] * scale) + _HALF)
            quantised[r * AZIMUTH_BINS * ZENITH_BINS + k] = np.uint8(level)


@kernel
def _angle(x: Any, y: Any) -> Any:  # noqa: ANN401 - float32 is kept
    """Return atan2(y, x), to 6e-6 radians."""
    long, short = max(abs(x), abs(y)), min(abs(x), abs(y))
    t = short / max(long, _SINGLE(1e-30))
    s = t * t
    angle = t * polynomial(s, _ARC_TANGENT)
    angle = _HALF_PI - angle if abs(y) > abs(x) else angle
    angle = _PI - angle if x < _ZERO else angle
    return -angle if y < _ZERO else angle


@kernel
def _arc_cosine(cosine: Any) -> Any:  # noqa: ANN401 - float32 is kept
    """Return acos(cosine), to 1e-6 radians."""
    v = min(abs(cosine), _ONE)
    angle = math.sqrt(_ONE - v) * polynomial(v, _ARC_COSINE)
    return _PI - angle if cosine < _ZERO else angle
