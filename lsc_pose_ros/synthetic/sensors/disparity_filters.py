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

"""Filters that drivers of stereo cameras apply to disparity: they fill holes and smooth edges."""

import math

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import exact_kernel


def smoothing_factor(deviation: float) -> float:
    """Return a in y_i = y_(i-1) + a (x_i - y_(i-1)) for a blur of `deviation` pixels.

    The recursion runs forwards and backwards. The variance of its response is 2 (1 - a) / a².
    """
    if deviation <= 0.0:
        return 1.0
    return (math.sqrt(1.0 + 2.0 * deviation * deviation) - 1.0) / (deviation * deviation)


@exact_kernel
def fill_holes(inverse_depth: NDArray[np.float32], labels: NDArray[np.int32], widest: int) -> None:
    """Fill holes with the pixel on their left, up to `widest` pixels, in place."""
    height, width = inverse_depth.shape
    for row in range(height):
        last = -1
        for column in range(width):
            if inverse_depth[row, column] > 0.0:
                last = column
            elif last >= 0 and column - last <= widest:
                inverse_depth[row, column] = inverse_depth[row, last]
                labels[row, column] = labels[row, last]


@exact_kernel
def smooth(inverse_depth: NDArray[np.float32], factor: float, max_difference: float) -> None:
    """Smooth 1/z along rows and then along columns, forwards and backwards, in place.

    Args:
        inverse_depth: 1/z, 0 in empty pixels, shape (H, W).
        factor: see `smoothing_factor`.
        max_difference: larger differences between neighbours are edges, which stay, 1/m.
    """
    height, width = inverse_depth.shape
    for row in range(height):
        smooth_line(inverse_depth[row], factor, max_difference)
    for column in range(width):
        smooth_line(inverse_depth[:, column], factor, max_difference)


@exact_kernel
def smooth_line(line: NDArray[np.float32], factor: float, max_difference: float) -> None:
    """Smooth one row or column forwards and backwards, in place."""
    count = len(line)
    for backwards in range(2):
        before = 0.0
        for step in range(count):
            at = count - 1 - step if backwards else step
            value = float(line[at])
            if value > 0.0 and before > 0.0 and abs(value - before) <= max_difference:
                value = before + factor * (value - before)
                line[at] = value
            before = value
