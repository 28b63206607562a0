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

"""Projection and back-projection, with and without a lens."""

import numpy as np
import pytest

from lsc_pose_ros.camera.projection import back_project, project
from lsc_pose_ros.data_types.camera import RATIONAL_POLYNOMIAL, Intrinsics, Lens

LENS = Lens(RATIONAL_POLYNOMIAL, (0.5, -0.3, 0.01, -0.02, 0.1, 0.8, -0.1, 0.02))


@pytest.mark.parametrize('lens', [None, LENS])
def test_projection_is_the_inverse_of_back_projection(lens: Lens | None) -> None:
    camera = Intrinsics(500.0, 510.0, 320.0, 240.0, lens)
    rng = np.random.default_rng(0)
    columns, rows = rng.uniform(0, 640, 50), rng.uniform(0, 480, 50)
    points = back_project(columns, rows, rng.uniform(0.5, 5, 50), camera)
    np.testing.assert_allclose(project(points, camera), np.stack([columns, rows], 1), atol=1e-2)


def test_x_is_right_and_y_is_down() -> None:
    camera = Intrinsics(500.0, 500.0, 320.0, 240.0)
    x, y, z = back_project(np.array(820.0), np.array(740.0), np.array(2.0), camera)
    assert (x, y, z) == (2.0, 2.0, 2.0)


def test_point_behind_the_camera_has_no_pixel() -> None:
    points = np.array([[0, 0, -1], [0, 0, 0]], np.float32)
    assert np.isnan(project(points, Intrinsics(1.0, 1.0, 0.0, 0.0))).all()
