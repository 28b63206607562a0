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


"""The depth comparison of the body-part forest, written from its equation."""

import math

import numpy as np
from lsc_pose_experiments.depth_comparisons import BEYOND

from lsc_pose_ros.data_types.camera import Intrinsics


def comparison_twin(
    depth: np.ndarray, row: int, column: int, split: np.ndarray, camera: Intrinsics
) -> float:
    """Shotton et al., eq. 1."""
    fx, fy = camera.fx, camera.fy

    def probe(right: float, down: float) -> float:
        z = float(depth[row, column])
        i, j = math.floor(row + down * fy / z + 0.5), math.floor(column + right * fx / z + 0.5)
        inside = 0 <= i < depth.shape[0] and 0 <= j < depth.shape[1]
        return float(depth[i, j]) if inside and depth[i, j] > 0 else float(BEYOND)

    return probe(*split[:2]) - probe(*split[2:4])
