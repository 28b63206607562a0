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

"""A body with holes, steps and a ragged rim, a difficult case for silhouettes."""

import numpy as np

from lsc_pose_ros.data_types.frame import NO_BODY


def ragged_body(seed: int, shape: tuple[int, int] = (40, 60)) -> tuple[np.ndarray, np.ndarray]:
    """Return the depth of body 3, with holes and steps, and its labels."""
    rng = np.random.default_rng(seed)
    depth = rng.choice([2.0, 2.03, 2.2, 3.0], shape) + rng.normal(0, 0.01, shape)
    depth[rng.random(shape) < 0.1] = 0
    labels = np.where(rng.random(shape) < 0.7, 3, NO_BODY).astype(np.int32)
    return depth.astype(np.float32), labels
