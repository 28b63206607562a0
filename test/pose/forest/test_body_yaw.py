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

"""The body yaw as an angle and as two quantised features."""

import math

import numpy as np
import pytest

from lsc_pose_ros.pose.forest.body_yaw import (
    BODY_YAW_SIZE,
    body_yaw_of,
    body_yaw_quantised,
    body_yaws_around,
    with_body_yaw,
)

FEATURES = 12


def apart(one: float, two: float) -> float:
    """Return the angle between two directions, radians."""
    return abs(math.remainder(one - two, 2 * math.pi))


@pytest.mark.parametrize('count', [1, 2, 3, 8, 12])
def test_body_yaws_are_evenly_spaced_on_the_circle(count: int) -> None:
    directions = body_yaws_around(count)
    assert directions.dtype == np.float64
    assert len(directions) == count
    for one, two in zip(directions, np.roll(directions, -1), strict=True):
        assert math.remainder(two - one - 2 * math.pi / count, 2 * math.pi) == pytest.approx(0)
    np.testing.assert_array_less(-np.pi, directions)
    np.testing.assert_array_less(directions, np.pi)
    # To the left as often as to the right, and an even number knows neither before nor behind.
    np.testing.assert_allclose(np.sort(-directions), directions, atol=1e-12)


@pytest.mark.parametrize(
    ('across', 'degrees'),
    [
        ((0.4, 0, 0), 0),  # the left shoulder is at image right: towards the camera
        ((0, 0, 0.4), 90),  # it is farther away: to image right
        ((0, 0, -0.4), -90),
        ((-0.4, 0, 0), 180),
        ((3, -7, 3), 45),  # how high a shoulder is does not count, nor how wide they are
        ((-1, 2, -1), -135),
    ],
)
def test_body_yaw_by_the_line_from_right_to_left(
    across: tuple[float, float, float], degrees: float
) -> None:
    assert apart(float(body_yaw_of(np.array(across))), math.radians(degrees)) < 1e-9


def test_body_yaw_of_several_people_and_of_unknown_ones() -> None:
    lines = np.zeros((2, 5, 3), np.float32)
    lines[..., 0] = 1
    lines[1, 3, 2] = np.nan
    found = body_yaw_of(lines)
    assert found.shape == (2, 5)
    assert np.isnan(found[1, 3])
    assert np.isnan(found).sum() == 1


def test_quantised_body_yaws_are_distinct() -> None:
    angles = np.linspace(-np.pi, np.pi, 721)
    quantised = body_yaw_quantised(angles)
    assert quantised.dtype == np.uint8
    assert quantised.shape == (721, BODY_YAW_SIZE)
    told = np.arctan2(*(quantised.T[::-1] - 127.5))
    assert np.abs(np.angle(np.exp(1j * (told - angles)))).max() < np.radians(0.5)
    np.testing.assert_allclose(quantised[0], quantised[-1], atol=1)
    np.testing.assert_array_equal(
        body_yaw_quantised(angles[100:110] + 2 * np.pi), quantised[100:110]
    )


@pytest.mark.parametrize('points', [0, 1, 9])
def test_body_yaw_is_appended_to_each_descriptor(points: int) -> None:
    quantised = np.random.default_rng(points).integers(0, 256, (points, FEATURES)).astype(np.uint8)
    joined = with_body_yaw(quantised, -2.0)
    assert joined.dtype == np.uint8
    assert joined.flags.c_contiguous
    np.testing.assert_array_equal(joined[:, :FEATURES], quantised)
    cosine, sine = 127.5 + 127 * math.cos(-2.0), 127.5 + 127 * math.sin(-2.0)
    assert joined[:, FEATURES:].tolist() == [[round(cosine), round(sine)]] * points
