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


"""Convolutions of planes, for a small network on one core.

A plane of h x w cells is stored with a border of one zero on each side and flat, row after row:
(h + 2) (w + 2) values. A 3 x 3 convolution is then a sum of nine shifted planes, computed in one
loop over all cells that the compiler vectorises; what it writes into the border is set to zero
again.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel


@kernel
def with_border(planes: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return planes of shape (C, h, w) with a border of zeros, shape (C, (h + 2) (w + 2))."""
    count, height, width = planes.shape
    padded = np.zeros((count, height + 2, width + 2), np.float32)
    for c in range(count):
        for i in range(height):
            for j in range(width):
                padded[c, i + 1, j + 1] = planes[c, i, j]
    return padded.reshape((count, (height + 2) * (width + 2)))


@kernel
def convolve(
    planes: NDArray[np.float32],
    shape: tuple[int, int],
    weights: NDArray[np.float32],
    bias: NDArray[np.float32],
) -> NDArray[np.float32]:
    """Return the 3 x 3 convolution of planes: y_o = b_o + sum_c,u,v w_o,c,u,v x_c(i + u, j + v).

    Args:
        planes: with border, flat, shape (C, (h + 2) (w + 2)).
        shape: h and w.
        weights: shape (O, C, 9), the offsets u, v = -1, 0, 1 in rows.
        bias: shape (O,).

    Returns:
        The planes, shape (O, (h + 2) (w + 2)). Their border is not zero.
    """
    return sum_shifted(planes, nine_offsets(shape[1] + 2), shape, weights, bias)


@kernel
def sum_shifted(
    planes: NDArray[np.float32],
    offsets: NDArray[np.int64],
    shape: tuple[int, int],
    weights: NDArray[np.float32],
    bias: NDArray[np.float32],
) -> NDArray[np.float32]:
    """Return the bias plus the weighted sums of shifted planes, shape (O, (h + 2) (w + 2)).

    Args:
        planes: flat, shape (C, N).
        offsets: where each of the nine shifted planes begins, for the first cell, shape (9,).
        shape: h and w of the result.
        weights: shape (O, C, 9).
        bias: shape (O,).
    """
    height, row = shape[0], shape[1] + 2
    first = row + 1
    count = height * row - 2
    result = np.empty((weights.shape[0], (height + 2) * row), np.float32)
    for o in range(weights.shape[0]):
        inside = result[o, first : first + count]
        inside[:] = bias[o]
        for c in range(planes.shape[0]):
            add_nine(inside, planes[c], offsets, weights[o, c])
    return result


@kernel
def nine_offsets(width: int) -> NDArray[np.int64]:
    """Return the offsets of a cell's 3 x 3 neighbourhood in a flat plane, from its first one."""
    offsets = np.empty(9, np.int64)
    for u in range(3):
        for v in range(3):
            offsets[3 * u + v] = u * width + v
    return offsets


@kernel
def add_nine(
    result: NDArray[np.float32],
    plane: NDArray[np.float32],
    offsets: NDArray[np.int64],
    weights: NDArray[np.float32],
) -> None:
    """Add the weighted sum of nine shifted planes to `result`, shape (n,).

    Args:
        result: updated.
        plane: the values; those from an offset on are one shifted plane, shape (N,).
        offsets: shape (9,), each at most N - n.
        weights: of the shifted planes, shape (9,).
    """
    n = result.shape[0]
    x0, x1 = plane[offsets[0] : offsets[0] + n], plane[offsets[1] : offsets[1] + n]
    x2, x3 = plane[offsets[2] : offsets[2] + n], plane[offsets[3] : offsets[3] + n]
    x4, x5 = plane[offsets[4] : offsets[4] + n], plane[offsets[5] : offsets[5] + n]
    x6, x7 = plane[offsets[6] : offsets[6] + n], plane[offsets[7] : offsets[7] + n]
    x8 = plane[offsets[8] : offsets[8] + n]
    w0, w1, w2, w3, w4, w5, w6, w7, w8 = weights
    for p in range(n):
        first = w0 * x0[p] + w1 * x1[p] + w2 * x2[p] + w3 * x3[p]
        second = w4 * x4[p] + w5 * x5[p] + w6 * x6[p] + w7 * x7[p]
        result[p] += first + second + w8 * x8[p]


