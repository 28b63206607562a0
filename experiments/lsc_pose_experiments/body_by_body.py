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

"""Estimates of one body after the other, as the skeletons of an image."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.image_arguments import ImageArguments
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.pose.estimator import bodies_in


def estimate_bodies(
    images: ImageArguments,
    joints: NDArray[np.uint16],
    estimate: Callable[[int], NDArray[np.float32] | None],
) -> Skeletons:
    """Return the joints of each body in an image, in the order of the bodies' numbers.

    Args:
        images: depth, labels and camera.
        joints: numbers of the joints, shape (J,).
        estimate: returns position, metres, and confidence of each joint of a body, shape (J, 4);
            None for a body without joints: they are NaN with confidence 0.

    Raises:
        InputError: a number is larger than any body's.
    """
    bodies = bodies_in(images.labels)
    found = np.full((len(bodies), len(joints), 4), np.nan, np.float32)
    found[..., 3] = 0
    for row, body in enumerate(bodies.tolist()):
        estimated = estimate(body)
        if estimated is not None:
            found[row] = estimated
    return Skeletons(bodies, joints, found[..., :3].copy(), np.ascontiguousarray(found[..., 3]))
