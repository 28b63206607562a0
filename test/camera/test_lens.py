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

"""The distortion of lenses, against the equations, and its inverse."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from lsc_pose_ros.camera.lens import distort, transform_lens, undistort
from lsc_pose_ros.data_types.camera import EQUIDISTANT, PLUMB_BOB, RATIONAL_POLYNOMIAL, Lens

# A webcam, a wide time-of-flight camera, a lens with prism distortion, a fisheye lens.
LENSES = (
    Lens(PLUMB_BOB, (0.12, -0.25, 0.002, -0.001, 0.09)),
    Lens(PLUMB_BOB, (-0.3, 0.08, 0.001, 0.002)),
    Lens(RATIONAL_POLYNOMIAL, (3.9, 2.3, -1e-4, 3e-4, 0.1, 4.2, 3.6, 0.6)),
    Lens(RATIONAL_POLYNOMIAL, (0.3, -0.1, 0.01, -0.02, 0, 0.5, 0, 0, 0.01, -0.02, 0.03, 0.01)),
    Lens(EQUIDISTANT, (-0.02, 0.005, -0.001, 0.0002)),
)


def distort_twin(x: float, y: float, lens: Lens) -> tuple[float, float]:
    """Return the distorted direction by the equations of OpenCV, term by term."""
    d = [*lens.coefficients, *[0.0] * 12][:12]
    r = math.hypot(x, y)
    if lens.model == EQUIDISTANT:
        if r == 0:
            return x, y
        angle = math.atan(r)
        moved = angle + sum(d[i] * angle ** (3 + 2 * i) for i in range(4))
        return x / r * moved, y / r * moved
    k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4 = d
    radial = (1 + k1 * r**2 + k2 * r**4 + k3 * r**6) / (1 + k4 * r**2 + k5 * r**4 + k6 * r**6)
    return (
        x * radial + 2 * p1 * x * y + p2 * (r**2 + 2 * x**2) + s1 * r**2 + s2 * r**4,
        y * radial + p1 * (r**2 + 2 * y**2) + 2 * p2 * x * y + s3 * r**2 + s4 * r**4,
    )


def random_directions(seed: int, farthest: float = 0.6) -> NDArray[np.float64]:
    """Return directions of rays, the first along the optical axis, shape (200, 2)."""
    directions = np.random.default_rng(seed).uniform(-farthest, farthest, (200, 2))
    directions[0] = 0
    return directions


@pytest.mark.parametrize('lens', LENSES)
def test_distortion_is_that_of_the_equations(lens: Lens) -> None:
    directions = random_directions(1)
    expected = [distort_twin(x, y, lens) for x, y in directions.tolist()]
    np.testing.assert_allclose(distort(directions, lens), expected, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize('lens', LENSES)
def test_undistort_is_the_inverse(lens: Lens) -> None:
    directions = random_directions(2)
    found = undistort(distort(directions, lens), lens)
    np.testing.assert_allclose(found, directions, atol=1e-7)


def test_wide_lens_is_inverted_up_to_its_edge() -> None:
    lens = Lens(EQUIDISTANT, (0.0, 0.0, 0.0, 0.0))
    angles = np.radians([0, 1, 30, 60, 79])
    directions = np.stack([np.tan(angles), np.zeros(5)], axis=1)
    np.testing.assert_allclose(distort(directions, lens)[:, 0], angles, atol=1e-12)
    np.testing.assert_allclose(undistort(distort(directions, lens), lens), directions, rtol=1e-7)


def test_rays_outside_of_the_unique_field_have_no_place_in_the_image() -> None:
    # x' = x - 0.3 x^3 grows up to x = 1 / sqrt(0.9) = 1.054 only.
    lens = Lens(PLUMB_BOB, (-0.3,))
    distorted = distort(np.array([[1.0, 0.0], [1.1, 0.0], [0.0, -2.0], [np.nan, 0.0]]), lens)
    assert np.isfinite(distorted[0]).all()
    assert np.isnan(distorted[1:]).all()


def test_position_that_no_ray_reaches_has_the_ray_at_the_limit() -> None:
    lens = Lens(PLUMB_BOB, (-0.3,))
    x, y = undistort(np.array([[0.9, 0.0]]), lens)[0]
    assert x == pytest.approx(1 / math.sqrt(0.9), abs=2e-3)  # the limit is searched in steps
    assert y == 0


@pytest.mark.parametrize('lens', LENSES)
@pytest.mark.parametrize(
    'matrix', [[[0, -1], [1, 0]], [[-1, 0], [0, -1]], [[0, 1], [-1, 0]], [[-1, 0], [0, 1]]]
)
def test_lens_of_a_turned_or_mirrored_image(lens: Lens, matrix: list[list[int]]) -> None:
    turn, directions = np.array(matrix, float), random_directions(3)
    turned = distort(directions @ turn.T, transform_lens(lens, turn))
    np.testing.assert_allclose(turned, distort(directions, lens) @ turn.T, atol=1e-12)
