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

"""Compiled products and rotations of single 3x3 matrices."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel


@kernel
def multiply(
    first: NDArray[np.float64], second: NDArray[np.float64], result: NDArray[np.float64]
) -> None:
    """Set `result` to the product of two matrices, all of shape (3, 3)."""
    for row in range(3):
        for column in range(3):
            result[row, column] = (
                first[row, 0] * second[0, column]
                + first[row, 1] * second[1, column]
                + first[row, 2] * second[2, column]
            )


@kernel
def multiply_transposed(
    first: NDArray[np.float64], second: NDArray[np.float64], result: NDArray[np.float64]
) -> None:
    """Set `result` to the product of `first` transposed and `second`, all of shape (3, 3)."""
    for row in range(3):
        for column in range(3):
            result[row, column] = (
                first[0, row] * second[0, column]
                + first[1, row] * second[1, column]
                + first[2, row] * second[2, column]
            )


@kernel
def product(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the product of two matrices, shape (3, 3)."""
    result = np.empty((3, 3))
    multiply(first, second, result)
    return result


@kernel
def rotated(rotation: NDArray[np.float64], vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a vector, shape (3,), multiplied by a matrix, shape (3, 3)."""
    result = np.empty(3)
    for row in range(3):
        result[row] = (
            rotation[row, 0] * vector[0]
            + rotation[row, 1] * vector[1]
            + rotation[row, 2] * vector[2]
        )
    return result


@kernel
def rotated_back(
    rotation: NDArray[np.float64], vector: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return a vector, shape (3,), multiplied by the transpose of a matrix, shape (3, 3)."""
    result = np.empty(3)
    for row in range(3):
        result[row] = (
            rotation[0, row] * vector[0]
            + rotation[1, row] * vector[1]
            + rotation[2, row] * vector[2]
        )
    return result


@kernel
def about_x(angle: float) -> NDArray[np.float64]:
    """Return the rotation about x, which maps y towards z, shape (3, 3)."""
    return _about(angle, 1, 2)


@kernel
def about_y(angle: float) -> NDArray[np.float64]:
    """Return the rotation about y, which maps z towards x, shape (3, 3)."""
    return _about(angle, 2, 0)


@kernel
def about_z(angle: float) -> NDArray[np.float64]:
    """Return the rotation about z, which maps x towards y, shape (3, 3)."""
    return _about(angle, 0, 1)


@kernel
def _about(angle: float, first: int, second: int) -> NDArray[np.float64]:
    rotation = np.zeros((3, 3))
    axis = 3 - first - second
    rotation[axis, axis] = 1.0
    rotation[first, first] = rotation[second, second] = np.cos(angle)
    rotation[second, first] = np.sin(angle)
    rotation[first, second] = -np.sin(angle)
    return rotation
