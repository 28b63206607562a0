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

"""Marks pixels beside the body that hide its continuation, so that they make no outline.

Beside the body, eq. 2 takes every pixel for background. But the body may continue behind a nearer
surface, outside of the image, or in a margin of the image without any depth. The visible body is
cut off there, and the cut is no outline. The rules, for each pixel beside the body:

- A pixel in an invalid margin is outside of the image: see `invalid_margins`.
- Otherwise the line from the adjacent body pixel through the pixel is followed away from the body.
  In rows, pixels without depth are passed over a short distance: they are the shadow that a
  projector leaves beside a near object. A few pixels without depth or at the depth of the body
  are passed in all directions: they are mixed pixels. If the line ends at a surface that is nearer
  than the body, the pixel hides the body. Otherwise it is background.
- A surface is nearer if the step in depth is larger than `step` times the depth and is not only
  the slope of that surface: the floor in front of the feet is nearer, too, but it slopes to them.
- A pixel that is clearly behind all body pixels around it is background in any case.
- If the line finds no depth at all, but only pixels of the mask, the sensor did not measure the
  body there (dark clothes), and the pixel is unknown.
- In a recording whose background was removed, pixels without depth mean nothing: they are
  background. `background_is_measured` distinguishes the two kinds of images.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.silhouette.preprocessing import Window

SHADOW_DIVISOR = 20
"""A shadow without depth is at most as wide as the image divided by this: beside a hand half a
metre in front of a body, a Kinect has one of 16 of 320 pixels."""

MIXED_PIXELS = 2
"""Between two surfaces, a sensor mixes their depths in at most this number of pixels."""

SLOPE_PIXELS = 4
"""The slope of a surface is measured over this number of pixels."""

MEASURED_FRACTION = 0.25
"""The background is measured if at least this fraction of its pixels around a body has a depth."""

_SURROUNDINGS_DIVISOR = 8
"""The surroundings of a body reach as far as the width of the image divided by this."""

_SAMPLING = 4
"""Every n-th pixel of every n-th row shows whether the background is measured."""

MARGIN_MEASURED = 0.2
MARGIN_BACKGROUND = 0.1
"""The line that ends at an invalid margin has a depth at more than the first fraction of its
pixels beside the bodies, and these are more than the second fraction of its pixels."""

# Every depth is below this, in metres; infinity and NaN are not.
_LARGEST_DEPTH = np.float32(1e9)

_BACKGROUND, _UNKNOWN = np.float32(np.inf), np.float32(0)
"""What a line away from the body ends with instead of a depth."""

_DOWN = (0, 0, 1, -1, 1, 1, -1, -1)
_RIGHT = (1, -1, 0, 0, 1, -1, 1, -1)
"""The steps to the pixels around a pixel: first those beside, above and below it."""


class SceneImage(NamedTuple):
    """The image around a body.

    Attributes:
        depth: metres, 0 if the sensor measured nothing, shape (H, W).
        labels: the body number of each pixel, negative for none, shape (H, W).
        body: the body's number.
    """

    depth: NDArray[np.float32]
    labels: NDArray[np.int32]
    body: int


class _Rule(NamedTuple):
    """How a line is judged.

    Attributes:
        background: whether the background is measured, so that pixels without depth are unknown.
        step: as `mark_cuts`.
    """

    background: bool
    step: float


class _Line(NamedTuple):
    """A line away from the body: its first pixel, and the step to the next one."""

    row: int
    column: int
    down: int
    right: int


def mark_cuts(window: Window, image: SceneImage, step: float) -> Window:
    """Return the window with NaN at pixels beside the body that hide its continuation.

    Args:
        window: the body, cut out of the image.
        image: the image.
        step: a surface that is nearer than the body by more than this fraction of the body's
            depth hides it; 0: only the edge of the image cuts bodies off.
    """
    if step <= 0:
        return window
    depth = window.depth.copy()
    top, bottom, left, right = invalid_margins(window, image)
    borders = (depth[0], top), (depth[-1], bottom), (depth[:, 0], left), (depth[:, -1], right)
    for border, is_margin in borders:
        if is_margin:
            border[:] = np.nan
    return window._replace(depth=_mark_cuts(window._replace(depth=depth), image, step))


@kernel
def invalid_margins(window: Window, image: SceneImage) -> tuple[bool, bool, bool, bool]:
    """Return whether the body ends at an invalid margin: at the top, bottom, left and right.

    An invalid margin is a band at an edge of the image in which no pixel has a depth, if it ends
    abruptly: not only at the body, but all along the line (MARGIN_MEASURED, MARGIN_BACKGROUND).
    If no pixel above a person's head has a depth, but the head alone reaches so high, these pixels
    show a distant background.

    Args:
        window: the body, cut out of the image.
        image: the image.
    """
    depth, labels = image.depth, image.labels
    height, width = window.depth.shape
    return (
        _ends_abruptly(depth, labels, window.row + 1),
        _ends_abruptly(depth[::-1], labels[::-1], depth.shape[0] - window.row - height + 1),
        _ends_abruptly(depth.T, labels.T, window.column + 1),
        _ends_abruptly(depth.T[::-1], labels.T[::-1], depth.shape[1] - window.column - width + 1),
    )


@kernel
def _ends_abruptly(depth: NDArray[np.float32], labels: NDArray[np.int32], row: int) -> bool:
    """Return whether `row` is the first row after an invalid margin above."""
    width = depth.shape[1]
    beside = measured = 0
    for column in range(width):
        if labels[row, column] < 0:
            beside += 1
            measured += depth[row, column] > 0
    if measured <= MARGIN_MEASURED * beside or beside <= MARGIN_BACKGROUND * width:
        return False
    for above in range(row - 1, -1, -1):
        for column in range(width):
            if depth[above, column] > 0:
                return False
    return row > 0


@kernel
def background_is_measured(window: Window, image: SceneImage) -> bool:
    """Return whether the background around a body has a depth (MEASURED_FRACTION).

    Args:
        window: the body, cut out of the image.
        image: the image.
    """
    height, width = image.depth.shape
    reach = width // _SURROUNDINGS_DIVISOR
    top, left = max(0, window.row - reach), max(0, window.column - reach)
    bottom = min(height, window.row + window.depth.shape[0] + reach)
    right = min(width, window.column + window.depth.shape[1] + reach)
    pixels = measured = 0
    for row in range(top, bottom, _SAMPLING):
        for column in range(left, right, _SAMPLING):
            beside = image.labels[row, column] < 0
            pixels += beside
            measured += beside and image.depth[row, column] > 0
    return pixels > 0 and measured >= MEASURED_FRACTION * pixels


@kernel
def _mark_cuts(window: Window, image: SceneImage, step: float) -> NDArray[np.float32]:
    depth = window.depth
    marked = depth.copy()
    rule = _Rule(background_is_measured(window, image), step)
    farthest = np.empty(depth.shape[1], np.float32)
    for i in range(depth.shape[0]):
        _farthest_around(depth, i, farthest)
        for j in range(depth.shape[1]):
            if depth[i, j] != np.inf or farthest[j] == 0:
                continue
            z = image.depth[window.row + i, window.column + j]
            behind = z > (1 + step) * farthest[j]
            known = z > 0 or rule.background
            if known and not behind and _hides(window, i, j, image, rule):
                marked[i, j] = np.nan
    return marked


@kernel
def _farthest_around(depth: NDArray[np.float32], i: int, farthest: NDArray[np.float32]) -> None:
    """Fill in the largest depth of the body beside each pixel of row i; 0 if it is not there."""
    farthest[:] = 0
    for row in range(max(i - 1, 0), min(i + 2, depth.shape[0])):
        line = depth[row]
        for j in range(len(line)):
            z = line[j] if line[j] < _LARGEST_DEPTH else np.float32(0)
            farthest[j] = max(farthest[j], z)
    before = np.float32(0)
    for j in range(len(farthest)):
        here = farthest[j]
        after = farthest[j + 1] if j + 1 < len(farthest) else np.float32(0)
        farthest[j] = max(before, here, after)
        before = here


@kernel
def _hides(window: Window, i: int, j: int, image: SceneImage, rule: _Rule) -> bool:
    """Return whether a pixel beside the body hides the body's continuation.

    Diagonal lines count only if the body is neither above, below nor beside the pixel.
    """
    beside = False
    for n in range(len(_DOWN)):
        is_corner = n >= len(_DOWN) // 2
        if is_corner and beside:
            break
        reference = _reference(window.depth, i, j, _DOWN[n], _RIGHT[n])
        if reference == 0:
            continue
        beside = beside or not is_corner
        line = _Line(window.row + i, window.column + j, _DOWN[n], _RIGHT[n])
        end, distance = _follow(image, line, reference, rule)
        if end == _UNKNOWN:
            return True
        if end < _BACKGROUND:
            rise = (distance + 1 + MIXED_PIXELS) * _slope(image.depth, line, distance)
            if end < (1 - rule.step) * reference - rise:
                return True
    return False


@kernel
def _reference(depth: NDArray[np.float32], i: int, j: int, down: int, right: int) -> np.float32:
    """Return the depth of the body before a pixel of a window; 0 if it is not there.

    Behind a mixed pixel at the rim, it is the depth of the body: the largest of some pixels.
    """
    largest = np.float32(0)
    for n in range(1, 2 + MIXED_PIXELS):
        k, m = i - n * down, j - n * right
        if not (0 <= k < depth.shape[0] and 0 <= m < depth.shape[1]):
            break
        if not depth[k, m] < _LARGEST_DEPTH:
            break
        largest = max(largest, depth[k, m])
    return largest


@kernel
def _follow(
    image: SceneImage, line: _Line, reference: np.float32, rule: _Rule
) -> tuple[np.float32, int]:
    """Return the depth at the end of a line away from the body, and the distance in pixels.

    The depth is infinity for background, and _UNKNOWN for a line without depth in the mask.

    Args:
        image: the image around the body.
        line: the line, from the pixel beside the body.
        reference: depth of the body before it, metres.
        rule: how the line is judged.
    """
    depth, labels = image.depth, image.labels
    reach = 1 + depth.shape[1] // SHADOW_DIVISOR if line.down == 0 else 1 + MIXED_PIXELS
    mixed, own = 0, rule.background
    for n in range(reach):
        row, column = line.row + n * line.down, line.column + n * line.right
        if not (0 <= row < depth.shape[0] and 0 <= column < depth.shape[1]):
            return _BACKGROUND, n
        z, in_mask = depth[row, column], labels[row, column] == image.body
        if z > 0:
            if z < (1 - rule.step) * reference and not (in_mask and n > 0):
                return z, n
            mixed += 1
            if mixed > MIXED_PIXELS or z > (1 + rule.step) * reference or (in_mask and n > 0):
                return _BACKGROUND, n
        own = own and in_mask and not z > 0
        if not (z > 0 or rule.background):
            return _BACKGROUND, n
    return (_UNKNOWN if own else _BACKGROUND), reach


@kernel
def _slope(depth: NDArray[np.float32], line: _Line, distance: int) -> np.float32:
    """Return by how much the surface at a pixel of a line comes nearer with each pixel, metres.

    It is 0 or more.
    """
    start, slope = np.float32(0), np.float32(0)
    for n in range(SLOPE_PIXELS + 1):
        row = line.row + (distance + n) * line.down
        column = line.column + (distance + n) * line.right
        if not (0 <= row < depth.shape[0] and 0 <= column < depth.shape[1]):
            break
        if n == 0:
            start = depth[row, column]
        elif depth[row, column] > 0:
            slope = (start - depth[row, column]) / np.float32(n)
    return max(np.float32(0), slope)
