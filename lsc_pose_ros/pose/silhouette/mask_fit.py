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

"""Fits a sloppy mask to the depth: what is not of the body is left out, what is missing is added.

A segmenter's mask is some pixels off. Grown or shifted, it contains a rim of the wall or the
floor; shrunk or shifted, it lacks a part of the body. Both show in the depth: the outline of an
exact mask is a step in depth, except at the feet, and that of a sloppy mask is not. A mask is
corrected only if most of its outline is no step (`smooth_outline`), and only if the background is
measured. Then

1. pixels near the outline that are behind the body, or that face upwards like the floor, are left
   out, if their surface continues outside of the mask;
2. the mask grows over the surface of the body by at most the same number of pixels, or twice that
   number if nothing was left out.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.silhouette.cuts import SceneImage
from lsc_pose_ros.pose.silhouette.preprocessing import Window

LARGEST_ERROR_DIVISOR = 16
"""The outline of a mask is wrong by at most the width of the image divided by this, pixels."""

BETTER_OUTLINE = 0.75
"""A fitted mask is used if the fraction of its outline that is no step is at most this fraction of
what it was before."""

CONTINUES = 0.3
"""A surface continues outside of the mask if it does so at this fraction of its outline."""

SPECK = 0.01
"""A smaller part behind the body is left out in any case; as a fraction of the mask."""

STEP = 0.02
SLOPE = 0.012
"""Two neighbours show one surface if their depths differ by at most STEP + SLOPE z, metres."""

BEHIND = 0.05
"""A pixel is behind the body if it is deeper by this fraction of the depth."""

FACES_UP = 1.3
"""A surface faces upwards if it comes nearer by this many times what it goes down in the image."""

_UP_PIXELS = 3
"""The slope of a surface is measured over twice this number of pixels."""


_DOWN = (0, 0, 1, -1)
_RIGHT = (1, -1, 0, 0)
"""The steps to the pixels beside, below and above a pixel."""


class MaskRegion(NamedTuple):
    """The part of an image around a mask.

    Attributes:
        depth: metres, 0 if the sensor measured nothing, shape (h, w).
        mask: whether a pixel is of the body and has a depth, shape (h, w).
        free: whether it is of no body, shape (h, w).
        reach: the largest error of the outline, pixels.
        focal_length: in y, pixels.
    """

    depth: NDArray[np.float32]
    mask: NDArray[np.bool_]
    free: NDArray[np.bool_]
    reach: int
    focal_length: float


def largest_error(image: SceneImage) -> int:
    """Return by how much the outline of a mask is wrong at most, pixels."""
    return int(image.depth.shape[1]) // LARGEST_ERROR_DIVISOR


def labels_fitted_to_depth(
    window: Window, image: SceneImage, focal_length: float
) -> NDArray[np.int32]:
    """Return the labels with the mask of the body fitted to the depth, shape (H, W).

    Args:
        window: the body, cut out of the image with its sloppy mask.
        image: the image.
        focal_length: in y, pixels.
    """
    reach = largest_error(image)
    height, width = window.depth.shape
    rows = slice(max(0, window.row - 2 * reach), window.row + height + 2 * reach)
    columns = slice(max(0, window.column - 2 * reach), window.column + width + 2 * reach)
    depth, labels = image.depth[rows, columns], image.labels[rows, columns]
    of_body = labels == image.body
    free = labels < 0
    fitted = fit_mask(MaskRegion(depth.copy(), of_body & (depth > 0), free, reach, focal_length))
    result = image.labels.copy()
    result[rows, columns][of_body] = NO_BODY
    result[rows, columns][fitted] = image.body
    return result


@kernel
def smooth_outline(window: Window, image: SceneImage) -> float:
    """Return the fraction of the outline of a mask that is no step in depth.

    Outline to pixels without depth, or of other bodies, does not count.

    Args:
        window: the body, cut out of the image.
        image: the image.
    """
    depth = window.depth
    smooth = outline = 0
    for i in range(1, depth.shape[0] - 1):
        for j in range(1, depth.shape[1] - 1):
            if not depth[i, j] < np.inf:
                continue
            for n in range(4):
                if depth[i + _DOWN[n], j + _RIGHT[n]] != np.inf:
                    continue
                row, column = window.row + i + _DOWN[n], window.column + j + _RIGHT[n]
                if image.labels[row, column] < 0 and image.depth[row, column] > 0:
                    outline += 1
                    smooth += _one_surface(depth[i, j], image.depth[row, column])
    return smooth / max(outline, 1)


@kernel
def _one_surface(a: float, b: float) -> bool:
    return abs(a - b) <= STEP + SLOPE * min(a, b)


@kernel
def fit_mask(region: MaskRegion) -> NDArray[np.bool_]:
    """Return the mask fitted to the depth, shape (h, w).

    Args:
        region: the part of the image around the mask.
    """
    mask = region.mask
    upwards = faces_up(region.depth, region.focal_length)
    foreign = _foreign(region, _find_candidates(region, upwards))
    # A mask that contains nothing else is too small. A thin limb then loses more than its outline.
    too_small = foreign.sum() <= SPECK * mask.sum()
    growth = 2 * region.reach if too_small else region.reach
    return _grown(region, mask & ~foreign, upwards, growth)


@kernel
def faces_up(depth: NDArray[np.float32], focal_length: float) -> NDArray[np.bool_]:
    """Return which pixels show a surface that faces upwards, like the floor (FACES_UP).

    Args:
        depth: metres, 0 if the sensor measured nothing, shape (h, w).
        focal_length: in y, pixels.
    """
    height, width = depth.shape
    found = np.zeros((height, width), np.bool_)
    for i in range(_UP_PIXELS, height - _UP_PIXELS):
        for j in range(width):
            z, above, below = depth[i, j], depth[i - _UP_PIXELS, j], depth[i + _UP_PIXELS, j]
            if z > 0 and above > 0 and below > 0:
                rise, size = above - below, 2 * _UP_PIXELS * z / focal_length
                # A step is no slope: both halves must rise.
                half = 0.25 * rise
                found[i, j] = rise > FACES_UP * size and above - z > half and z - below > half
    return found


@kernel
def _find_candidates(region: MaskRegion, upwards: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the pixels of the mask near its outline that are behind the body or face upwards."""
    depth, mask, reach = region.depth, region.mask, region.reach
    nearest = np.where(mask, depth, np.float32(np.inf))
    nearest = _least_around(_least_around(nearest, reach).T.copy(), reach).T
    inner = np.where(mask, np.float32(1), np.float32(0))
    inner = _least_around(_least_around(inner, reach).T.copy(), reach).T
    candidates = np.zeros(mask.shape, np.bool_)
    for i in range(mask.shape[0]):
        for j in range(mask.shape[1]):
            behind = depth[i, j] > (1 + BEHIND) * nearest[i, j]
            candidates[i, j] = mask[i, j] and inner[i, j] == 0 and (behind or upwards[i, j])
    return candidates


