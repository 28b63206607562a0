"""The 3-D Local Shape Context without multi-binning: each point counts in one bin alone.

The paper's Fig. 11 measures what the sharing of eq. 4 is good for against this. It is written for
that comparison, not for speed.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.core.descriptor import (
    AZIMUTH_BINS,
    DESCRIPTOR_SIZE,
    RADIUS_BINS,
    ZENITH_BINS,
)
from lsc_pose_ros.core.jit import kernel


@kernel
def describe_by_nearest_bin(
    points: NDArray[np.float32], centres: NDArray[np.int64], radius: float, inner_radius: float
) -> NDArray[np.float32]:
    """Return histograms as `descriptor.describe` before they are levels, shape (Q, 360).

    Every other point within `radius` adds the weight 1 to the bin whose centre is nearest in each
    dimension, that is, to the bin that it lies in. Rows sum to 1, or to 0 where nothing is near.

    Args:
        points: metres, shape (N, 3).
        centres: which of them are described, shape (Q,).
        radius: how far a descriptor reaches, metres.
        inner_radius: the inner limit of the first radius bin, as a share of `radius`; what is
            nearer counts there.
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
            # Two points in one place have no direction between them.
            if squared > radius * radius or squared == 0:
                continue
            distance = math.sqrt(squared)
            far = math.floor(RADIUS_BINS + math.log(distance / radius) * per_log)
            azimuth = math.floor(math.atan2(dy, dx) * (AZIMUTH_BINS / (2 * math.pi)))
            cosine = min(1.0, max(-1.0, dz / distance))
            zenith = math.floor(math.acos(cosine) * (ZENITH_BINS / math.pi))
            ring = min(max(int(far), 0), RADIUS_BINS - 1) * AZIMUTH_BINS
            sector = (ring + int(azimuth) % AZIMUTH_BINS) * ZENITH_BINS
            histograms[row, sector + min(int(zenith), ZENITH_BINS - 1)] += 1
            total += 1
        if total:
            histograms[row] /= np.float32(total)
    return histograms
