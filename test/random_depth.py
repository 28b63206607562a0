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

"""Depth images of noise."""

import numpy as np


def random_depth(seed: int, height: int = 30, width: int = 41) -> np.ndarray:
    """Return depth with all values that cameras send for "unknown"."""
    rng = np.random.default_rng(seed)
    depth = rng.uniform(0.3, 7.0, (height, width)).astype(np.float32)
    for value in (0.0, np.nan, np.inf, -np.inf, np.finfo(np.float32).max, -1.0, 1e-30):
        depth[rng.random(depth.shape) < 0.05] = value
    return depth
