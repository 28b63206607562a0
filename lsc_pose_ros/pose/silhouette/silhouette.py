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

"""The silhouette of one body: smoothed depth, edge pixels, N points of them (section 2.1)."""

import math
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.rays import ImageRays
from lsc_pose_ros.numerics.fast_math import exp_neg
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.silhouette.preprocessing import (
    Window,
    fill_holes,
    fitted_to_noise,
    remove_flying_pixels,
)

# Every depth is below this, in metres; infinity and NaN are not.
_LARGEST_DEPTH = np.float32(1e9)


class Silhouette(NamedTuple):
    """The silhouette of one body, or all of it if `Settings.sample` is 'body'.

    Attributes:
        smoothed: the window without flying pixels and after eq. 1.
        rows, columns: all edge pixels E in the image, in scan order, shape (n,) (eq. 2); or all
            pixels of the body.
        points: the N of them that are kept, E', in metres, shape (N, 3).
        chosen: their indices in E, shape (N,).
    """

    smoothed: Window
    rows: NDArray[np.int32]
    columns: NDArray[np.int32]
    points: NDArray[np.float32]
    chosen: NDArray[np.int64]


def cut_out(
    depth: NDArray[np.float32], labels: NDArray[np.int32], body: int, fewest_valid: int = 0
) -> Window | None:
    """Return the window around the pixels of `body` that have a depth, or None for none.

    Args:
        depth: metres, 0 if the sensor measured nothing, shape (H, W).
        labels: body numbers, shape (H, W).
        body: the number to cut out.
        fewest_valid: the number of neighbours on the body from which a pixel without depth is
            filled, as `Settings.fill_holes`; 0: none is.
    """
    top, bottom, left, right = _bounds(depth, labels, body)
    if bottom < top:
        return None
    cut = _cut(depth, labels, body, top, bottom, left, right)
    window = Window(cut, top - 1, left - 1)
    return window if fewest_valid <= 0 else fill_holes(window, depth, fewest_valid)


@kernel
def _bounds(
    depth: NDArray[np.float32], labels: NDArray[np.int32], body: int
) -> tuple[int, int, int, int]:
    height, width = depth.shape
    top, bottom, left, right = height, -1, width, -1
    for row in range(height):
        for column in range(width):
            if labels[row, column] == body and depth[row, column] > 0:
                top = min(top, row)
                bottom = row
                left = min(left, column)
                right = max(right, column)
    return top, bottom, left, right


@kernel
def _cut(
    depth: NDArray[np.float32],
    labels: NDArray[np.int32],
    body: int,
    top: int,
    bottom: int,
    left: int,
    right: int,
) -> NDArray[np.float32]:
    height, width = depth.shape
    window = np.empty((bottom - top + 3, right - left + 3), np.float32)
    for i in range(window.shape[0]):
        row = top - 1 + i
        for j in range(window.shape[1]):
            column = left - 1 + j
            if row < 0 or row >= height or column < 0 or column >= width:
                window[i, j] = np.nan
            elif labels[row, column] == body and depth[row, column] > 0:
                window[i, j] = depth[row, column]
            else:
                window[i, j] = np.inf
    return window


@kernel
def smooth(window: Window, rays: ImageRays, sigma: float) -> NDArray[np.float32]:
    """Return the window's depth after the Gaussian filter of eq. 1, shape as before.

    Each body pixel becomes the mean of the body's pixels in its 3 x 3 neighbourhood, weighted by
    exp(-s^2 / (2 sigma^2)) with s the 3-D distance of the two back-projected points. Whole rows
    are added, one for each of the eight neighbours, so that the loops vectorise.

    Args:
        window: the body; its border row and column hold no body.
        rays: the rays of the whole image.
        sigma: metres; 0 leaves the depth unchanged.
    """
    depth = window.depth
    smoothed = depth.copy()
    if sigma <= 0:
        return smoothed
    scale = np.float32(0.5 / (sigma * sigma))
    height, width = depth.shape
    count = width - 2
    x, y = _back_project_window(window, rays)
    total, weights = np.empty(count, np.float32), np.empty(count, np.float32)
    for i in range(1, height - 1):
        centre = x[i, 1 : 1 + count], y[i, 1 : 1 + count], depth[i, 1 : 1 + count]
        total[:] = centre[2]
        weights[:] = 1
        for row in range(i - 1, i + 2):
            for first in range(3):
                if row != i or first != 1:
                    last = first + count
                    other = x[row, first:last], y[row, first:last], depth[row, first:last]
                    _add_neighbours(centre, other, scale, total, weights)
        for j in range(count):
            if centre[2][j] < _LARGEST_DEPTH:
                smoothed[i, j + 1] = total[j] / weights[j]
    return smoothed


