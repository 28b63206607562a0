"""Parzen densities over votes, and their modes (eq. 14 and 15)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.fast_math import exp_neg
from lsc_pose_ros.numerics.jit import kernel

# A mode is found when a step is shorter than this share of the bandwidth.
_STANDSTILL = 1e-2
_MOST_STEPS = 50
# Another mode is not looked for where the density is below this share of its largest value.
FAINT = np.float32(0.2)


# x, y, z in metres, single precision; what is given may be a row of an array as well.
Point = tuple[np.float32, np.float32, np.float32]
Place = Point | NDArray[np.float32]


class Cloud(NamedTuple):
    """Weighted points, coordinate by coordinate so that loops over them vectorise.

    Attributes:
        x, y, z: metres, single precision, shape (M,) each.
        weight: single precision, shape (M,).
    """

    x: NDArray[np.float32]
    y: NDArray[np.float32]
    z: NDArray[np.float32]
    weight: NDArray[np.float32]


@kernel
def density(place: Place, cloud: Cloud, bandwidth: float) -> np.float32:
    """Return phi(x) = sum over m of w_m exp(-||x - x_m||^2 / h^2) (eq. 14, 15).

    Votes farther than four bandwidths count nothing.

    Args:
        place: x, metres, shape (3,).
        cloud: the votes x_m and their weights w_m.
        bandwidth: h, metres.
    """
    scale = np.float32(1.0 / (bandwidth * bandwidth))
    x, y, z = place[0], place[1], place[2]
    total = np.float32(0)
    for m in range(cloud.x.shape[0]):
        dx = cloud.x[m] - x
        dy = cloud.y[m] - y
        dz = cloud.z[m] - z
        total += cloud.weight[m] * exp_neg(scale * (dx * dx + dy * dy + dz * dz))
    return total


@kernel
def mean_shift(place: Place, cloud: Cloud, bandwidth: float) -> Point:
    """Return the votes' mean under a Gaussian at `place`: one step uphill; arguments as `density`.

    Where no vote is near, `place` itself.
    """
    scale = np.float32(1.0 / (bandwidth * bandwidth))
    x, y, z = place[0], place[1], place[2]
    total, to_x, to_y, to_z = np.float32(0), np.float32(0), np.float32(0), np.float32(0)
    for m in range(cloud.x.shape[0]):
        dx = cloud.x[m] - x
        dy = cloud.y[m] - y
        dz = cloud.z[m] - z
        pull = cloud.weight[m] * exp_neg(scale * (dx * dx + dy * dy + dz * dz))
        total += pull
        to_x += pull * dx
        to_y += pull * dy
        to_z += pull * dz
    if total > 0:
        return x + to_x / total, y + to_y / total, z + to_z / total
    return x, y, z


@kernel
def squared_distance(first: Place, second: Place) -> np.float32:
    """Return the squared distance of two places, shape (3,) each."""
    dx = first[0] - second[0]
    dy = first[1] - second[1]
    dz = first[2] - second[2]
    return dx * dx + dy * dy + dz * dz


@kernel
def climb(place: Place, cloud: Cloud, bandwidth: float) -> Point:
    """Return the mode of the density that mean-shift reaches from `place`, shape (3,)."""
    standstill = (_STANDSTILL * bandwidth) ** 2
    here = (place[0], place[1], place[2])
    for _ in range(_MOST_STEPS):
        shifted = mean_shift(here, cloud, bandwidth)
        moved = squared_distance(here, shifted)
        here = shifted
        if moved < standstill:
            break
    return here


@kernel
def find_modes(cloud: Cloud, bandwidth: float, wanted: int) -> NDArray[np.float32]:
    """Return at most `wanted` modes of the density, the highest start first, shape (n, 3).

    The first climb starts at the vote where the density is largest. The next one starts at the
    best of the votes farther than a bandwidth from all starts and all modes before it, unless the
    density is too faint there. Modes closer than a bandwidth are one.
    """
    count = cloud.x.shape[0]
    modes = np.empty((wanted, 3), np.float32)
    found = 0
    heights = np.empty(count, np.float32)
    for m in range(count):
        heights[m] = density(_vote(cloud, m), cloud, bandwidth)
    faint = FAINT * heights.max() if count else np.float32(0)
    near = np.float32(bandwidth * bandwidth)
    while found < wanted and count:
        best = int(np.argmax(heights))
        if heights[best] <= faint:
            break
        start = _vote(cloud, best)
        mode = climb(start, cloud, bandwidth)
        known = False
        for k in range(found):
            known = known or bool(squared_distance(mode, modes[k]) < near)
        if not known:
            modes[found, 0], modes[found, 1], modes[found, 2] = mode
            found += 1
        heights[best] = -1
        for m in range(count):
            vote = _vote(cloud, m)
            if squared_distance(vote, mode) < near or squared_distance(vote, start) < near:
                heights[m] = -1
    return modes[:found]


@kernel
def _vote(cloud: Cloud, m: int) -> Point:
    return cloud.x[m], cloud.y[m], cloud.z[m]
