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

"""Finds the body nearest to the camera, for depth images without masks."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.rays import image_rays
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.segmentation.background_planes import find_background_planes, remove_planes
from lsc_pose_ros.segmentation.blobs import body_sized, find_blobs, label_bodies


class NearestBody:
    """Finds the nearest blob of the size of a body.

    Floor, walls and ceiling are found as large planes with nothing behind them, and removed, so
    that feet on the floor or a hand on the wall do not connect the body to the room. The other
    pixels form blobs that are connected in space. The nearest blob of the size of a body is body
    1. Furniture of this size in front of the person is mistaken for a body.
    """

    ready = True
    warning = ''

    def __init__(self, range_min: float, range_max: float) -> None:
        """Store the range.

        Args:
            range_min: metres; nearer pixels are no body.
            range_max: metres; farther pixels are no body.
        """
        self._range = range_min, range_max

    def learn(self, stamp: int, depth: NDArray[np.float32]) -> None:
        """Do nothing: images are independent."""

    def labels(self, depth: NDArray[np.float32], camera: Intrinsics) -> NDArray[np.int32]:
        """Return 1 at the pixels of the nearest body, else NO_BODY, shape (H, W).

        Args:
            depth: metres, 0 if unknown, shape (H, W).
            camera: the intrinsics.
        """
        nearest, farthest = self._range
        planes = find_background_planes(depth, camera)
        rays = image_rays(camera, *depth.shape)
        blobs = find_blobs(remove_planes(depth, planes, rays, nearest, farthest), camera)
        bodies = body_sized(blobs)
        return label_bodies(blobs, bodies[np.argsort(blobs.depth[bodies], kind='stable')][:1])
