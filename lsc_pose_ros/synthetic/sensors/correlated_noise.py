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

"""Noise that is correlated between neighbouring pixels."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import exact_kernel


class GridInterpolation(NamedTuple):
    """Interpolation of the pixels of one axis between the nodes of a coarse grid.

    Attributes:
        first: the node before each pixel, shape (N,).
        weights: of that node and of the next one, with a sum of squares of 1, shape (N, 2).
    """

    first: NDArray[np.int64]
    weights: NDArray[np.float32]


def correlated_field(
    shape: tuple[int, int], spacing: float, random: np.random.Generator
) -> NDArray[np.float32]:
    """Return normal noise with deviation 1 at each pixel and a correlation length of `spacing`.

    Independent values on a coarse grid with a random offset are interpolated bilinearly. With a
    spacing of one pixel or less, all pixels are independent.

    Args:
        shape: rows and columns.
        spacing: of the grid, pixels.
        random: the generator; the sequence of its calls depends only on `shape` and `spacing`.

    Returns:
        The noise, shape `shape`.
    """
    if spacing <= 1:
        return random.standard_normal(shape, dtype=np.float32)
    rows, columns = (grid_interpolation(count, spacing, random.random()) for count in shape)
    size = rows.first[-1] + 2, columns.first[-1] + 2
    field = np.empty(shape, np.float32)
    interpolate_grid(random.standard_normal(size, dtype=np.float32), rows, columns, field)
    return field


def grid_interpolation(count: int, spacing: float, offset: float) -> GridInterpolation:
    """Return the interpolation for `count` pixels; `offset` is in [0, 1) of the spacing.

    The variance of linear interpolation is (1 - t)² + t², less than 1 between the nodes. The
    weights are divided by its square root.
    """
    position = np.arange(count) / spacing + offset
    first = np.floor(position).astype(np.int64)
    probability = position - first
    weights = np.stack([1 - probability, probability], axis=1)
    weights /= np.sqrt((weights**2).sum(axis=1, keepdims=True))
    return GridInterpolation(first, weights.astype(np.float32))


@exact_kernel
def interpolate_grid(
    values: NDArray[np.float32],
    rows: GridInterpolation,
    columns: GridInterpolation,
    field: NDArray[np.float32],
) -> None:
    """Fill `field` with the bilinear interpolation of the values of a coarse grid."""
    first, weights = columns
    height, width = field.shape
    for row in range(height):
        above = rows.first[row]
        upper, lower = rows.weights[row, 0], rows.weights[row, 1]
        for column in range(width):
            left = first[column]
            before = upper * values[above, left] + lower * values[above + 1, left]
            after = upper * values[above, left + 1] + lower * values[above + 1, left + 1]
            field[row, column] = weights[column, 0] * before + weights[column, 1] * after
