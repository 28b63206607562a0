"""Which depths of a body lie on its surface: no holes, no flying pixels, and how noisy they are.

The paper's Kinect needs little of it; a time-of-flight camera needs all. It goes beyond the paper.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.settings import Settings

# A second difference of the depth beyond this is a step between two surfaces, metres.
_STEP = 0.1

# Of n independent normal depths, the mean of |a - 2 b + c| is sqrt(6) sqrt(2 / pi) sigma.
_MEAN_DIFFERENCE = math.sqrt(6.0) * math.sqrt(2.0 / math.pi)


class Window(NamedTuple):
    """One body, cut out of the image with a border of one pixel.

    Attributes:
        depth: metres; infinity where there is no body or no depth, NaN outside of the image.
        row: the image row of the window's first row (-1 where the border lies outside).
        column: likewise for columns.
    """

    depth: NDArray[np.float32]
    row: int
    column: int


def on_surfaces(window: Window, settings: Settings) -> Window:
    """Return the window without its flying pixels; what is taken out becomes background.

    At the rim of a surface a time-of-flight camera mixes the light of what lies before and behind,
    and measures a depth between the two where there is nothing. Such a pixel hangs on its line of
    sight, away from its neighbours, whereas a pixel of a surface has some at its own depth.
    """
    if settings.fewest_neighbours <= 0:
        return window
    near = settings.fewest_neighbours, settings.neighbour_distance
    return Window(drop_flying(window.depth, *near), window.row, window.column)


@kernel
def drop_flying(depth: NDArray[np.float32], fewest: int, distance: float) -> NDArray[np.float32]:
    """Return the window's depth, infinity where a pixel has too few neighbours at its own depth.

    Args:
        depth: the window's; its border row and column hold no body.
        fewest: how many of the eight neighbours there must be.
        distance: how far in depth they may be, metres.
    """
    kept = depth.copy()
    for i in range(1, depth.shape[0] - 1):
        for j in range(1, depth.shape[1] - 1):
            if not math.isfinite(depth[i, j]):
                continue
            neighbours = -1  # the pixel itself
            for di in range(-1, 2):
                for dj in range(-1, 2):
                    if abs(depth[i + di, j + dj] - depth[i, j]) <= distance:
                        neighbours += 1
            if neighbours < fewest:
                kept[i, j] = np.inf
    return kept


@kernel
def depth_noise(depth: NDArray[np.float32]) -> float:
    """Return the standard deviation of the noise of a window's depth, metres; 0 of a speck.

    A surface bends little from a pixel to the next but one, so that the second differences of the
    depth, along rows and columns, are noise: the sensor's own, and the steps in which it counts.
    Those larger than _STEP cross an edge, and are left out.

    Args:
        depth: the window's; its border row and column hold no body.
    """
    total, count = 0.0, 0
    for i in range(1, depth.shape[0] - 1):
        for j in range(1, depth.shape[1] - 1):
            across = abs(depth[i, j - 1] - 2 * depth[i, j] + depth[i, j + 1])
            down = abs(depth[i - 1, j] - 2 * depth[i, j] + depth[i + 1, j])
            # False for NaN and infinity.
            if across < _STEP:
                total += across
                count += 1
            if down < _STEP:
                total += down
                count += 1
    return total / (_MEAN_DIFFERENCE * max(count, 1))


def fitted_to_noise(window: Window, settings: Settings) -> Settings:
    """Return the settings with sigma and t_d at least `noise_factor` times the window's noise."""
    if settings.noise_factor <= 0:
        return settings
    least = settings.noise_factor * depth_noise(window.depth)
    return settings._replace(
        smoothing_sigma=max(settings.smoothing_sigma, least),
        edge_threshold=max(settings.edge_threshold, least),
    )


def fill_holes(window: Window, depth: NDArray[np.float32], fewest: int) -> Window:
    """Return the window with depths for single pixels that the sensor did not see.

    Each is a hole in the body's surface otherwise, and its neighbours would be silhouette. Masks
    that come from the depth do not have such pixels, so that the mask is not asked.

    Args:
        window: the body's.
        depth: the image's, metres, 0 where the sensor saw nothing, shape (H, W).
        fewest: a pixel without depth takes the median of its neighbours' on the body, where at
            least so many of the eight are.
    """
    filled = _fill_holes(window.depth, depth, (window.row, window.column), fewest)
    return window._replace(depth=filled)


@kernel
def _fill_holes(
    window: NDArray[np.float32],
    depth: NDArray[np.float32],
    place: tuple[int, int],
    fewest: int,
) -> NDArray[np.float32]:
    row, column = place
    filled = window.copy()
    around = np.empty(9, np.float32)
    for i in range(1, window.shape[0] - 1):
        for j in range(1, window.shape[1] - 1):
            if window[i, j] != np.inf or depth[row + i, column + j] > 0:
                continue
            seen = 0
            for di in range(-1, 2):
                for dj in range(-1, 2):
                    if math.isfinite(window[i + di, j + dj]):
                        around[seen] = window[i + di, j + dj]
                        seen += 1
            if seen >= fewest:
                filled[i, j] = np.sort(around[:seen])[seen // 2]
    return filled