@kernel
def convolve_halving(
    planes: NDArray[np.float32],
    shape: tuple[int, int],
    weights: NDArray[np.float32],
    bias: NDArray[np.float32],
) -> NDArray[np.float32]:
    """Return each second row and column of `convolve`, the first ones included.

    Args: see `convolve`.

    Returns:
        The planes of ceil(h / 2) rows and ceil(w / 2) columns. Their border is not zero.
    """
    height, width = (shape[0] + 1) // 2, (shape[1] + 1) // 2
    quarters = split_in_four(planes, shape)
    row, size = width + 2, quarters.shape[1] // 4
    offsets = np.empty(9, np.int64)
    for u in range(3):
        for v in range(3):
            offsets[3 * u + v] = (2 * (u % 2) + v % 2) * size + (u // 2) * row + v // 2
    return sum_shifted(quarters, offsets, (height, width), weights, bias)


@kernel
def split_in_four(planes: NDArray[np.float32], shape: tuple[int, int]) -> NDArray[np.float32]:
    """Return the even and odd rows and columns of planes apart.

    Args:
        planes: with border, flat, shape (C, (h + 2) (w + 2)).
        shape: h and w.

    Returns:
        For each plane the four of even and odd rows and columns, the border included, each
        (ceil(h / 2) + 2) rows of (ceil(w / 2) + 2) columns, flat and one after the other.
    """
    height, width = shape
    rows, columns = (height + 1) // 2 + 2, (width + 1) // 2 + 2
    quarters = np.zeros((planes.shape[0], 4, rows, columns), np.float32)
    for c in range(planes.shape[0]):
        for i in range(height + 2):
            for j in range(width + 2):
                value = planes[c, i * (width + 2) + j]
                quarters[c, 2 * (i % 2) + j % 2, i // 2, j // 2] = value
    return quarters.reshape((planes.shape[0], 4 * rows * columns))


@kernel
def mix(
    planes: NDArray[np.float32], weights: NDArray[np.float32], bias: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Return the 1 x 1 convolution y_o = b_o + sum_c w_o,c x_c.

    Args:
        planes: flat, shape (C, N).
        weights: shape (O, C).
        bias: shape (O,).

    Returns:
        Shape (O, N). A border is not zero.
    """
    count = planes.shape[0]
    result = np.empty((weights.shape[0], planes.shape[1]), np.float32)
    for o in range(weights.shape[0]):
        row = result[o]
        row[:] = bias[o]
        for c in range(0, count - count % 4, 4):
            x0, x1, x2, x3 = planes[c], planes[c + 1], planes[c + 2], planes[c + 3]
            w0, w1, w2, w3 = weights[o, c], weights[o, c + 1], weights[o, c + 2], weights[o, c + 3]
            for p in range(row.shape[0]):
                row[p] += w0 * x0[p] + w1 * x1[p] + w2 * x2[p] + w3 * x3[p]
        for c in range(count - count % 4, count):
            x0, w0 = planes[c], weights[o, c]
            for p in range(row.shape[0]):
                row[p] += w0 * x0[p]
    return result


@kernel
def add(planes: NDArray[np.float32], others: NDArray[np.float32]) -> None:
    """Add planes of the same shape to `planes`."""
    for c in range(planes.shape[0]):
        x, y = planes[c], others[c]
        for p in range(x.shape[0]):
            x[p] += y[p]


@kernel
def add_doubled(
    planes: NDArray[np.float32], shape: tuple[int, int], coarse: NDArray[np.float32]
) -> None:
    """Add planes of half as many rows and columns, each cell of them to four.

    Args:
        planes: with border, flat, shape (C, (h + 2) (w + 2)); updated.
        shape: h and w.
        coarse: of ceil(h / 2) rows and ceil(w / 2) columns, with border, flat.
    """
    height, width = shape
    row, coarse_row = width + 2, (width + 1) // 2 + 2
    for c in range(planes.shape[0]):
        for i in range(height):
            to, source = (i + 1) * row + 1, (i // 2 + 1) * coarse_row + 1
            for j in range(width):
                planes[c, to + j] += coarse[c, source + j // 2]


@kernel
def rectify(planes: NDArray[np.float32], shape: tuple[int, int]) -> None:
    """Set negative values, and the border, to zero.

    Args:
        planes: with border, flat, shape (C, (h + 2) (w + 2)); updated.
        shape: h and w.
    """
    height, width = shape
    row = width + 2
    for c in range(planes.shape[0]):
        plane = planes[c]
        plane[:row] = 0
        plane[(height + 1) * row :] = 0
        for i in range(1, height + 1):
            inside = plane[i * row + 1 : i * row + 1 + width]
            plane[i * row] = 0
            plane[i * row + 1 + width] = 0
            for j in range(width):
                # Written so that NaN becomes 0.
                inside[j] = inside[j] if inside[j] > 0 else np.float32(0)
