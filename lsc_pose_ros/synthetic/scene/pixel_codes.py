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

"""One number per pixel for the body that it shows and the part of that body.

Renderer and sensors move such codes about like labels; afterwards they are split.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.numerics.jit import exact_kernel
from lsc_pose_ros.synthetic.body.skin_parts import NO_PART

_PARTS = 32
"""Codes per body; more than the parts of a body."""


def pixel_codes(body: int, parts: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return the codes of a body's parts, of the shape of `parts`."""
    return np.int32(_PARTS * body) + parts


def split_codes(codes: NDArray[np.int32]) -> tuple[NDArray[np.int32], NDArray[np.uint8]]:
    """Return the body of each pixel or NO_BODY, and its part or NO_PART."""
    labels = np.empty(codes.shape, np.int32)
    parts = np.empty(codes.shape, np.uint8)
    split_into(codes, labels, parts)
    return labels, parts


@exact_kernel
def split_into(
    codes: NDArray[np.int32], labels: NDArray[np.int32], parts: NDArray[np.uint8]
) -> None:
    """Fill `labels` and `parts`."""
    height, width = codes.shape
    for row in range(height):
        for column in range(width):
            code = codes[row, column]
            if code == NO_BODY:
                labels[row, column] = NO_BODY
                parts[row, column] = NO_PART
            else:
                labels[row, column] = code // _PARTS
                parts[row, column] = code % _PARTS
