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

"""Rotation matrices of quaternions."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def rotation_matrix(quaternion: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation matrix, shape (3, 3), of a quaternion (x, y, z, w).

    It need not have unit length. One without a length, or with numbers that are not finite, gives
    the identity.
    """
    x, y, z, w = (float(each) for each in quaternion)
    square = x * x + y * y + z * z + w * w
    if not square > 0 or not np.isfinite(square):
        return np.eye(3)
    scale = 2 / square
    return np.array(
        [
            [1 - scale * (y * y + z * z), scale * (x * y - z * w), scale * (x * z + y * w)],
            [scale * (x * y + z * w), 1 - scale * (x * x + z * z), scale * (y * z - x * w)],
            [scale * (x * z - y * w), scale * (y * z + x * w), 1 - scale * (x * x + y * y)],
        ]
    )