@kernel
def _least_around(values: NDArray[np.float32], reach: int) -> NDArray[np.float32]:
    """Return the least of the values in the columns up to `reach` away, shape as `values`.

    The least of 2, 4, 8, ... neighbouring columns is computed from that of half as many.
    """
    height, width = values.shape
    least = np.full((height, width + 2 * reach), np.inf, np.float32)
    least[:, reach : reach + width] = values
    columns = 1
    while columns < 2 * reach + 1:
        shift = min(columns, 2 * reach + 1 - columns)
        for i in range(height):
            line = least[i]
            for k in range(len(line) - shift):
                line[k] = min(line[k], line[k + shift])
        columns += shift
    return least[:, :width].copy()


@kernel
def _foreign(region: MaskRegion, candidates: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the candidates whose surface continues outside of the mask (CONTINUES)."""
    height, width = candidates.shape
    foreign = np.zeros((height, width), np.bool_)
    seen = np.zeros((height, width), np.bool_)
    stack = np.empty((candidates.size, 2), np.int32)
    speck = SPECK * region.mask.sum()
    for i in range(height):
        for j in range(width):
            if not candidates[i, j] or seen[i, j]:
                continue
            size = _flood(region.depth, candidates, seen, stack, i, j)
            if size < speck or _continues(region, stack[:size]):
                for n in range(size):
                    foreign[stack[n, 0], stack[n, 1]] = True
    return foreign


@kernel
def _flood(
    depth: NDArray[np.float32],
    candidates: NDArray[np.bool_],
    seen: NDArray[np.bool_],
    stack: NDArray[np.int32],
    i: int,
    j: int,
) -> int:
    """Fill `stack` with the connected candidates from (i, j) on; return how many they are."""
    height, width = depth.shape
    stack[0, 0], stack[0, 1] = i, j
    seen[i, j] = True
    size, done = 1, 0
    while done < size:
        i, j = stack[done]
        done += 1
        for n in range(4):
            k, m = i + _DOWN[n], j + _RIGHT[n]
            if not (0 <= k < height and 0 <= m < width) or seen[k, m] or not candidates[k, m]:
                continue
            if _one_surface(depth[i, j], depth[k, m]):
                seen[k, m] = True
                stack[size, 0], stack[size, 1] = k, m
                size += 1
    return size


@kernel
def _continues(region: MaskRegion, pixels: NDArray[np.int32]) -> bool:
    """Return whether a surface of the mask continues outside.

    If it does not touch the outline, it is compared with the first pixels outside, row by row and
    column by column.
    """
    depth, free = region.depth, region.free
    height, width = depth.shape
    smooth = outline = matches = 0
    for n in range(len(pixels)):
        i, j = pixels[n]
        match = False
        for side in range(4):
            k, m = i, j
            for step in range(1, 2 * region.reach):
                k, m = k + _DOWN[side], m + _RIGHT[side]
                if not (0 <= k < height and 0 <= m < width):
                    break
                if not (free[k, m] and depth[k, m] > 0):
                    continue
                same = _one_surface(depth[i, j], depth[k, m])
                same = same and _extends(region, k, m, side)
                match = match or same
                if step == 1:
                    outline += 1
                    smooth += same
                break
        matches += match
    if outline > 0:
        return smooth >= CONTINUES * outline
    return matches >= CONTINUES * len(pixels)


@kernel
def _extends(region: MaskRegion, i: int, j: int, side: int) -> bool:
    """Return whether a surface outside of the mask extends by half of `reach` to one side.

    The wall does. If the mask is too small, the body ends sooner.
    """
    height, width = region.depth.shape
    last, gap = region.depth[i, j], 1
    for _ in range(region.reach // 2):
        i, j = i + _DOWN[side], j + _RIGHT[side]
        if not (0 <= i < height and 0 <= j < width):
            return True
        z = region.depth[i, j]
        if not z > 0:
            gap += 1
            continue
        if not region.free[i, j] or abs(z - last) > gap * (STEP + SLOPE * min(z, last)):
            return False
        last, gap = z, 1
    return gap <= region.reach // 4


@kernel
def _grown(
    region: MaskRegion, mask: NDArray[np.bool_], upwards: NDArray[np.bool_], growth: int
) -> NDArray[np.bool_]:
    """Return `mask` grown over the surface of the body, by at most `growth` pixels."""
    depth, free = region.depth, region.free
    height, width = depth.shape
    grown = mask.copy()
    front = np.empty((2 * depth.size, 2), np.int32)
    size = 0
    for i in range(height):
        for j in range(width):
            if mask[i, j]:
                front[size, 0], front[size, 1] = i, j
                size += 1
    start = 0
    for _ in range(growth):
        end = size
        for n in range(start, end):
            i, j = front[n]
            for side in range(4):
                k, m = i + _DOWN[side], j + _RIGHT[side]
                if not (0 <= k < height and 0 <= m < width) or grown[k, m]:
                    continue
                if not (free[k, m] or region.mask[k, m]) or upwards[k, m]:
                    continue
                if depth[k, m] > 0 and _one_surface(depth[i, j], depth[k, m]):
                    grown[k, m] = True
                    front[size, 0], front[size, 1] = k, m
                    size += 1
        start = end
    return grown