@kernel
def _back_project_window(
    window: Window, rays: ImageRays
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return x and y of the window's pixels, metres, shape as the window each."""
    x, y = np.empty_like(window.depth), np.empty_like(window.depth)
    first = window.column + 1  # the rays have a margin of one pixel
    for i in range(x.shape[0]):
        right, down = rays.right[window.row + 1 + i], rays.down[window.row + 1 + i]
        for j in range(x.shape[1]):
            x[i, j] = right[first + j] * window.depth[i, j]
            y[i, j] = down[first + j] * window.depth[i, j]
    return x, y


_Row: TypeAlias = tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]


@kernel
def _add_neighbours(
    centre: _Row,
    other: _Row,
    scale: np.float32,
    total: NDArray[np.float32],
    weights: NDArray[np.float32],
) -> None:
    """Add one neighbour of each pixel of a row to the weighted sums.

    Args:
        centre: x, y and z of the row's pixels, metres, shape (n,) each.
        other: the neighbours', likewise.
        scale: 1 / (2 sigma^2).
        total: the weighted sums of depths; changed.
        weights: the sums of weights; changed.
    """
    x, y, z = centre
    other_x, other_y, other_z = other
    for j in range(len(z)):
        dx, dy, dz = other_x[j] - x[j], other_y[j] - y[j], other_z[j] - z[j]
        weight = exp_neg(scale * (dx * dx + dy * dy + dz * dz))
        # Without branches infinity and NaN pass through the arithmetic; here they are left out.
        valid = other_z[j] < _LARGEST_DEPTH
        weight = weight if valid else np.float32(0)
        weights[j] += weight
        total[j] += weight * (other_z[j] if valid else np.float32(0))


@kernel
def find_edges(depth: NDArray[np.float32], threshold: float) -> NDArray[np.int32]:
    """Return the window's silhouette pixels as (row, column) in scan order, shape (n, 2).

    A pixel belongs to E if the largest depth in its 3 x 3 neighbourhood exceeds its own by more
    than `threshold` metres (eq. 2). The background is at infinity. Outside of the image the depth
    is unknown (NaN) and makes no edge, so a body that the image cuts off has none along the cut.

    Args:
        depth: the window's, smoothed.
        threshold: t_d, metres.
    """
    edges = np.empty((depth.size, 2), np.int32)
    count = 0
    for i in range(1, depth.shape[0] - 1):
        for j in range(1, depth.shape[1] - 1):
            limit = depth[i, j] + threshold
            if not math.isfinite(limit):
                continue
            if _any_deeper(depth, i, j, limit):
                edges[count, 0] = i
                edges[count, 1] = j
                count += 1
    return edges[:count].copy()


@kernel
def _any_deeper(depth: NDArray[np.float32], i: int, j: int, limit: float) -> bool:
    for di in range(-1, 2):
        for dj in range(-1, 2):
            if depth[i + di, j + dj] > limit:
                return True
    return False


def choose_uniformly(available: int, wanted: int) -> NDArray[np.int64]:
    """Return `wanted` indices, evenly spread from 0 to `available` - 1; all if there are fewer."""
    count = min(available, wanted)
    return (np.arange(count) * available + available // 2) // max(count, 1)


def find_silhouette(window: Window, rays: ImageRays, settings: Settings) -> Silhouette:
    """Return the silhouette of the body in `window`: eq. 1, eq. 2 and the choice of N points.

    Depending on the settings, flying pixels are removed first, and sigma and t_d grow with the
    sensor's noise.
    """
    solid = remove_flying_pixels(window, settings)
    settings = fitted_to_noise(solid, settings)
    smoothed = smooth(solid, rays, settings.smoothing_sigma)
    return silhouette_in(solid._replace(depth=smoothed), rays, settings)


def silhouette_in(smoothed: Window, rays: ImageRays, settings: Settings) -> Silhouette:
    """Return the silhouette of the body in a smoothed window.

    If `Settings.sample` is 'body', the points are evenly spread over all of its pixels.
    """
    if settings.sample == 'body':
        edges = np.argwhere(np.isfinite(smoothed.depth)).astype(np.int32)
    else:
        edges = find_edges(smoothed.depth, settings.edge_threshold)
    rows = edges[:, 0] + np.int32(smoothed.row)
    columns = edges[:, 1] + np.int32(smoothed.column)
    chosen = choose_uniformly(len(edges), settings.points)
    kept = edges[chosen]
    depth = smoothed.depth[kept[:, 0], kept[:, 1]]
    at = rows[chosen] + 1, columns[chosen] + 1  # the rays have a margin of one pixel
    points = np.stack([rays.right[at] * depth, rays.down[at] * depth, depth], axis=-1)
    return Silhouette(smoothed, rows, columns, points, chosen)
