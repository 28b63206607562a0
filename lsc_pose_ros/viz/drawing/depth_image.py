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

"""A depth image in grey: the bodies clear, their surroundings faint."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.viz.drawing.canvas import hide_axes
from lsc_pose_ros.viz.drawing.colours import BORDER
from lsc_pose_ros.viz.drawing.crop import Box, look_at

# Greys from 0, black, to 1, white; light, for contrast with skeletons.
_NEAR, _FAR = 0.88, 0.50
_NEAR_FAINT, _FAR_FAINT = 0.90, 0.98


def draw_depth(axes: Axes, frame: Frame, box: Box, *, body: int | None = None) -> None:
    """Draw the part `box` of the depth image; only `body`, or all bodies, are clear."""
    hide_axes(axes)
    axes.imshow(greys(frame, body), cmap='gray', vmin=0, vmax=1)
    # What is beyond the image explains why a body is cut off there.
    axes.set_facecolor(BORDER)
    look_at(axes, box)


def greys(frame: Frame, body: int | None = None) -> NDArray[np.float32]:
    """Return the depth image as greys from 0 to 1, shape (H, W): nearer is lighter.

    Args:
        frame: the image.
        body: the body that is clear; None for all.
    """
    measured = frame.depth > 0
    clear = measured & (frame.labels >= 0 if body is None else frame.labels == body)
    if not (frame.labels >= 0).any():
        clear = measured  # without a mask the whole scene is clear
    image = np.ones(frame.depth.shape, np.float32)
    for where, near, far in ((measured & ~clear, _NEAR_FAINT, _FAR_FAINT), (clear, _NEAR, _FAR)):
        image[where] = near + (far - near) * _relative(frame.depth[where])
    return image


def _relative(depth: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return depths scaled from the nearest, 0, to the farthest, 1; outliers are clipped."""
    if len(depth) == 0:
        return depth
    near, far = np.percentile(depth, [1, 99])
    relative: NDArray[np.float32] = np.clip((depth - near) / max(far - near, 1e-6), 0, 1)
    return relative.astype(np.float32)
