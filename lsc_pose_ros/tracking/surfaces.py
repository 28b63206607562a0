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

"""Where the visible surfaces of the bodies in an image are, and how large they are."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.rays import ImageRays, image_rays
from lsc_pose_ros.data_types.image_arguments import ImageArguments
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.estimator import bodies_in


class Surface(NamedTuple):
    """The visible surface of a body.

    Attributes:
        place: its mean, metres, shape (3,).
        area: as seen from the camera, square metres.
    """

    place: NDArray[np.float64]
    area: float


def surfaces_of(images: ImageArguments) -> dict[int, Surface]:
    """Return the visible surface of each body by the body's number, those without depth left out.

    Args:
        images: depth, labels and camera.

    Raises:
        InputError: a number is larger than any body's.
    """
    depth, labels, camera = images
    numbers = bodies_in(labels).astype(np.int32)
    sums = sum_points(depth, labels, image_rays(camera, *depth.shape), numbers)
    pixel = 1 / (camera.fx * camera.fy)  # its area at a depth of one metre
    return {
        int(number): Surface(row[:3] / row[4], float(row[3] * pixel))
        for number, row in zip(numbers, sums, strict=True)
        if row[4] > 0
    }


@kernel
def sum_points(
    depth: NDArray[np.float32],
    labels: NDArray[np.int32],
    rays: ImageRays,
    numbers: NDArray[np.int32],
) -> NDArray[np.float64]:
    """Return the sums of x, y, z, z^2 and 1 over the points of each body, shape (B, 5).

    Args:
        depth: metres, 0 or not finite if unknown, shape (H, W).
        labels: the body number of each pixel, shape (H, W).
        rays: of the pixels.
        numbers: of the bodies, ascending, shape (B,).
    """
    sums = np.zeros((numbers.shape[0], 5))
    for row in range(depth.shape[0]):
        for column in range(depth.shape[1]):
            z = depth[row, column]
            if labels[row, column] < 0 or not 0 < z < np.inf:
                continue
            body = np.searchsorted(numbers, labels[row, column])
            sums[body, 0] += z * rays.right[row + 1, column + 1]
            sums[body, 1] += z * rays.down[row + 1, column + 1]
            sums[body, 2] += z
            sums[body, 3] += z * z
            sums[body, 4] += 1
    return sums
