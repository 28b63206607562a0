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
from typing import NamedTuple

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
    exp(-s^2 / (2 sigma^2)) with s the 3-D distance of the two back-projected points. The weight
    of a pair of neighbours is computed once and used for both. Whole rows are computed at once,
    so that the loops vectorise.

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
    points = _back_project_window(window, rays)
    z, width = points.z, depth.shape[1]
    # The weights of each pixel of a row and its neighbour on the right; and of each pixel and its
    # neighbours in the next row: on the left, below and on the right.
    beside, below = np.zeros(width, np.float32), np.zeros((3, width), np.float32)
    above = below.copy()
    for i in range(1, depth.shape[0] - 1):
        _weigh_pairs(points, (i, 0, 1), scale, beside)
        for k in range(3):
            _weigh_pairs(points, (i, 1, k - 1), scale, below[k])
        _average((z[i - 1], z[i], z[i + 1]), above, beside, below, smoothed[i])
        above, below = below, above
    return smoothed


class _WindowPoints(NamedTuple):
    """The back-projected pixels of a window, metres, 0 beside the body, shape (h, w) each."""

    x: NDArray[np.float32]
    y: NDArray[np.float32]
    z: NDArray[np.float32]


@kernel
def _back_project_window(window: Window, rays: ImageRays) -> _WindowPoints:
    depth = window.depth
    x, y, z = np.empty_like(depth), np.empty_like(depth), np.empty_like(depth)
    first = window.column + 1  # the rays have a margin of one pixel
    for i in range(depth.shape[0]):
        right, down = rays.right[window.row + 1 + i], rays.down[window.row + 1 + i]
        for j in range(depth.shape[1]):
            known = depth[i, j] if depth[i, j] < _LARGEST_DEPTH else np.float32(0)
            x[i, j], y[i, j], z[i, j] = right[first + j] * known, down[first + j] * known, known
    return _WindowPoints(x, y, z)


@kernel
def _weigh_pairs(
    points: _WindowPoints,
    pairs: tuple[int, int, int],
    scale: np.float32,
    weights: NDArray[np.float32],
) -> None:
    """Compute the weights of a row's pixels and one neighbour of each.

    Args:
        points: the window.
        pairs: the row, and by how many rows and columns the neighbours are further.
        scale: 1 / (2 sigma^2).
        weights: changed, but not at the border; 0 if one of a pair is beside the body. Shape (w,).
    """
    i, down, right = pairs
    first, last = 1 + right, len(weights) - 1 + right
    x, y, z = points.x[i, 1:-1], points.y[i, 1:-1], points.z[i, 1:-1]
    other_x, other_y = points.x[i + down, first:last], points.y[i + down, first:last]
    other_z = points.z[i + down, first:last]
    inner = weights[1:-1]
    for j in range(len(inner)):
        dx, dy, dz = other_x[j] - x[j], other_y[j] - y[j], other_z[j] - z[j]
        weight = exp_neg(scale * (dx * dx + dy * dy + dz * dz))
        inner[j] = weight if z[j] > 0 and other_z[j] > 0 else np.float32(0)


@kernel
def _average(
    rows: tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]],
    above: NDArray[np.float32],
    beside: NDArray[np.float32],
    below: NDArray[np.float32],
    smoothed: NDArray[np.float32],
) -> None:
    """Compute the weighted means of a row's body pixels.

    Args:
        rows: the depth of the row above, of the row and of the row below, shape (w,) each.
        above: the weights of the row above and the row, as `below`.
        beside: the weights of each pixel and its neighbour on the right, shape (w,).
        below: the weights of each pixel and its neighbours below on the left, below, and below on
            the right, shape (3, w).
        smoothed: the means, shape (w,); changed at pixels of the body.
    """
    count = len(smoothed) - 2
    z, mean = rows[1][1:-1], smoothed[1:-1]
    # Neighbours a, b, c above, d, e beside, f, g, h below.
    a, b, c = rows[0][:count], rows[0][1:-1], rows[0][2:]
    d, e = rows[1][:count], rows[1][2:]
    f, g, h = rows[2][:count], rows[2][1:-1], rows[2][2:]
    weight_a, weight_b, weight_c = above[2, :count], above[1, 1:-1], above[0, 2:]
    weight_d, weight_e = beside[:count], beside[1:-1]
    weight_f, weight_g, weight_h = below[0, 1:-1], below[1, 1:-1], below[2, 1:-1]
    for j in range(count):
        total = z[j] + weight_d[j] * d[j] + weight_e[j] * e[j]
        total += weight_a[j] * a[j] + weight_b[j] * b[j] + weight_c[j] * c[j]
        total += weight_f[j] * f[j] + weight_g[j] * g[j] + weight_h[j] * h[j]
        weights = np.float32(1) + weight_d[j] + weight_e[j]
        weights += weight_a[j] + weight_b[j] + weight_c[j]
        weights += weight_f[j] + weight_g[j] + weight_h[j]
        mean[j] = total / weights if z[j] > 0 else mean[j]


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
