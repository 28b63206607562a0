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

"""The table of the rays of an image."""

import numpy as np
import pytest

from lsc_pose_ros.camera.projection import back_project
from lsc_pose_ros.camera.rays import image_rays
from lsc_pose_ros.data_types.camera import EQUIDISTANT, RATIONAL_POLYNOMIAL, Intrinsics, Lens

CAMERAS = (
    Intrinsics(300.0, 305.0, 31.0, 22.0),
    Intrinsics(60.0, 62.0, 31.0, 22.0, Lens(RATIONAL_POLYNOMIAL, (0.5, -0.3, 0.01, -0.02))),
    Intrinsics(40.0, 41.0, 33.0, 25.0, Lens(EQUIDISTANT, (0.01,))),
)
HEIGHT, WIDTH = 48, 64


@pytest.mark.parametrize('camera', CAMERAS)
def test_rays_are_those_of_the_pixels_and_of_a_margin(camera: Intrinsics) -> None:
    rays = image_rays(camera, HEIGHT, WIDTH)
    rows, columns = np.mgrid[-1 : HEIGHT + 1, -1 : WIDTH + 1]
    expected = back_project(columns, rows, np.ones(rows.shape), camera)
    np.testing.assert_allclose(np.stack([rays.right, rays.down], -1), expected[..., :2], atol=1e-6)


@pytest.mark.parametrize('camera', CAMERAS)
def test_area_is_that_of_a_pixel_at_one_metre(camera: Intrinsics) -> None:
    area = image_rays(camera, HEIGHT, WIDTH).area[1:-1, 1:-1]
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]

    def corner(right: float, down: float) -> np.ndarray:
        at = columns + right, rows + down
        return back_project(*at, np.ones(rows.shape), camera)[..., :2].astype(float)

    first = corner(0.5, 0.5) - corner(-0.5, -0.5)
    second = corner(-0.5, 0.5) - corner(0.5, -0.5)
    expected = 0.5 * (first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0])
    np.testing.assert_allclose(area, expected, rtol=0.02)


def test_table_of_a_camera_is_computed_once() -> None:
    camera = CAMERAS[1]
    assert image_rays(camera, HEIGHT, WIDTH) is image_rays(camera, HEIGHT, WIDTH)
