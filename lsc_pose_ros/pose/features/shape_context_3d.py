"""The 3-D Local Shape Context of silhouette points (paper, section 2.2).

`plain/descriptor.py` says the same as its equations read. Here the work on a point is cut into
passes: gather the points in reach, measure them all with arithmetic that vectorises, and only then
scatter their weights over the bins, one by one.
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

# A descriptor's bins are kept as bytes: LEVEL_SCALE * sqrt(h), which spends the 255 levels where
# the values lie (a bin holds 1/360 on average and rarely more than a quarter).
LEVEL_SCALE = 512.0

# While it is filled, a histogram has a thirteenth azimuth bin, so that the last bin has a
# neighbour to split with; it is added to the first one in the end.
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
    """The points in reach of one point, relative to it; only the first ones are in use.

    Attributes:
        x, y, z, squared: offset in metres and its squared length, shape (N,).
        bits: the memory of `squared` as integers.
    """

    x: NDArray[np.float32]
    y: NDArray[np.float32]
    z: NDArray[np.float32]
    squared: NDArray[np.float32]
    bits: NDArray[np.int32]


class _Places(NamedTuple):
    """Where those points fall in the histogram, shape (N,) each.

    Attributes:
        bin: the lowest of the eight bins.
        radius, azimuth, zenith: the share of the weight that goes to the next bin.
    """

    bin: NDArray[np.int32]
    radius: NDArray[np.float32]
    azimuth: NDArray[np.float32]
    zenith: NDArray[np.float32]


@kernel
def mean_distance(points: NDArray[np.float32]) -> float:
    """Return rho_bar, the mean distance over all pairs of `points`, shape (N, 3), in metres.

    Fewer than two points have none: 0.
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
    """Return the 3DLSC descriptors of some of the points as levels, shape (Q, 360) (eq. 3, 4).

    The bins are radius x azimuth x zenith. Every other point within `radius` adds the weight 1,
    split over the two nearest bin centres of each dimension: the logarithm of the distance, the
    azimuth in the image plane (it wraps), and the zenith against the camera's z axis. A level is
    min(255, round(LEVEL_SCALE sqrt(h))), h the bin's share of all weight; at the border between
    two levels it may be off by one.

    Args:
        points: metres, shape (N, 3).
        centres: which of the points are described, shape (Q,); all points are their context.
        radius: how far a descriptor reaches, metres.
        inner_radius: the inner limit of the first radius bin, as a share of `radius`; what is
            nearer counts there.
    """
    count = len(points)
    x, y, z = points.T.copy()
    near = np.empty((4, count + 1), np.float32)
    reach = _Reach(near[0], near[1], near[2], near[3], near[3].view(np.int32))
    shares = np.empty((3, count), np.float32)
    places = _Places(np.empty(count, np.int32), shares[0], shares[1], shares[2])
    histogram = np.empty(RADIUS_BINS * _RING, np.float32)
    quantised = np.empty((len(centres), DESCRIPTOR_SIZE), np.uint8)
    # log2 of a squared distance, times `per_log`, plus `shift`, counts radius bins.
    bins_per_octave = RADIUS_BINS / -np.log2(inner_radius)
    per_log = _SINGLE(0.5 * bins_per_octave)
    shift = _SINGLE(RADIUS_BINS - 0.5 - np.log2(radius) * bins_per_octave)
    for q in range(len(centres)):
        found = _gather(x, y, z, centres[q], _SINGLE(radius * radius), reach)
        _measure(reach, found, per_log, shift, places)
        histogram[:] = 0
        _scatter(places, found, histogram)
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
    """Fill `reach` with what lies within the squared distance `farthest`; return how many."""
    found = 0
    for j in range(len(x)):
        dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
        squared = dx * dx + dy * dy + dz * dz
        # Written in any case and kept or not: half of the points are in reach, and a branch that
        # cannot be foretold costs more. Points in one place have no direction between them.
        reach.x[found], reach.y[found], reach.z[found] = dx, dy, dz
        reach.squared[found] = squared
        found += (squared <= farthest) & (squared > _ZERO)
    return found


@kernel
def _measure(reach: _Reach, found: int, per_log: float, shift: float, places: _Places) -> None:
    """Turn offsets into bins and shares, without branches, so that the loop vectorises."""
    for j in range(found):
        radius = log2_from_bits(reach.bits[j]) * per_log + shift
        radius = min(max(radius, _ZERO), _SINGLE(RADIUS_BINS - 1))
        azimuth = _angle(reach.x[j], reach.y[j]) * _PER_AZIMUTH + _SINGLE(AZIMUTH_BINS - 0.5)
        azimuth -= _SINGLE(AZIMUTH_BINS) if azimuth >= _SINGLE(AZIMUTH_BINS) else _ZERO
        cosine = reach.z[j] / math.sqrt(reach.squared[j])
        zenith = _arc_cosine(cosine) * _PER_ZENITH - _HALF
        zenith = min(max(zenith, _ZERO), _SINGLE(ZENITH_BINS - 1))
        # The last bin and nothing of a next one is the one before it and all of the next.
        near = min(np.int32(radius), np.int32(RADIUS_BINS - 2))
        first = min(np.int32(azimuth), np.int32(AZIMUTH_BINS - 1))
        front = min(np.int32(zenith), np.int32(ZENITH_BINS - 2))
        places.radius[j] = radius - _SINGLE(near)
        places.azimuth[j] = azimuth - _SINGLE(first)
        places.zenith[j] = zenith - _SINGLE(front)
        places.bin[j] = near * _RING + first * ZENITH_BINS + front


@kernel
def _scatter(places: _Places, found: int, histogram: NDArray[np.float32]) -> None:
    """Split the weight 1 of each point over its eight bins (eq. 4)."""
    for j in range(found):
        low = places.bin[j]
        to_far, to_next, to_back = places.radius[j], places.azimuth[j], places.zenith[j]
        # Eight lines, since a loop over the four corners costs a third more time.
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
    """Divide by the sum of weights (eq. 3), and quantise."""
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
