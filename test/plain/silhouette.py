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

"""The Gaussian filter of eq. 1, pixel by pixel."""

import math

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.rays import ImageRays
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.silhouette.preprocessing import Window


@kernel
def smooth(window: Window, rays: ImageRays, sigma: float) -> NDArray[np.float32]:
    """Return the window's depth after the Gaussian filter of eq. 1, shape as before.

    Each body pixel becomes the mean of the body's pixels in its 3 x 3 neighbourhood, weighted by
    exp(-s^2 / (2 sigma^2)) with s the 3-D distance of the two back-projected points.

    Args:
        window: the body; its border row and column hold no body.
        rays: the rays of the whole image.
        sigma: metres; 0 leaves the depth as it is.
    """
    depth = window.depth
    smoothed = depth.copy()
    if sigma <= 0:
        return smoothed
    scale = -0.5 / (sigma * sigma)
    for i in range(1, depth.shape[0] - 1):
        for j in range(1, depth.shape[1] - 1):
            z = depth[i, j]
            if not math.isfinite(z):
                continue
            # The rays have a margin of one pixel.
            row, column = window.row + 1 + i, window.column + 1 + j
            x, y = rays.right[row, column] * z, rays.down[row, column] * z
            total, weights = 0.0, 0.0
            for di in range(-1, 2):
                for dj in range(-1, 2):
                    other = depth[i + di, j + dj]
                    if not math.isfinite(other):
                        continue
                    dx = rays.right[row + di, column + dj] * other - x
                    dy = rays.down[row + di, column + dj] * other - y
                    dz = other - z
                    weight = math.exp(scale * (dx * dx + dy * dy + dz * dz))
                    total += weight * other
                    weights += weight
            smoothed[i, j] = total / weights
    return smoothed
