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

"""The 2-D shape context, against its definition."""

import itertools
import math

import numpy as np
import pytest

from lsc_pose_ros.pose.features.shape_context_2d import (
    AZIMUTH_BINS,
    LEVEL_SCALE,
    RADIUS_BINS,
    SIZE,
    describe_in_image,
)


def triangle(position: float, bins: int, *, wraps: bool) -> np.ndarray:
    """Return the linear weight of each bin, from the distance to its centre (k + 0.5)."""
    centres = np.arange(bins) + 0.5
    if wraps:
        distance = np.abs((position - centres + bins / 2) % bins - bins / 2)
    else:
        distance = np.abs(np.clip(position, centres[0], centres[-1]) - centres)
    return np.maximum(0, 1 - distance)


def describe_twin(pixels: np.ndarray, radius: float, inner_radius: float) -> np.ndarray:
    """The product of two triangular weights for every bin."""
    pixels = pixels.astype(float)
    result = np.zeros((len(pixels), RADIUS_BINS, AZIMUTH_BINS))
    for i, j in itertools.permutations(range(len(pixels)), 2):
        dx, dy = pixels[j] - pixels[i]
        distance = math.hypot(dx, dy)
        if distance == 0 or distance > radius:
            continue
        fraction = math.log(distance / radius / inner_radius) / math.log(1 / inner_radius)
        azimuth = math.atan2(dy, dx) % (2 * math.pi) / (2 * math.pi)
        result[i] += np.outer(
            triangle(fraction * RADIUS_BINS, RADIUS_BINS, wraps=False),
            triangle(azimuth * AZIMUTH_BINS, AZIMUTH_BINS, wraps=True),
        )
    flat = result.reshape(len(pixels), SIZE)
    return flat / np.maximum(flat.sum(axis=1, keepdims=True), 1e-12)


def check(pixels: np.ndarray, radius: float, inner_radius: float) -> None:
    pixels = pixels.astype(np.float32)
    quantised = describe_in_image(pixels, np.arange(len(pixels)), radius, inner_radius)
    exact = LEVEL_SCALE * np.sqrt(describe_twin(pixels, radius, inner_radius))
    assert quantised.shape == (len(pixels), SIZE)
    assert np.abs(quantised - exact).max(initial=0) <= 0.51  # half a level by rounding


DEGENERATE = {
    'none': np.zeros((0, 2)),
    'one': np.ones((1, 2)),
    'coincident': np.ones((4, 2)),
    'two coincident and one apart': np.array([[5, 5], [5, 5], [30, 5]]),
    'a row': np.stack([np.arange(-9, 9), np.zeros(18)], axis=1),
    'a column': np.stack([np.zeros(18), np.arange(-9, 9)], axis=1),
    'a diagonal': np.stack([np.arange(-9, 9), np.arange(-9, 9)], axis=1),
    'a grid': np.stack(np.meshgrid(np.arange(7), np.arange(7)), axis=-1).reshape(-1, 2),
    'far apart': 1000 * np.eye(2),
}


@pytest.mark.parametrize('seed', range(4))
@pytest.mark.parametrize(('radius', 'inner_radius'), [(60, 0.1), (300, 0.03), (25, 0.5)])
def test_shape_context_in_the_image(seed: int, radius: float, inner_radius: float) -> None:
    check(np.random.default_rng(seed).normal(100, 40, (50, 2)), radius, inner_radius)


@pytest.mark.parametrize('pixels', DEGENERATE.values(), ids=DEGENERATE.keys())
def test_shape_context_of_degenerate_points(pixels: np.ndarray) -> None:
    check(pixels, 40.0, 0.1)


def test_without_reach_the_descriptor_is_empty() -> None:
    pixels = np.arange(10, dtype=np.float32).reshape(5, 2)
    assert not describe_in_image(pixels, np.arange(5), 0.0, 0.1).any()


def test_only_the_points_that_are_asked_for_are_described() -> None:
    pixels = np.random.default_rng(5).normal(0, 40, (80, 2)).astype(np.float32)
    everyone = describe_in_image(pixels, np.arange(80), 60.0, 0.1)
    some = np.array([3, 70, 3])
    np.testing.assert_array_equal(describe_in_image(pixels, some, 60.0, 0.1), everyone[some])


def test_all_points_in_one_bin_fill_it_and_no_other() -> None:
    # At the centre of the outermost ring and of the fourth azimuth bin.
    angle, reach = 3.5 * 2 * math.pi / AZIMUTH_BINS, 100.0
    away = 0.1 ** (0.5 / RADIUS_BINS) * reach
    way = np.array([[math.cos(angle), math.sin(angle)]])
    pixels = np.concatenate([np.zeros((1, 2)), np.repeat(away * way, 6, axis=0)])
    quantised = describe_in_image(pixels.astype(np.float32), np.arange(1), reach, 0.1)
    assert np.argmax(quantised) == (RADIUS_BINS - 1) * AZIMUTH_BINS + 3
    assert quantised.max() == 255
    assert np.sort(quantised[0])[-2] <= 1
