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


"""Labels of all pixels from labels of a coarse grid of cells."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.numerics.jit import kernel

STEP = 0.04
SLOPE = 0.02
"""A pixel has the label of a cell if their depths differ by at most STEP + SLOPE z, metres."""

ASIDE = 0.01
"""By how much more the depths of the eight cells around the nearest one seem to differ, metres."""


class Around(NamedTuple):
    """A cell and the up to eight around it, for the pixels that are nearest to it.

    Attributes:
        depth: metres, shape (9,).
        more: by how much more their depths seem to differ from a pixel's, metres, shape (9,).
        label: the body of each, NO_BODY for none, shape (9,).
    """

    depth: NDArray[np.float32]
    more: NDArray[np.float32]
    label: NDArray[np.int32]


@kernel
def labels_from_cells(
    depth: NDArray[np.float32],
    cell_labels: NDArray[np.int32],
    cell_depth: NDArray[np.float32],
    spacing: int,
    offset: int,
) -> NDArray[np.int32]:
    """Return the label of each pixel, shape (H, W).

    It is the label of that of the nine nearest cells whose depth differs least from the pixel's,
    so that labels end where the depth jumps. A pixel whose depth is unlike that of all of them
    has NO_BODY.

    Args:
        depth: metres, 0 or not finite if unknown, shape (H, W).
        cell_labels: the body of each cell, NO_BODY for none, shape (h, w).
        cell_depth: metres, 0 if unknown, shape (h, w).
        spacing: number of pixels between two cells.
        offset: the row and the column of the first cell's pixel.
    """
    height, width = depth.shape
    rows, columns = cell_labels.shape
    labels = np.full((height, width), NO_BODY, np.int32)
    around = Around(np.empty(9, np.float32), np.empty(9, np.float32), np.empty(9, np.int32))
    for i in range(rows):
        first_row, last_row = pixels_of(i, rows, spacing, offset, height)
        for j in range(columns):
            if not near_body(cell_labels, i, j):
                continue
            count = cells_around(cell_labels, cell_depth, i, j, around)
            first, last = pixels_of(j, columns, spacing, offset, width)
            for row in range(first_row, last_row):
                for column in range(first, last):
                    z = depth[row, column]
                    if 0 < z < np.inf:
                        labels[row, column] = label_at(around, count, z)
    return labels


@kernel
def pixels_of(index: int, count: int, spacing: int, offset: int, size: int) -> tuple[int, int]:
    """Return the first pixel of a line that is nearest to a cell, and the one after the last."""
    middle = index * spacing + offset
    first = 0 if index == 0 else middle - spacing // 2
    last = size if index == count - 1 else middle - spacing // 2 + spacing
    return max(first, 0), min(last, size)


@kernel
def near_body(cell_labels: NDArray[np.int32], i: int, j: int) -> bool:
    """Return whether a cell or one of the eight around it has a label."""
    for k in range(max(i - 1, 0), min(i + 2, cell_labels.shape[0])):
        for m in range(max(j - 1, 0), min(j + 2, cell_labels.shape[1])):
            if cell_labels[k, m] != NO_BODY:
                return True
    return False


@kernel
def cells_around(
    cell_labels: NDArray[np.int32],
    cell_depth: NDArray[np.float32],
    i: int,
    j: int,
    around: Around,
) -> int:
    """Write cell (i, j) and the cells around it that have a depth; return their number."""
    count = 0
    for k in range(max(i - 1, 0), min(i + 2, cell_labels.shape[0])):
        for m in range(max(j - 1, 0), min(j + 2, cell_labels.shape[1])):
            if cell_depth[k, m] > 0:
                around.depth[count], around.label[count] = cell_depth[k, m], cell_labels[k, m]
                around.more[count] = np.float32(0 if k == i and m == j else ASIDE)
                count += 1
    return count


@kernel
def label_at(around: Around, count: int, z: np.float32) -> int:
    """Return the label of a pixel at depth `z`, of the first `count` cells around it."""
    nearest = np.float32(STEP) + np.float32(SLOPE) * z
    label = NO_BODY
    for n in range(count):
        difference = abs(around.depth[n] - z) + around.more[n]
        if difference < nearest:
            nearest = difference
            label = around.label[n]
    return label
