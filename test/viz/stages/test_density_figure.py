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

"""The integral of a density along lines of sight."""

import numpy as np
import pytest
from plain.density import density

from lsc_pose_ros.camera.projection import back_project
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.viz.stages.density_figure import line_integral


def test_line_integral_is_the_density_summed_along_the_ray() -> None:
    rng = np.random.default_rng(3)
    camera = Intrinsics(90.0, 110.0, 40.0, 30.0)
    positions = rng.normal([0.1, -0.1, 2.5], 0.15, (20, 3)).astype(np.float32)
    weights = rng.random(20).astype(np.float32)
    step = 0.002
    for column, row in ((44.0, 26.0), (20.0, 50.0)):
        ray = back_project(np.array(column), np.array(row), np.array(1.0), camera)
        ray = ray / np.linalg.norm(ray)
        along = np.arange(1, 4, step)[:, None] * ray
        summed = step * sum(
            density(position.astype(np.float32), positions, weights, 0.07) for position in along
        )
        found = line_integral(positions, weights, np.array([column, row]), camera, 0.07)
        assert found == pytest.approx(summed, rel=1e-3, abs=1e-9)
