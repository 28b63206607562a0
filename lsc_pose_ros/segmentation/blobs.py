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

"""What hangs together in a depth image, and which of it has the size of a body."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.numerics.jit import kernel

BARRIER = np.float32(-1.0)
"""Stands in a depth image for a pixel that is seen but belongs to no blob."""

STEP = 0.03
SLOPE = 0.015
"""Neighbouring pixels hang together if their depths differ by at most STEP + SLOPE z, metres.

At 2 m that is what a surface makes that turns away by 80 degrees at 320 x 240 pixels; at 4 m it
is twice the step in which a Kinect measures.
"""

GAP_SHARE = 80
"""Pixels without depth are bridged as far as the image's width by this number."""

HIDDEN_WIDTH = 0.25
HIDDEN_STEP = 0.10
"""A surface goes on behind what is nearer and, in metres, no wider than this, as a trunk does
behind folded arms, if its depth differs by no more than this."""

LONGEST = (0.5, 2.5)
"""The longest side, metres, of the box around a body: from a child's or half an adult's height to
arms that are spread or raised."""

DEEPEST = 2.0
"""The box's longest side along the line of sight, metres."""

AREA = (0.10, 1.6)
"""Square metres of a body that the camera sees: from head and shoulders to an adult in a coat."""

LIMB_AREA = 0.12
"""Square metres of a part that hides its own connection to the body, as a hand held towards the
camera does, at most."""

LIMB_PIXELS = 10
"""Such a part's pixels at least; fewer are noise."""

LIMB_CONTACT = 0.12
"""The share of such a part's outline at least that meets the body in the image."""

SHADOW_SHARE = 20
"""It meets it across a gap as far as the image's width by this number: the shadow, without depth,
that a hand half a metre before the body casts for a Kinect."""

LIMB_FRONT = 0.9
LIMB_BACK = 0.15
"""How far, in metres, such a part may be before and behind the body, on average."""


class Blobs(NamedTuple):
    """Pixels that hang together.

    Attributes:
        numbers: the blob of each pixel, -1 for none, shape (H, W), int32.
        pixels: of each blob, shape (B,), int64.
        area: of each blob in square metres as if it faced the camera, shape (B,), float64.
        depth: of each blob, the mean in metres, shape (B,), float64.
        low: the least x, y, z of each blob in metres, shape (B, 3), float64.
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

    Two pixels of a row or a column hang together if their depths are close (STEP, SLOPE) and
    there is at most a short gap of pixels without depth between them (GAP_SHARE); or if a surface
    goes on behind something narrow (HIDDEN_WIDTH, HIDDEN_STEP).

    Args:
        depth: metres, 0 where the sensor saw nothing, BARRIER for what belongs to no blob, (H, W).
        camera: the intrinsics.
    """
    numbers, count = connect(depth, gap_of(depth.shape[1]), camera)
    return measure(depth, numbers, count, camera)


def gap_of(width: int) -> int:
    """Return how far apart, in pixels, two pixels may be with nothing but gaps between them."""
    return 1 + width // GAP_SHARE


def body_sized(blobs: Blobs) -> NDArray[np.int64]:
    """Return which blobs have the size of a body, ascending."""
    size = blobs.high - blobs.low
    longest = size.max(axis=1, initial=0.0)
    good = (longest >= LONGEST[0]) & (longest <= LONGEST[1]) & (size[:, 2] <= DEEPEST)
    good &= (blobs.area >= AREA[0]) & (blobs.area <= AREA[1])
    return np.flatnonzero(good)


def label_bodies(blobs: Blobs, bodies: NDArray[np.int64]) -> NDArray[np.int32]:
    """Return labels, shape (H, W), that number blobs 1, 2, ... and their loose limbs likewise.

    Args:
        blobs: all blobs.
        bodies: which of them are bodies, in the order of their numbers.
    """
    labels_of_blobs = np.full(len(blobs.area) + 1, NO_BODY, np.int32)  # the last is for -1
    labels_of_blobs[bodies] = np.arange(1, len(bodies) + 1)
    if len(bodies):
        _add_limbs(blobs, bodies, labels_of_blobs)
    return paint(blobs.numbers, labels_of_blobs)


def _add_limbs(
    blobs: Blobs, bodies: NDArray[np.int64], labels_of_blobs: NDArray[np.int32]
) -> None:
    """Give the body's label to parts before it that touch it in the image but not in space."""
    ranks = np.full(len(blobs.area), -1, np.int32)
    ranks[bodies] = np.arange(len(bodies))
    shadow = 1 + blobs.numbers.shape[1] // SHADOW_SHARE
    outline, contact = touch(blobs.numbers, ranks, len(bodies), shadow)
    small = (blobs.area <= LIMB_AREA) & (blobs.pixels >= LIMB_PIXELS) & (ranks < 0)
    for limb in np.flatnonzero(small & (contact.max(axis=1) >= LIMB_CONTACT * outline)):
        rank = int(contact[limb].argmax())
        behind = blobs.depth[limb] - blobs.depth[bodies[rank]]
        if -LIMB_FRONT <= behind <= LIMB_BACK:
            labels_of_blobs[limb] = rank + 1


