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

"""Corrections of one body's depth: flying pixels removed, holes filled, noise measured.

They go beyond the paper. Its Kinect hardly needs them; a time-of-flight camera needs them all.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.settings import Settings

# A larger second difference of the depth is a step between two surfaces, metres.
_STEP = 0.1

# Of n independent normal depths, the mean of |a - 2 b + c| is sqrt(6) sqrt(2 / pi) sigma.
_MEAN_DIFFERENCE = math.sqrt(6.0) * math.sqrt(2.0 / math.pi)


class Window(NamedTuple):
    """One body, cut out of the image with a border of one pixel.

    Attributes:
        depth: metres; infinity at the background, NaN if it is unknown what is there: outside of
            the image and beside a cut.
        row: the image row of the window's first row (-1 if the border lies outside).
        column: likewise for columns.
    """

    depth: NDArray[np.float32]
    row: int
    column: int


def remove_flying_pixels(window: Window, settings: Settings) -> Window:
    """Return the window without flying pixels; they become background, or unknown beside a cut.

    At the rim of a surface a time-of-flight camera mixes the light from the surface with that from
    behind it and measures a depth in between. Such a pixel has hardly any neighbours at its own
    depth, whereas a pixel of a surface has several.
    """
    if settings.fewest_neighbours <= 0:
        return window
    depth = drop_flying(window.depth, settings.fewest_neighbours, settings.neighbour_distance)
    return Window(depth, window.row, window.column)


@kernel
def drop_flying(depth: NDArray[np.float32], fewest: int, distance: float) -> NDArray[np.float32]:
    """Return the window's depth, infinity at pixels with too few neighbours at their own depth.

    Beside an unknown pixel (NaN), such a pixel becomes unknown, too: a mixed pixel between the
    body and a surface that hides it is no background.

    Args:
        depth: the window's; its border row and column hold no body.
        fewest: how many of the eight neighbours a pixel needs.
        distance: the largest difference in depth of a neighbour that counts, metres.
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
                kept[i, j] = np.nan if _any_unknown(depth, i, j) else np.inf
    return kept


@kernel
def _any_unknown(depth: NDArray[np.float32], i: int, j: int) -> bool:
    for di in range(-1, 2):
        for dj in range(-1, 2):
            if math.isnan(depth[i + di, j + dj]):
                return True
    return False


@kernel
def depth_noise(depth: NDArray[np.float32]) -> float:
    """Return the standard deviation of the noise of a window's depth, metres; 0 for a speck.

    A surface bends little over three pixels. So the second differences of the depth, along rows
    and columns, are noise: that of the sensor and of its quantisation. Second differences larger
    than _STEP cross an edge and are left out.

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
    """Return the window with depths for pixels inside the body that the sensor did not measure.

    Such a pixel is a hole in the body's surface, and its neighbours would count as silhouette. A
    mask that was computed from the depth leaves these pixels out, so the mask is not used here.

    Args:
        window: the body's.
        depth: the image's, metres, 0 if the sensor measured nothing, shape (H, W).
        fewest: a pixel without depth gets the median depth of its neighbours on the body if at
            least this many of the eight are on it.
    """
    filled = _fill_holes(window.depth, depth, window.row, window.column, fewest)
    return window._replace(depth=filled)


@kernel
def _fill_holes(
    window: NDArray[np.float32],
    depth: NDArray[np.float32],
    row: int,
    column: int,
    fewest: int,
) -> NDArray[np.float32]:
    filled = window.copy()
    around = np.empty(9, np.float32)
    for i in range(1, window.shape[0] - 1):
        for j in range(1, window.shape[1] - 1):
            if window[i, j] != np.inf or 0 < depth[row + i, column + j] < np.inf:
                continue
            count = 0
            for di in range(-1, 2):
                for dj in range(-1, 2):
                    if math.isfinite(window[i + di, j + dj]):
                        around[count] = window[i + di, j + dj]
                        count += 1
            if count >= fewest:
                filled[i, j] = np.sort(around[:count])[count // 2]
    return filled
