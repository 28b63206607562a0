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

"""The body nearest to the camera, for users who have no mask."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.segmentation.background_planes import room_planes, without_planes
from lsc_pose_ros.segmentation.blobs import body_sized, find_blobs, label_bodies


class NearestBody:
    """Takes the nearest blob that has the size of a body.

    Floor, walls and ceiling are found as large planes with nothing behind them and are taken
    away, so that feet on the floor or a hand on the wall do not join the body to the room. What
    is left falls into blobs, connected in space; the nearest of those that have the size of a
    body is body 1. A piece of furniture of that size, nearer than the person, is taken for one.
    """

    ready = True

    def __init__(self, range_min: float, range_max: float) -> None:
        """Prepare.

        Args:
            range_min: metres; what is nearer is no body.
            range_max: metres; what is farther is no body.
        """
        self._range = range_min, range_max

    def learn(self, stamp: int, depth: NDArray[np.float32]) -> None:
        """Learn nothing: each image stands for itself."""

    def labels(self, depth: NDArray[np.float32], camera: Intrinsics) -> NDArray[np.int32]:
        """Return 1 where the nearest body is, NO_BODY elsewhere, shape (H, W).

        Args:
            depth: metres, 0 where the sensor saw nothing, shape (H, W).
            camera: the intrinsics.
        """
        nearest, farthest = self._range
        planes = room_planes(depth, camera)
        blobs = find_blobs(without_planes(depth, planes, camera, nearest, farthest), camera)
        bodies = body_sized(blobs)
        return label_bodies(blobs, bodies[np.argsort(blobs.depth[bodies], kind='stable')][:1])
