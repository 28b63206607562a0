"""How good a split is: the entropy of the joints' contributions (eq. 8 to 10)."""

import math

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.core.jit import kernel, parallel_kernel
from lsc_pose_ros.core.logarithm import log2_of_bits


@parallel_kernel
def contributions(
    points: NDArray[np.float32], person: NDArray[np.int32], joints: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Return p(x_j | p) of each sample, shape (S, J), rows summing to 1 (eq. 10).

    p(x_j | p) ~ exp(-||x_j - p||^2 / rho_bar^2) where ||x_j - p|| <= rho_bar, else 0; lengths are
    in units of rho_bar. A point with no labelled joint in reach has a row of zeros.

    Args:
        points: shape (S, 3).
        person: whose point it is, shape (S,).
        joints: NaN where not labelled, shape (P, J, 3).
    """
    count = joints.shape[1]
    result = np.zeros((points.shape[0], count), np.float32)
    for s in range(points.shape[0]):
        total = 0.0
        for j in range(count):
            dx = joints[person[s], j, 0] - points[s, 0]
            dy = joints[person[s], j, 1] - points[s, 1]
            dz = joints[person[s], j, 2] - points[s, 2]
            squared = dx * dx + dy * dy + dz * dz
            if squared <= 1:  # false for NaN
                result[s, j] = math.exp(-squared)
                total += result[s, j]
        if total > 0:
            result[s] /= np.float32(total)
    return result


@kernel
def entropy_times_count(
    sums: NDArray[np.float32], bits: NDArray[np.int32], count: float
) -> np.float32:
    """Return |S| H(S) = -sum over j of s_j log2(s_j / |S|), s_j the sums of contributions (eq. 9).

    The unit is the bit: it is compared with its like only. To 2e-5 |S|, so that it vectorises.

    Args:
        sums: of each joint's contributions over the set, shape (J,).
        bits: the memory of `sums` as integers, shape (J,).
        count: |S|, how many samples the set has.
    """
    total, weight = np.float32(0), np.float32(0)
    for j in range(sums.shape[0]):
        total += sums[j] * log2_of_bits(bits[j])
        weight += sums[j]
    return weight * np.float32(np.log2(count)) - total
