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
"""Depth images as pictures for the page."""

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image

DARKEST, BRIGHTEST = 40, 255
"""The grey of the farthest and of the nearest surface; 0 is unknown depth."""

_ENDS = 1.0, 99.0  # percentiles


def depth_picture(depth: NDArray[np.float32]) -> bytes:
    """Return a PNG picture in which near surfaces are bright.

    Args:
        depth: metres, 0 or not finite if unknown, shape (H, W).
    """
    known = np.isfinite(depth) & (depth > 0)
    grey = np.zeros(depth.shape, np.uint8)
    if known.any():
        near, far = np.percentile(depth[known], _ENDS)
        share = np.clip((depth[known] - near) / max(float(far - near), 1e-6), 0, 1)
        grey[known] = np.rint(BRIGHTEST - share * (BRIGHTEST - DARKEST)).astype(np.uint8)
    stream = io.BytesIO()
    Image.fromarray(grey).save(stream, 'png')
    return stream.getvalue()
