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

"""The window of one body: cut out, corrected, and with its cuts marked."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.silhouette.cuts import SceneImage, background_is_measured, mark_cuts
from lsc_pose_ros.pose.silhouette.mask_fit import (
    BETTER_OUTLINE,
    labels_fitted_to_depth,
    largest_error,
    smooth_outline,
)
from lsc_pose_ros.pose.silhouette.preprocessing import Window
from lsc_pose_ros.pose.silhouette.silhouette import cut_out


def body_window(
    depth: NDArray[np.float32],
    labels: NDArray[np.int32],
    camera: Intrinsics,
    body: int,
    settings: Settings,
) -> Window | None:
    """Return the window of `body`, or None if none of its pixels has a depth.

    Args:
        depth: metres, 0 if the sensor measured nothing, shape (H, W).
        labels: the body number of each pixel, negative for none, shape (H, W).
        camera: the intrinsics.
        body: the body's number.
        settings: which holes are filled, which masks are sloppy, and what hides a body.
    """
    window = cut_out(depth, labels, body, settings.fill_holes)
    if window is None:
        return None
    image = SceneImage(depth, labels, body)
    if _is_sloppy(window, image, settings.sloppy_outline):
        window, image = _fitted_to_depth(window, image, camera, settings)
    return mark_cuts(window, image, settings.occluder_step)


def _is_sloppy(window: Window, image: SceneImage, limit: float) -> bool:
    is_speck = max(window.depth.shape) < 2 * largest_error(image)
    if limit <= 0 or is_speck or not background_is_measured(window, image):
        return False
    return smooth_outline(window, image) >= limit


def _fitted_to_depth(
    window: Window, image: SceneImage, camera: Intrinsics, settings: Settings
) -> tuple[Window, SceneImage]:
    """Return window and image with the mask fitted to the depth, or as they are.

    On a seat, or if a filter has smoothed the depth, even an exact outline is no step, and the fit
    does not make it one. Then the mask remains as it is.
    """
    labels = labels_fitted_to_depth(window, image, float(camera.fy))
    fitted = cut_out(image.depth, labels, image.body, settings.fill_holes)
    if fitted is None:
        return window, image
    new_image = image._replace(labels=labels)
    if smooth_outline(fitted, new_image) > BETTER_OUTLINE * smooth_outline(window, image):
        return window, image
    return fitted, new_image
