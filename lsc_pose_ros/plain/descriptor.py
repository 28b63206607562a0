"""The descriptor of eq. 3 and 4, pair by pair, bin by bin."""

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
def mean_distance(points: NDArray[np.float32]) -> float:
    """Return rho_bar, the mean distance over all pairs of `points`, shape (N, 3), in metres.

    Fewer than two points have none: 0.
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
def _two_bins(place: float, bins: int) -> tuple[int, int, float]:
    """Return the two bins around `place` (bin centres are whole numbers), clamped at the ends."""
    if place <= 0:
        return 0, 0, 0.0
    if place >= bins - 1:
        return bins - 1, bins - 1, 0.0
    low = int(place)
    return low, low + 1, place - low


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
        centres: which of them are described, shape (Q,).
        radius: how far a descriptor reaches, metres.
        inner_radius: the inner limit of the first radius bin, as a share of `radius`; what is
            nearer counts there.
    """
    return _histograms((points, centres), radius, inner_radius, shared=True)


@kernel
def describe_by_nearest_bin(
    points: NDArray[np.float32], centres: NDArray[np.int64], radius: float, inner_radius: float
) -> NDArray[np.float32]:
    """Return the same without multi-binning: each point counts in one bin alone.

    It counts in the bin whose centre is nearest in each dimension, that is, in the bin that it
    lies in. The paper's Fig. 11 measures what the sharing of eq. 4 is good for against this.
    Arguments as `describe`.
    """
    return _histograms((points, centres), radius, inner_radius, shared=False)


@kernel
def _histograms(
    seen: tuple[NDArray[np.float32], NDArray[np.int64]],
    radius: float,
    inner_radius: float,
    shared: bool,  # noqa: FBT001 - kernels take no keyword-only arguments
) -> NDArray[np.float32]:
    points, centres = seen
    histograms = np.zeros((centres.shape[0], DESCRIPTOR_SIZE), np.float32)
    per_log = RADIUS_BINS / -math.log(inner_radius)
    for row, i in enumerate(centres):
        total = 0
        for j in range(points.shape[0]):
            dx = points[j, 0] - points[i, 0]
            dy = points[j, 1] - points[i, 1]
            dz = points[j, 2] - points[i, 2]
            squared = dx * dx + dy * dy + dz * dz
            # Two points in one place have no direction between them.
            if squared > radius * radius or squared == 0:
                continue
            distance = math.sqrt(squared)
            far = RADIUS_BINS + math.log(distance / radius) * per_log
            azimuth = math.atan2(dy, dx) * (AZIMUTH_BINS / (2 * math.pi))
            zenith = math.acos(min(1.0, max(-1.0, dz / distance))) * (ZENITH_BINS / math.pi)
            if shared:
                _add(histograms[row], far - 0.5, azimuth - 0.5, zenith - 0.5)
            else:
                _add_to_one(histograms[row], far, azimuth, zenith)
            total += 1
        if total:
            histograms[row] /= np.float32(total)
    return histograms


@kernel
def _add(histogram: NDArray[np.float32], radius: float, azimuth: float, zenith: float) -> None:
    """Split the weight 1 over the eight bins around a place given in bin centres (eq. 4)."""
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


@kernel
def _add_to_one(
    histogram: NDArray[np.float32], radius: float, azimuth: float, zenith: float
) -> None:
    """Add 1 to the bin around a place given in bins from the first bin's beginning."""
    ring = min(max(math.floor(radius), 0), RADIUS_BINS - 1) * AZIMUTH_BINS
    sector = (ring + math.floor(azimuth) % AZIMUTH_BINS) * ZENITH_BINS
    histogram[sector + min(math.floor(zenith), ZENITH_BINS - 1)] += 1


@kernel
def quantise(histograms: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return descriptors as bytes, min(255, round(LEVEL_SCALE sqrt(h))), shape as given.

    The order of values is kept, so the forest's comparisons (eq. 7) mean the same.
    """
    quantised = np.empty(histograms.shape, np.uint8)
    for i in range(histograms.shape[0]):
        for k in range(histograms.shape[1]):
            quantised[i, k] = min(255.0, LEVEL_SCALE * math.sqrt(histograms[i, k]) + 0.5)
    return quantised
