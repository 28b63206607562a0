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

"""Ground truth for the visibility of joints: each body alone is compared with the whole image."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.data_types.visibility import HIDDEN, HIDDEN_BY_BODY, OUTSIDE, SEEN
from lsc_pose_ros.numerics.jit import exact_kernel
from lsc_pose_ros.synthetic.scene.depth_image import DepthImage
from lsc_pose_ros.synthetic.scene.framing import Margins

_RADII = {
    'head': 0.11, 'neck': 0.09, 'torso': 0.14, 'pelvis': 0.13, 'shoulder': 0.1, 'elbow': 0.08,
    'wrist': 0.06, 'hand': 0.08, 'hip': 0.12, 'knee': 0.1, 'ankle': 0.08, 'foot': 0.1,
}  # fmt: skip
JOINT_RADII = np.array(
    [_RADII[name.removeprefix('l_').removeprefix('r_')] for name in JOINT_NAMES]
)
"""The distance up to which the skin counts as near each joint, metres, shape (20,)."""

LEAST_OWN = 0.1
"""A joint is hidden by the body if its part covers less of the circle around it."""

LEAST_SEEN = 0.3
"""A joint is hidden if the image shows less of what the body alone shows of its part."""


def joint_visibility(
    joints: NDArray[np.float64],
    codes: NDArray[np.int32],
    alone: DepthImage,
    image: DepthImage,
    camera: Intrinsics,
    margins: Margins,
) -> NDArray[np.uint8]:
    """Return the visibility of each joint of one body: SEEN, HIDDEN_BY_BODY, HIDDEN or OUTSIDE.

    Args:
        joints: in the optical frame, metres, shape (J, 3).
        codes: the codes of the pixels of each joint's part, ascending, shape (J,).
        alone: the body alone, without noise; its labels are codes.
        image: the whole image as measured; its labels are codes.
        camera: the intrinsics.
        margins: where the sensor measures nothing.
    """
    visibility = np.empty(len(joints), np.uint8)
    height, width = image.depth.shape
    for number, (x, y, z) in enumerate(joints.tolist()):
        if z <= 0:
            visibility[number] = OUTSIDE
            continue
        column, row = camera.cx + camera.fx * x / z, camera.cy + camera.fy * y / z
        if not (
            margins.left <= column + 0.5 < width - margins.right
            and margins.top <= row + 0.5 < height - margins.bottom
        ):
            visibility[number] = OUTSIDE
            continue
        radius = max(JOINT_RADII[number] * camera.fx / z, 1.0)
        body = (int(codes[0]), int(codes[-1]))
        visibility[number] = what_hides(
            alone.labels, image.labels, codes[number], body, (row, column), radius
        )
    return visibility


@exact_kernel
def what_hides(
    alone: NDArray[np.int32],
    image: NDArray[np.int32],
    code: int,
    body: tuple[int, int],
    middle: tuple[float, float],
    radius: float,
) -> int:
    """Return SEEN, HIDDEN_BY_BODY or HIDDEN for a joint in the image.

    Args:
        alone: the codes of the body alone, shape (H, W).
        image: the codes of the whole image, shape (H, W).
        code: of the joint's part.
        body: the lowest and the highest code of the body.
        middle: row and column of the joint.
        radius: of the circle around it, pixels.
    """
    height, width = alone.shape
    circle, own, own_seen, any_part, any_seen = 0, 0, 0, 0, 0
    first, last = int(np.ceil(middle[0] - radius)), int(np.floor(middle[0] + radius))
    left, right = int(np.ceil(middle[1] - radius)), int(np.floor(middle[1] + radius))
    for row in range(max(first, 0), min(last, height - 1) + 1):
        for column in range(max(left, 0), min(right, width - 1) + 1):
            if (row - middle[0]) ** 2 + (column - middle[1]) ** 2 > radius * radius:
                continue
            circle += 1
            by_body = body[0] <= alone[row, column] <= body[1]
            seen = body[0] <= image[row, column] <= body[1]
            any_part += by_body
            any_seen += by_body and seen
            own += alone[row, column] == code
            own_seen += alone[row, column] == code and image[row, column] == code
    if own >= LEAST_OWN * circle:
        return SEEN if own_seen >= LEAST_SEEN * own else HIDDEN
    return HIDDEN_BY_BODY if any_seen >= LEAST_SEEN * any_part else HIDDEN
