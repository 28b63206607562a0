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

"""The body yaw as two numbers that are appended to the descriptors, so that trees split by it."""

import numpy as np
from numpy.typing import NDArray

BODY_YAW_SIZE = 2
"""How many numbers the body yaw adds to a descriptor: its cosine and its sine."""


def body_yaw_of(across: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the body yaw, radians, shape (...): 0 facing the camera, +-pi facing away from it.

    Args:
        across: from the right to the left shoulder or hip in the optical frame, shape (..., 3);
            a positive yaw faces to image right.
    """
    line = np.asarray(across, np.float64)
    body_yaw: NDArray[np.float64] = np.arctan2(line[..., 2], line[..., 0])
    return body_yaw


def body_yaws_around(count: int) -> NDArray[np.float64]:
    """Return `count` body yaws, evenly around the circle, radians, shape (count,)."""
    return (np.arange(count, dtype=np.float64) + 0.5) * (2 * np.pi / count) - np.pi


def with_body_yaw(quantised: NDArray[np.uint8], body_yaw: float) -> NDArray[np.uint8]:
    """Return descriptors, shape (Q, F), with the body yaw appended, shape (Q, F + 2)."""
    joined = np.empty((len(quantised), quantised.shape[1] + BODY_YAW_SIZE), np.uint8)
    joined[:, :-BODY_YAW_SIZE] = quantised
    joined[:, -BODY_YAW_SIZE:] = body_yaw_quantised(np.array([body_yaw]))[0]
    return joined


def body_yaw_quantised(body_yaw: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return cosine and sine of body yaws, radians, shape (P,), quantised, shape (P, 2)."""
    pair = np.stack([np.cos(body_yaw), np.sin(body_yaw)], axis=1)
    return np.rint(127.5 + 127.0 * pair).astype(np.uint8)
