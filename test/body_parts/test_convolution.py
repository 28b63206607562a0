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


"""Convolutions, against plain numpy written from the equations."""

import numpy as np
import pytest

from lsc_pose_ros.body_parts.convolution import (
    add,
    add_doubled,
    convolve,
    convolve_halving,
    mix,
    rectify,
    with_border,
)

SHAPES = [(1, 1), (1, 4), (2, 3), (5, 4), (7, 7), (6, 9)]
FIVE, THREE = 5, 3


def some_planes(shape: tuple[int, int], count: int = FIVE, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(count, *shape)).astype(np.float32)


def inside(flat: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    return flat.reshape(-1, shape[0] + 2, shape[1] + 2)[:, 1:-1, 1:-1]


def some_weights(outputs: int, inputs: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    weights = rng.normal(size=(outputs, inputs, 9)).astype(np.float32)
    return weights, rng.normal(size=outputs).astype(np.float32)


def convolved(planes: np.ndarray, weights: np.ndarray, bias: np.ndarray) -> np.ndarray:
    """Return y_o(i, j) = b_o + sum_c,u,v w_o,c,u,v x_c(i + u, j + v), with 0 outside."""
    count, height, width = planes.shape
    result = np.zeros((len(bias), height, width))
    for o, i, j in np.ndindex(result.shape):
        result[o, i, j] = bias[o]
        for c, u, v in np.ndindex(count, 3, 3):
            row, column = i + u - 1, j + v - 1
            if 0 <= row < height and 0 <= column < width:
                result[o, i, j] += float(weights[o, c, 3 * u + v]) * float(planes[c, row, column])
    return result


def tolerance(planes: np.ndarray, weights: np.ndarray) -> float:
    """Return the largest rounding error of a float32 sum of all products."""
    terms = weights[0].size + 1
    largest = np.abs(planes).max() * np.abs(weights).max() * terms + 10
    return float(terms * np.finfo(np.float32).eps * largest)


@pytest.mark.parametrize('shape', SHAPES)
def test_a_border_surrounds_the_planes(shape: tuple[int, int]) -> None:
    planes = some_planes(shape)
    expected = np.pad(planes, ((0, 0), (1, 1), (1, 1)))
    np.testing.assert_array_equal(with_border(planes), expected.reshape(FIVE, -1))


@pytest.mark.parametrize('shape', SHAPES)
def test_a_convolution_is_the_sum_over_the_neighbourhood(shape: tuple[int, int]) -> None:
    planes, (weights, bias) = some_planes(shape), some_weights(THREE, FIVE)
    found = inside(convolve(with_border(planes), shape, weights, bias), shape)
    expected = convolved(planes, weights, bias)
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance(planes, weights))


@pytest.mark.parametrize('shape', SHAPES)
def test_a_halving_convolution_has_each_second_row_and_column(shape: tuple[int, int]) -> None:
    planes, (weights, bias) = some_planes(shape), some_weights(THREE, FIVE)
    half = (shape[0] + 1) // 2, (shape[1] + 1) // 2
    found = inside(convolve_halving(with_border(planes), shape, weights, bias), half)
    expected = convolved(planes, weights, bias)[:, ::2, ::2]
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance(planes, weights))


@pytest.mark.parametrize('count', [1, 3, 4, 6, 9])
def test_a_mix_is_a_sum_over_the_planes(count: int) -> None:
    rng = np.random.default_rng(count)
    planes, bias = some_planes((4, 5), count).reshape(count, -1), rng.normal(size=2)
    weights = rng.normal(size=(2, count)).astype(np.float32)
    found = mix(planes, weights, bias.astype(np.float32))
    expected = weights.astype(float) @ planes.astype(float) + bias[:, None]
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance(planes, weights))


@pytest.mark.parametrize('shape', SHAPES)
def test_each_coarse_cell_is_added_to_four(shape: tuple[int, int]) -> None:
    half = (shape[0] + 1) // 2, (shape[1] + 1) // 2
    planes, coarse = some_planes(shape), some_planes(half, seed=3)
    flat = with_border(planes)
    add_doubled(flat, shape, with_border(coarse))
    expected = planes.copy()
    for _, i, j in np.ndindex(expected.shape):
        expected[_, i, j] += coarse[_, i // 2, j // 2]
    np.testing.assert_array_equal(inside(flat, shape), expected)


def test_planes_are_added() -> None:
    first, second = some_planes((3, 4)), some_planes((3, 4), seed=5)
    flat = with_border(first)
    add(flat, with_border(second))
    np.testing.assert_array_equal(inside(flat, (3, 4)), first + second)


@pytest.mark.parametrize('shape', SHAPES)
def test_negative_values_and_the_border_become_zero(shape: tuple[int, int]) -> None:
    planes = some_planes(shape)
    planes[0, 0, 0] = np.nan
    flat = with_border(planes)
    border = np.pad(np.zeros(shape, bool), 1, constant_values=True).ravel()
    flat[:, border] = 7
    rectify(flat, shape)
    assert not flat[:, border].any()
    np.testing.assert_array_equal(inside(flat, shape), np.where(planes > 0, planes, 0))