@kernel
def connect(
    depth: NDArray[np.float32], gap: int, camera: Intrinsics
) -> tuple[NDArray[np.int32], int]:
    """Return the blob of each pixel, shape (H, W), -1 for none, and the number of blobs.

    Blobs are numbered in scan order of their first pixels.

    Args:
        depth: metres, 0 for nothing, negative for a barrier, shape (H, W).
        gap: how far apart, in pixels, two pixels of a row or column may be if there is nothing
            but pixels without depth between them.
        camera: the intrinsics.
    """
    height, width = depth.shape
    numbers = np.empty((height, width), np.int32)
    parents = np.empty(height * width, np.int32)
    count = 0
    # Column by column, and for the row: where the last depth is, and what it may hide.
    above, above_hidden = np.full(width, -1, np.int64), np.full(width, -1, np.int64)
    across, down = HIDDEN_WIDTH * camera.fx, HIDDEN_WIDTH * camera.fy
    for row in range(height):
        left = left_hidden = -1
        for column in range(width):
            here = depth[row, column]
            if not here > 0:
                numbers[row, column] = -1
                if here < 0:
                    left = left_hidden = above[column] = above_hidden[column] = -1
                continue
            # Where there is none, -1 reads some pixel or other, which then does not count.
            depths = here, depth[row, left], depth[row, left_hidden]
            place = column, left, left_hidden
            joined, left_hidden = _follow(place, depths, gap, across)
            number = numbers[row, joined] if joined >= 0 else -1
            place = row, above[column], above_hidden[column]
            depths = here, depth[place[1], column], depth[place[2], column]
            joined, above_hidden[column] = _follow(place, depths, gap, down)
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
    place: tuple[int, int, int], depths: tuple[float, float, float], gap: int, reach: float
) -> tuple[int, int]:
    """Return with which earlier pixel of its line a pixel hangs together, and what is hidden now.

    Both are -1 for none.

    Args:
        place: in its row or column, where the pixel is, where the last one with a depth is, and
            where the surface stopped that this last one may hide.
        depths: of these three, metres.
        gap: as for `connect`.
        reach: how far a hidden surface is followed, in pixels at a depth of one metre.
    """
    index, last, hidden = place
    here, before, behind = depths
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
    """Join two sets and return their root, the one that was made first."""
    first, second = _root(parents, first), _root(parents, second)
    root = min(first, second)
    parents[first] = parents[second] = root
    return root


@kernel
def _renumber(numbers: NDArray[np.int32], parents: NDArray[np.int32]) -> int:
    """Let `numbers`, shape (H, W), be those of the sets without holes; return how many."""
    count = 0
    for number in range(len(parents)):
        if parents[number] == number:
            parents[number] = count
            count += 1
        else:  # a parent comes before its children, and has its final number already
            parents[number] = parents[parents[number]]
    flat = numbers.reshape(-1)
    for index in range(len(flat)):
        if flat[index] >= 0:
            flat[index] = parents[flat[index]]
    return count


@kernel
def measure(
    depth: NDArray[np.float32], numbers: NDArray[np.int32], count: int, camera: Intrinsics
) -> Blobs:
    """Return the blobs with their sizes.

    A pixel that faces the camera at depth z shows z^2 / (fx fy) square metres.

    Args:
        depth: metres, shape (H, W).
        numbers: the blob of each pixel, -1 for none, shape (H, W).
        count: how many blobs there are.
        camera: the intrinsics.
    """
    pixels = np.zeros(count, np.int64)
    area, total = np.zeros(count), np.zeros(count)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    height, width = numbers.shape
    for row in range(height):
        up_down = (row - camera.cy) / camera.fy
        column = 0
        while column < width:
            blob = numbers[row, column]
            if blob < 0:
                column += 1
                continue
            begin = column
            least_x = least_z = np.inf
            most_x = most_z = -np.inf
            sum_z = sum_zz = 0.0
            while column < width and numbers[row, column] == blob:
                z = float(depth[row, column])
                x = (column - camera.cx) * z
                least_x, most_x = min(least_x, x), max(most_x, x)
                least_z, most_z = min(least_z, z), max(most_z, z)
                sum_z += z
                sum_zz += z * z
                column += 1
            pixels[blob] += column - begin
            area[blob] += sum_zz
            total[blob] += sum_z
            low[blob, 0] = min(low[blob, 0], least_x / camera.fx)
            high[blob, 0] = max(high[blob, 0], most_x / camera.fx)
            low[blob, 1] = min(low[blob, 1], up_down * least_z, up_down * most_z)
            high[blob, 1] = max(high[blob, 1], up_down * least_z, up_down * most_z)
            low[blob, 2] = min(low[blob, 2], least_z)
            high[blob, 2] = max(high[blob, 2], most_z)
    area /= camera.fx * camera.fy
    return Blobs(numbers, pixels, area, total / pixels, low, high)


@kernel
def touch(
    numbers: NDArray[np.int32], ranks: NDArray[np.int32], bodies: int, gap: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return how long the blobs' outlines are, and how much of them meets each body.

    Both in sides of pixels. An outline has no sides along the image's edge. It meets a body where
    the next pixel with a blob, at most `gap` pixels away in that row or column, is the body's.

    Args:
        numbers: the blob of each pixel, -1 for none, shape (H, W).
        ranks: of each blob, which body it is, -1 if none, shape (B,).
        bodies: how many bodies there are.
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
def paint(numbers: NDArray[np.int32], labels_of_blobs: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return the label of each pixel's blob, shape (H, W).

    Args:
        numbers: the blob of each pixel, -1 for none, shape (H, W).
        labels_of_blobs: of each blob, and at the end of no blob, shape (B + 1,).
    """
    labels = np.empty(numbers.shape, np.int32)
    for row in range(numbers.shape[0]):
        for column in range(numbers.shape[1]):
            labels[row, column] = labels_of_blobs[numbers[row, column]]
    return labels
