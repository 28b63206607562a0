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

"""The visible surface of each body: its place and its area."""

import itertools

import numpy as np
import pytest

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.image_arguments import check_images
from lsc_pose_ros.tracking.surfaces import surfaces_of

CAMERA = Intrinsics(60.0, 62.0, 30.0, 22.0)


def scene(*bodies: tuple[int, int, int, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return depth and labels: number, first row, first column and depth of squares."""
    depth, labels = np.zeros((45, 60), np.float32), np.full((45, 60), NO_BODY, np.int32)
    for number, row, column, z in bodies:
        depth[row : row + 12, column : column + 12] = z
        labels[row : row + 12, column : column + 12] = number
    return depth, labels


def test_the_place_of_a_body_is_the_mean_of_its_points() -> None:
    depth, labels = scene((3, 3, 6, 2.0), (700, 21, 30, 3.0))
    depth[6, 9], depth[9, 9] = np.inf, 0
    labels[30, 3] = 9  # without depth
    surfaces = surfaces_of(check_images(depth, labels, CAMERA))
    assert sorted(surfaces) == [3, 700]
    for number, (place, area) in surfaces.items():
        points = []
        for row, column in itertools.product(range(45), range(60)):
            z = float(depth[row, column])
            if labels[row, column] == number and 0 < z < np.inf:
                points.append([(column - 30) / 60 * z, (row - 22) / 62 * z, z])
        np.testing.assert_allclose(place, np.mean(points, axis=0), rtol=1e-5, atol=1e-6)
        pixels = [z * z / (60 * 62) for _, _, z in points]
        assert area == pytest.approx(sum(pixels), rel=1e-5)
