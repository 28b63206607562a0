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

"""Upright images, and joints back in the frame of the camera."""

import numpy as np
import pytest
from rolled_frame import ROLLS, rolled

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.camera.roll import in_camera_frame, upright, upright_camera
from lsc_pose_ros.data_types.camera import RATIONAL_POLYNOMIAL, Intrinsics, Lens
from lsc_pose_ros.data_types.frame import Frame


@pytest.mark.parametrize('roll', ROLLS)
def test_upright_frame_is_that_of_the_upright_camera(
    simple_frames: list[Frame], roll: int
) -> None:
    original = simple_frames[3]
    found = upright(rolled(original, roll), roll)
    assert found.roll == roll
    np.testing.assert_array_equal(found.depth, original.depth)
    np.testing.assert_array_equal(found.labels, original.labels)
    assert found.depth.flags.c_contiguous
    assert found.labels.flags.c_contiguous
    assert found.camera == original.camera
    np.testing.assert_array_equal(found.ground_truth.positions, original.ground_truth.positions)


@pytest.mark.parametrize('roll', ROLLS)
def test_joints_go_back_into_the_frame_of_the_camera(
    simple_frames: list[Frame], roll: int
) -> None:
    taken = rolled(simple_frames[3], roll)
    found = in_camera_frame(upright(taken, roll).ground_truth, roll)
    np.testing.assert_array_equal(found.positions, taken.ground_truth.positions)


@pytest.mark.parametrize(
    ('roll', 'head'), [(0, (31, 10)), (90, (10, 31)), (180, (31, 37)), (270, (37, 31))]
)
def test_heads_point_where_the_documentation_says(roll: int, head: tuple[int, int]) -> None:
    depth = np.zeros((48, 63), np.float32)
    depth[10, 31] = 2.0  # the head, above the middle
    depth[11:40, 31] = 3.0
    labels = np.where(depth > 0, 1, -1).astype(np.int32)
    frame = Frame(0, '', depth, labels, Intrinsics(60.0, 60.0, 31.0, 23.5), None)
    taken = rolled(frame, roll)
    row, column = np.argwhere(taken.depth == 2.0)[0]
    assert (column, row) == head


@pytest.mark.parametrize('roll', ROLLS)
@pytest.mark.parametrize(
    'lens', [None, Lens(RATIONAL_POLYNOMIAL, (0.5, -0.3, 0.01, -0.02, 0.1, 0.8, -0.1, 0.02))]
)
def test_turned_points_are_projected_to_turned_pixels(roll: int, lens: Lens | None) -> None:
    height, width = 480, 640
    camera = Intrinsics(500.0, 510.0, 310.0, 250.0, lens)
    points = np.random.default_rng(0).uniform((-1, -1, 2), (1, 1, 4), (50, 3))
    column, row = project(points, camera).T
    x, y, z = points.T
    turned, pixels = {
        0: ((x, y, z), (column, row)),
        90: ((-y, x, z), (height - 1 - row, column)),
        180: ((-x, -y, z), (width - 1 - column, height - 1 - row)),
        270: ((y, -x, z), (row, width - 1 - column)),
    }[roll]
    found = project(np.stack(turned, axis=1), upright_camera(camera, height, width, roll))
    np.testing.assert_allclose(found, np.stack(pixels, axis=1), atol=1e-2)
