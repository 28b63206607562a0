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

"""The descriptor that counts each point in one bin."""

import itertools
import math

import numpy as np
import pytest

from lsc_pose_ros.pose.features.nearest_bin import describe_by_nearest_bin, quantise
from lsc_pose_ros.pose.features.shape_context_3d import (
    AZIMUTH_BINS,
    LEVEL_SCALE,
    RADIUS_BINS,
    ZENITH_BINS,
)
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.stages import describe_body

DEGENERATE = {
    'none': np.zeros((0, 3)),
    'one': np.ones((1, 3)),
    'coincident': np.ones((4, 3)),
    'along z': np.stack([np.zeros(9), np.zeros(9), np.linspace(1, 2, 9)], axis=1),
    'very near': 1e-5 * np.random.default_rng(0).random((9, 3)) + [0, 0, 1e-3],
    'far apart': 10 * np.eye(3),
}


def twin(points, radius, inner_radius):
    """Count every pair with numpy's own histogram."""
    edges = (
        np.r_[-np.inf, np.arange(1, RADIUS_BINS), np.inf],
        np.linspace(0, 2 * math.pi, AZIMUTH_BINS + 1),
        np.linspace(0, math.pi, ZENITH_BINS + 1),
    )
    result = np.zeros((len(points), RADIUS_BINS, AZIMUTH_BINS, ZENITH_BINS))
    positions = [[] for _ in points]
    for i, j in itertools.permutations(range(len(points)), 2):
        dx, dy, dz = (points[j] - points[i]).astype(float)
        distance = math.sqrt(dx**2 + dy**2 + dz**2)
        if 0 < distance <= radius:
            fraction = math.log(distance / radius / inner_radius) / math.log(1 / inner_radius)
            azimuth = math.atan2(dy, dx) % (2 * math.pi)
            zenith = math.acos(max(-1, min(1, dz / distance)))
            positions[i].append((RADIUS_BINS * fraction, azimuth, zenith))
    for i, mine in enumerate(positions):
        if mine:
            result[i] = np.histogramdd(np.array(mine), edges)[0] / len(mine)
    return result.reshape(len(points), RADIUS_BINS * AZIMUTH_BINS * ZENITH_BINS)


@pytest.mark.parametrize('seed', range(3))
def test_random_points_count_in_the_bin_that_they_lie_in(seed):
    points = np.random.default_rng(seed).normal(0, 0.4, (50, 3)).astype(np.float32)
    found = describe_by_nearest_bin(points, np.arange(50), 0.7, 0.1)
    wanted = twin(points, 0.7, 0.1)
    # A point on the border of two bins may fall to either side.
    assert (np.abs(found - wanted).max(axis=1) < 1e-6).mean() > 0.95
    assert found.sum(axis=1) == pytest.approx(wanted.sum(axis=1), abs=1e-5)


@pytest.mark.parametrize('points', DEGENERATE.values(), ids=DEGENERATE.keys())
def test_degenerate_points(points):
    points = points.astype(np.float32)
    found = describe_by_nearest_bin(points, np.arange(len(points)), 0.5, 0.1)
    sums = found.sum(axis=1)
    assert found.shape == (len(points), RADIUS_BINS * AZIMUTH_BINS * ZENITH_BINS)
    assert np.all((np.abs(sums - 1) < 1e-5) | (sums == 0))
    assert (sums > 0).tolist() == (twin(points, 0.5, 0.1).sum(axis=1) > 0).tolist()


def shape_of(frame, settings):
    body = int(frame.ground_truth.bodies[0])
    return describe_body(frame.depth, frame.labels, frame.camera, body, settings)


def test_setting_binning_decides(people):
    settings = Settings(points=120, query_points=40)
    shared = shape_of(people[0], settings)
    nearest = shape_of(people[0], settings._replace(binning='nearest'))
    reach = shared.scale * settings.support_radius
    points = shared.silhouette.points
    wanted = describe_by_nearest_bin(points, shared.queries, reach, settings.inner_radius)
    np.testing.assert_array_equal(nearest.quantised, quantise(wanted))
    # What is not shared is in fewer bins.
    assert np.count_nonzero(nearest.quantised) < 0.6 * np.count_nonzero(shared.quantised)


def test_fixed_scale_replaces_rho_bar(people):
    settings = Settings(points=120, query_points=120)
    own = shape_of(people[0], settings)
    fixed = shape_of(people[0], settings._replace(fixed_scale=0.5))
    assert fixed.scale == 0.5 != own.scale
    np.testing.assert_array_equal(fixed.points, own.points)
    same = shape_of(people[0], settings._replace(fixed_scale=own.scale))
    np.testing.assert_array_equal(same.quantised, own.quantised)
    assert not np.array_equal(fixed.quantised, own.quantised)


def test_quantise_keeps_the_order_and_saturates() -> None:
    values = np.sort(np.random.default_rng(0).random((3, 360)).astype(np.float32) ** 4, axis=1)
    quantised = quantise(values)
    expected = np.minimum(255, np.floor(LEVEL_SCALE * np.sqrt(values.astype(float)) + 0.5))
    assert np.abs(quantised.astype(int) - expected).max() <= 1  # rounding at the very border
    assert (np.diff(quantised.astype(int), axis=1) >= 0).all()
    assert quantise(np.array([[0.0, 1.0]], np.float32)).tolist() == [[0, 255]]
