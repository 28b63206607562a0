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

"""Tests the filters of stereo cameras' drivers: holes are filled, edges become ramps."""

import math

import numpy as np
import pytest

from lsc_pose_ros.synthetic.sensors.disparity_filters import (
    fill_holes,
    smooth,
    smooth_line,
    smoothing_factor,
)


@pytest.mark.parametrize('deviation', [1.0, 3.0, 6.5])
def test_response_has_the_given_deviation(deviation: float) -> None:
    line = np.ones(401, np.float32)
    line[200] = 2.0
    smooth_line(line, smoothing_factor(deviation), math.inf)
    response = line.astype(np.float64) - 1
    at = np.arange(401) - 200
    assert response.sum() == pytest.approx(1.0, abs=1e-3)
    assert response @ at == pytest.approx(0.0, abs=1e-2)
    assert math.sqrt(response @ at**2) == pytest.approx(deviation, rel=0.02)


def test_no_deviation_changes_nothing() -> None:
    image = np.random.default_rng(0).uniform(0.2, 1.0, (6, 9)).astype(np.float32)
    copy = image.copy()
    smooth(copy, smoothing_factor(0.0), math.inf)
    np.testing.assert_allclose(copy, image, rtol=1e-6)


def test_edges_become_ramps_unless_they_are_kept() -> None:
    step = np.repeat(np.float32([0.3, 0.5]), 30) * np.ones((20, 1), np.float32)
    kept, ramp = step.copy(), step.copy()
    smooth(kept, smoothing_factor(4.0), 0.05)
    smooth(ramp, smoothing_factor(4.0), math.inf)
    np.testing.assert_allclose(kept, step, atol=1e-6)
    assert (np.diff(ramp[10]) >= -1e-6).all()
    between = (ramp[10] > 0.32) & (ramp[10] < 0.48)
    assert 8 <= between.sum() <= 20


def test_empty_pixels_stay_empty_and_separate_surfaces() -> None:
    line = np.float32([0.3, 0.3, 0.0, 0.5, 0.5])
    smooth_line(line, 0.2, math.inf)
    np.testing.assert_allclose(line, [0.3, 0.3, 0.0, 0.5, 0.5], rtol=1e-6)


def test_narrow_holes_are_filled_from_the_left_with_their_label() -> None:
    inverse_depth = np.float32([[0.0, 0.4, 0.0, 0.0, 0.2, 0.0]])
    labels = np.array([[-1, 1, -1, -1, -1, 2]], np.int32)
    fill_holes(inverse_depth, labels, 1)
    np.testing.assert_allclose(inverse_depth, np.float32([[0.0, 0.4, 0.4, 0.0, 0.2, 0.2]]))
    assert labels.tolist() == [[-1, 1, 1, -1, -1, -1]]
