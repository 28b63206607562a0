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

"""Finds the connected parts of a depth image, and those of the size of a body."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.rays import ImageRays, image_rays
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.numerics.jit import kernel

BARRIER = np.float32(-1.0)
"""The depth of a pixel that is measured but belongs to no blob."""

STEP = 0.03
SLOPE = 0.015
"""Neighbouring pixels are connected if their depths differ by at most STEP + SLOPE z, metres.

At 2 m this is the step of a surface that is tilted by 80 degrees, at 320 x 240 pixels. At 4 m it
is twice the depth resolution of a Kinect.
"""

GAP_DIVISOR = 80
"""A gap of pixels without depth is bridged up to the width of the image divided by this."""

HIDDEN_WIDTH = 0.25
HIDDEN_STEP = 0.10
"""A surface continues behind a nearer part, as a trunk behind folded arms, if the part is at most
HIDDEN_WIDTH wide and the depths on both sides differ by at most HIDDEN_STEP, metres."""

LONGEST = (0.5, 2.5)
"""Range of the longest side of the box around a body, metres: from a child or half an adult to
spread or raised arms."""

DEEPEST = 2.0
"""The largest extent of the box along the line of sight, metres."""

AREA = (0.10, 1.6)
"""Range of the visible area of a body, square metres: head and shoulders to an adult in a coat."""

LIMB_AREA = 0.12
"""The largest area of a loose limb, square metres: a part that hides its own connection to the
body, as a hand that is held towards the camera."""

LIMB_PIXELS = 10
"""The fewest pixels of a loose limb; fewer are noise."""

LIMB_CONTACT = 0.12
"""The least fraction of the outline of a loose limb that is in contact with the body."""

SHADOW_DIVISOR = 20
"""Contact bridges a gap up to the width of the image divided by this: the shadow without depth
that a Kinect has beside a hand half a metre in front of the body."""

LIMB_FRONT = 0.9
LIMB_BACK = 0.15
"""The largest mean distance of a loose limb in front of and behind the body, metres."""


class Blobs(NamedTuple):
    """Connected parts of a depth image.

    Attributes:
        numbers: the blob of each pixel, -1 for none, shape (H, W), int32.
        pixels: number of pixels of each blob, shape (B,), int64.
        area: of each blob, square metres as if it faced the camera, shape (B,), float64.
        depth: mean depth of each blob, metres, shape (B,), float64.
        low: the least x, y, z of each blob, metres, shape (B, 3), float64.
        high: the greatest, shape (B, 3), float64.
    """

    numbers: NDArray[np.int32]
    pixels: NDArray[np.int64]
    area: NDArray[np.float64]
    depth: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


def find_blobs(depth: NDArray[np.float32], camera: Intrinsics) -> Blobs:
    """Return the blobs of a depth image.

    Two pixels of a row or a column are connected if their depths are close (STEP, SLOPE) and
    there is at most a short gap of pixels without depth between them (GAP_DIVISOR), or if a
    surface continues behind a narrow part (HIDDEN_WIDTH, HIDDEN_STEP).

    Args:
        depth: metres, 0 if unknown, BARRIER for pixels that belong to no blob, shape (H, W).
        camera: the intrinsics.
    """
    gap, rays = gap_of(depth.shape[1]), image_rays(camera, *depth.shape)
    numbers, count = connect_pixels(depth, gap, (float(camera.fx), float(camera.fy)))
    return measure(depth, numbers, count, rays)


def gap_of(width: int) -> int:
    """Return the largest distance, in pixels, of two connected pixels across a gap."""
    return 1 + width // GAP_DIVISOR


def body_sized(blobs: Blobs) -> NDArray[np.int64]:
    """Return the indices of the blobs of the size of a body, ascending."""
    size = blobs.high - blobs.low
    longest = size.max(axis=1, initial=0.0)
    good = (longest >= LONGEST[0]) & (longest <= LONGEST[1]) & (size[:, 2] <= DEEPEST)
    good &= (blobs.area >= AREA[0]) & (blobs.area <= AREA[1])
    return np.flatnonzero(good)


def label_bodies(blobs: Blobs, bodies: NDArray[np.int64]) -> NDArray[np.int32]:
    """Return the body number of each pixel, NO_BODY for none, shape (H, W).

    A loose limb has the number of its body.

    Args:
        blobs: all blobs.
        bodies: indices of the blobs that become the bodies 1, 2, ...
    """
    labels_of_blobs = np.full(len(blobs.area) + 1, NO_BODY, np.int32)  # the last is for -1
    labels_of_blobs[bodies] = np.arange(1, len(bodies) + 1)
    if len(bodies):
        _add_limbs(blobs, bodies, labels_of_blobs)
    return labels_of_pixels(blobs.numbers, labels_of_blobs)


def _add_limbs(
    blobs: Blobs, bodies: NDArray[np.int64], labels_of_blobs: NDArray[np.int32]
) -> None:
    """Give the label of a body to its loose limbs: in contact in the image, but not in space."""
    ranks = np.full(len(blobs.area), -1, np.int32)
    ranks[bodies] = np.arange(len(bodies))
    shadow = 1 + blobs.numbers.shape[1] // SHADOW_DIVISOR
    outline, contact = measure_contact(blobs.numbers, ranks, len(bodies), shadow)
    small = (blobs.area <= LIMB_AREA) & (blobs.pixels >= LIMB_PIXELS) & (ranks < 0)
    for limb in np.flatnonzero(small & (contact.max(axis=1) >= LIMB_CONTACT * outline)):
        rank = int(contact[limb].argmax())
        behind = blobs.depth[limb] - blobs.depth[bodies[rank]]
        if -LIMB_FRONT <= behind <= LIMB_BACK:
            labels_of_blobs[limb] = rank + 1


@kernel
def connect_pixels(
    depth: NDArray[np.float32], gap: int, focal_lengths: tuple[float, float]
) -> tuple[NDArray[np.int32], int]:
    """Return the blob of each pixel, shape (H, W), -1 for none, and the number of blobs.

    Blobs are numbered in scan order of their first pixels.

    Args:
        depth: metres, 0 if unknown, negative for a barrier, shape (H, W).
        gap: largest distance, in pixels, of connected pixels of a row or column with only pixels
            without depth between them.
        focal_lengths: fx and fy, pixels.
    """
    height, width = depth.shape
    numbers = np.empty((height, width), np.int32)
    parents = np.empty(height * width, np.int32)
    count = 0
    # The last pixel with depth, and the pixel that it may hide: of each column, and of the row.
    above, above_hidden = np.full(width, -1, np.int64), np.full(width, -1, np.int64)
    across, down = HIDDEN_WIDTH * focal_lengths[0], HIDDEN_WIDTH * focal_lengths[1]
    for row in range(height):
        left = left_hidden = -1
        for column in range(width):
            here = depth[row, column]
            if not here > 0:
                numbers[row, column] = -1
                if here < 0:
                    left = left_hidden = above[column] = above_hidden[column] = -1
                continue
            # The index -1 for none reads an arbitrary pixel, which is then ignored.
            before, behind = depth[row, left], depth[row, left_hidden]
            joined, left_hidden = _follow(
                column, left, left_hidden, here, before, behind, gap, across
            )
            number = numbers[row, joined] if joined >= 0 else -1
            last, hidden = above[column], above_hidden[column]
            before, behind = depth[last, column], depth[hidden, column]
            joined, above_hidden[column] = _follow(
                row, last, hidden, here, before, behind, gap, down
            )
            if joined >= 0:
                other = numbers[joined, column]
                if number < 0:
                    number = other
                elif number != other:
                    number = _join(parents, number, other)
            if number < 0:
                number = count
                parents[count] = count
                count += 1
            numbers[row, column] = number
            left = column
            above[column] = row
    return numbers, _renumber(numbers, parents[:count])


@kernel
def _follow(
    index: int,
    last: int,
    hidden: int,
    here: float,
    before: float,
    behind: float,
    gap: int,
    reach: float,
) -> tuple[int, int]:
    """Return the earlier pixel of the line that a pixel is connected to, and the hidden pixel.

    Both are -1 for none. A line is a row or a column.

    Args:
        index: index of the pixel in its line.
        last: the last pixel with a depth.
        hidden: the end of the surface that may continue behind `last`.
        here: depth of the pixel, metres.
        before: depth at `last`, metres.
        behind: depth at `hidden`, metres.
        gap: as `connect_pixels`.
        reach: how far a hidden surface is followed, in pixels at a depth of one metre.
    """
    if last < 0:
        return -1, -1
    if abs(here - before) <= STEP + SLOPE * min(here, before):
        return (last if index - last <= gap else -1), hidden
    known = hidden >= 0 and (index - hidden) * behind <= reach
    if here < before:
        return -1, (hidden if known else last)
    if known and abs(here - behind) <= HIDDEN_STEP:
        return hidden, -1
    return -1, hidden


@kernel
def _root(parents: NDArray[np.int32], number: int) -> int:
    while parents[number] != number:
        parents[number] = parents[parents[number]]
        number = parents[number]
    return number


@kernel
def _join(parents: NDArray[np.int32], first: int, second: int) -> int:
    """Join two sets and return their root, the older one."""
    first, second = _root(parents, first), _root(parents, second)
    root = min(first, second)
    parents[first] = parents[second] = root
    return root


@kernel
def _renumber(numbers: NDArray[np.int32], parents: NDArray[np.int32]) -> int:
    """Renumber the sets in `numbers`, shape (H, W), consecutively; return how many there are."""
    count = 0
    for number in range(len(parents)):
        if parents[number] == number:
            parents[number] = count
            count += 1
        else:  # a parent precedes its children, so it has its final number
            parents[number] = parents[parents[number]]
    flat = numbers.reshape(-1)
    for index in range(len(flat)):
        if flat[index] >= 0:
            flat[index] = parents[flat[index]]
    return count


@kernel
def measure(
    depth: NDArray[np.float32], numbers: NDArray[np.int32], count: int, rays: ImageRays
) -> Blobs:
    """Return the blobs with their sizes.

    The area of a pixel is that of a surface that faces the camera.

    Args:
        depth: metres, shape (H, W).
        numbers: the blob of each pixel, -1 for none, shape (H, W).
        count: number of blobs.
        rays: the rays of the image.
    """
    pixels = np.zeros(count, np.int64)
    area, total = np.zeros(count), np.zeros(count)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    height, width = numbers.shape
    for row in range(height):
        # The rays have a margin of one pixel.
        right, down, pixel_area = rays.right[row + 1], rays.down[row + 1], rays.area[row + 1]
        column = 0
        while column < width:
            blob = numbers[row, column]
            if blob < 0:
                column += 1
                continue
            begin = column
            least_x = least_y = least_z = np.inf
            most_x = most_y = most_z = -np.inf
            sum_z = sum_area = 0.0
            while column < width and numbers[row, column] == blob:
                z = float(depth[row, column])
                x, y = z * right[column + 1], z * down[column + 1]
                least_x, most_x = min(least_x, x), max(most_x, x)
                least_y, most_y = min(least_y, y), max(most_y, y)
                least_z, most_z = min(least_z, z), max(most_z, z)
                sum_z += z
                sum_area += z * z * pixel_area[column + 1]
                column += 1
            pixels[blob] += column - begin
            area[blob] += sum_area
            total[blob] += sum_z
            low[blob, 0], high[blob, 0] = min(low[blob, 0], least_x), max(high[blob, 0], most_x)
            low[blob, 1], high[blob, 1] = min(low[blob, 1], least_y), max(high[blob, 1], most_y)
            low[blob, 2], high[blob, 2] = min(low[blob, 2], least_z), max(high[blob, 2], most_z)
    return Blobs(numbers, pixels, area, total / pixels, low, high)


@kernel
def measure_contact(
    numbers: NDArray[np.int32], ranks: NDArray[np.int32], bodies: int, gap: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the lengths of the outlines of the blobs, and of their contacts with each body.

    Both are in sides of pixels. The edge of the image is no outline. A side is in contact with a
    body if the next pixel with a blob, at most `gap` pixels away in the row or column, belongs to
    the body.

    Args:
        numbers: the blob of each pixel, -1 for none, shape (H, W).
        ranks: index of the body of each blob, -1 for none, shape (B,).
        bodies: number of bodies.
        gap: pixels.

    Returns:
        The outline, shape (B,), and the contact, shape (B, bodies).
    """
    height, width = numbers.shape
    outline = np.zeros(len(ranks), np.int64)
    contact = np.zeros((len(ranks), bodies), np.int64)
    above = np.full(width, -gap - 1, np.int64)  # the last row with a blob, column by column
    for row in range(height):
        left = -gap - 1
        for column in range(width):
            here = numbers[row, column]
            if column > 0 and numbers[row, column - 1] != here:
                _add_sides(outline, numbers[row, column - 1], here)
            if row > 0 and numbers[row - 1, column] != here:
                _add_sides(outline, numbers[row - 1, column], here)
            if here < 0:
                continue
            if column - left <= gap and numbers[row, left] != here:
                _add_contact(contact, ranks, numbers[row, left], here)
            if row - above[column] <= gap and numbers[above[column], column] != here:
                _add_contact(contact, ranks, numbers[above[column], column], here)
            left = column
            above[column] = row
    return outline, contact


@kernel
def _add_sides(outline: NDArray[np.int64], first: int, second: int) -> None:
    if first >= 0:
        outline[first] += 1
    if second >= 0:
        outline[second] += 1


@kernel
def _add_contact(
    contact: NDArray[np.int64], ranks: NDArray[np.int32], first: int, second: int
) -> None:
    if ranks[first] >= 0:
        contact[second, ranks[first]] += 1
    if ranks[second] >= 0:
        contact[first, ranks[second]] += 1


@kernel
def labels_of_pixels(
    numbers: NDArray[np.int32], labels_of_blobs: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Return the label of the blob of each pixel, shape (H, W).

    Args:
        numbers: the blob of each pixel, -1 for none, shape (H, W).
        labels_of_blobs: label of each blob, and finally of no blob, shape (B + 1,).
    """
    labels = np.empty(numbers.shape, np.int32)
    for row in range(numbers.shape[0]):
        for column in range(numbers.shape[1]):
            labels[row, column] = labels_of_blobs[numbers[row, column]]
    return labels
