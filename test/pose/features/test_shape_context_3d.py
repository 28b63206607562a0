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

"""The 3DLSC descriptor and the mean distance, against equations 3 and 4."""

import itertools
import math

import numpy as np
import pytest
from plain import descriptor as plain

from lsc_pose_ros.pose.features.shape_context_3d import (
    AZIMUTH_BINS,
    DESCRIPTOR_SIZE,
    LEVEL_SCALE,
    RADIUS_BINS,
    ZENITH_BINS,
    describe,
    mean_distance,
)


def mean_distance_twin(points: np.ndarray) -> float:
    pairs = list(itertools.combinations(points.astype(float), 2))
    return float(np.mean([np.linalg.norm(a - b) for a, b in pairs])) if pairs else 0.0


def triangle(position: float, bins: int, *, wraps: bool) -> np.ndarray:
    """Return the linear weight of each bin, from the distance to its centre (k + 0.5)."""
    centres = np.arange(bins) + 0.5
    if wraps:
        distance = np.abs((position - centres + bins / 2) % bins - bins / 2)
    else:
        distance = np.abs(np.clip(position, centres[0], centres[-1]) - centres)
    return np.maximum(0, 1 - distance)


def describe_twin(points: np.ndarray, radius: float, inner_radius: float) -> np.ndarray:
    """Equations 3 and 4: the product of three triangular weights for every bin."""
    points = points.astype(float)
    result = np.zeros((len(points), RADIUS_BINS, AZIMUTH_BINS, ZENITH_BINS))
    for i, j in itertools.permutations(range(len(points)), 2):
        dx, dy, dz = points[j] - points[i]
        distance = math.sqrt(dx**2 + dy**2 + dz**2)
        if distance == 0 or distance > radius:
            continue
        fraction = math.log(distance / radius / inner_radius) / math.log(1 / inner_radius)
        azimuth = math.atan2(dy, dx) % (2 * math.pi) / (2 * math.pi)
        zenith = math.acos(max(-1, min(1, dz / distance))) / math.pi
        result[i] += np.einsum(
            'r,a,z->raz',
            triangle(fraction * RADIUS_BINS, RADIUS_BINS, wraps=False),
            triangle(azimuth * AZIMUTH_BINS, AZIMUTH_BINS, wraps=True),
            triangle(zenith * ZENITH_BINS, ZENITH_BINS, wraps=False),
        )
    flat = result.reshape(len(points), DESCRIPTOR_SIZE)
    return flat / np.maximum(flat.sum(axis=1, keepdims=True), 1e-12)


DEGENERATE = {
    'none': np.zeros((0, 3)),
    'one': np.ones((1, 3)),
    'coincident': np.ones((4, 3)),
    'two coincident and one apart': np.array([[0, 0, 1], [0, 0, 1], [0.2, 0, 1]]),
    'along z': np.stack([np.zeros(9), np.zeros(9), np.linspace(1, 2, 9)], axis=1),
    'along x': np.stack([np.linspace(-1, 1, 9), np.zeros(9), np.ones(9)], axis=1),
    'along y': np.stack([np.zeros(9), np.linspace(-1, 1, 9), np.ones(9)], axis=1),
    'very near': 1e-5 * np.random.default_rng(0).random((9, 3)) + [0, 0, 1e-3],
    'far apart': 10 * np.eye(3),
}


@pytest.mark.parametrize('seed', range(4))
def test_mean_distance_of_random_points(seed: int) -> None:
    points = np.random.default_rng(seed).normal(0, 0.5, (60, 3)).astype(np.float32)
    for function in (mean_distance, plain.mean_distance):
        assert function(points) == pytest.approx(mean_distance_twin(points), rel=1e-5)


@pytest.mark.parametrize('points', DEGENERATE.values(), ids=DEGENERATE.keys())
def test_mean_distance_of_degenerate_points(points: np.ndarray) -> None:
    points = points.astype(np.float32)
    for function in (mean_distance, plain.mean_distance):
        assert function(points) == pytest.approx(mean_distance_twin(points), rel=1e-4)


def check_descriptors(points: np.ndarray, radius: float, inner_radius: float) -> None:
    """Check the plain and the fast descriptors of `points` against the equations."""
    expected = describe_twin(points, radius, inner_radius)
    histograms = plain.describe(points, np.arange(len(points)), radius, inner_radius)
    np.testing.assert_allclose(histograms, expected, atol=2e-5)
    quantised = describe(points, np.arange(len(points)), radius, inner_radius).astype(float)
    exact = np.minimum(255, LEVEL_SCALE * np.sqrt(expected))
    # Half a level by rounding, and what the fast arithmetic adds.
    assert np.abs(quantised - exact).max(initial=0) <= 0.6


@pytest.mark.parametrize('seed', range(4))
@pytest.mark.parametrize(('radius', 'inner_radius'), [(0.6, 0.1), (2.0, 0.03), (0.3, 0.5)])
def test_describe_is_equations_3_and_4(seed: int, radius: float, inner_radius: float) -> None:
    points = np.random.default_rng(seed).normal(0, 0.4, (50, 3)).astype(np.float32)
    check_descriptors(points, radius, inner_radius)


@pytest.mark.parametrize('points', DEGENERATE.values(), ids=DEGENERATE.keys())
def test_describe_degenerate_points(points: np.ndarray) -> None:
    check_descriptors(points.astype(np.float32), 0.5, 0.1)


def test_points_on_a_grid_fall_on_the_axes_and_diagonals_of_the_bins() -> None:
    grid = np.stack(np.meshgrid(*[np.arange(5) * 0.1] * 3), axis=-1).reshape(-1, 3)
    check_descriptors(grid.astype(np.float32), 0.45, 0.1)


def test_only_the_points_that_are_asked_for_are_described() -> None:
    points = np.random.default_rng(5).normal(0, 0.4, (80, 3)).astype(np.float32)
    everyone = describe(points, np.arange(80), 0.7, 0.1)
    some = np.array([3, 70, 3])
    np.testing.assert_array_equal(describe(points, some, 0.7, 0.1), everyone[some])
    np.testing.assert_array_equal(
        plain.describe(points, some, 0.7, 0.1),
        plain.describe(points, np.arange(80), 0.7, 0.1)[some],
    )
    assert describe(points, some[:0], 0.7, 0.1).shape == (0, DESCRIPTOR_SIZE)


def test_histogram_sums_to_one_or_is_empty() -> None:
    points = np.random.default_rng(7).normal(0, 0.4, (80, 3)).astype(np.float32)
    points[0] = 50  # nobody near
    sums = plain.describe(points, np.arange(len(points)), 0.7, 0.1).sum(axis=1)
    assert sums[0] == 0
    np.testing.assert_allclose(sums[1:], 1, atol=1e-5)


def test_descriptors_do_not_change_with_position_and_scale() -> None:
    points = np.random.default_rng(3).normal(0, 0.4, (60, 3)).astype(np.float32)
    moved = 1.7 * points + np.float32(0.3)
    everyone = np.arange(60)
    before = describe(points, everyone, mean_distance(points), 0.1).astype(int)
    after = describe(moved, everyone, mean_distance(moved), 0.1).astype(int)
    assert np.abs(after - before).max() <= 2
