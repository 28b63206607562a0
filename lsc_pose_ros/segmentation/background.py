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

"""Bodies before a scene that was seen empty, for users who have no mask."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.segmentation.blobs import BARRIER, body_sized, find_blobs, label_bodies

_MOST_IMAGES = 15


class Background:
    """Learns the empty scene, then takes what is nearer than it.

    During the first seconds nobody should be in view: each pixel's median depth is the scene.
    Afterwards pixels nearer than the scene by a margin fall into blobs, connected in space; those
    of the size of a body are the bodies 1, 2, ..., the largest first.
    """

    def __init__(self, seconds: float, margin: float, range_min: float, range_max: float) -> None:
        """Prepare; learning begins with the first image.

        Args:
            seconds: how long the empty scene is learnt, by the stamps of the images.
            margin: metres by which a body must be nearer than the scene.
            range_min: metres; what is nearer is no body.
            range_max: metres; what is farther is no body.
        """
        self._duration = round(seconds * 1e9)
        self._margin = margin
        self._range = range_min, range_max
        self._begin = 0
        self._seen: list[NDArray[np.float32]] = []
        self._scene: NDArray[np.float32] | None = None

    @property
    def ready(self) -> bool:
        """Whether the scene is learnt; before that nobody is found."""
        return self._scene is not None

    def learn(self, stamp: int, depth: NDArray[np.float32]) -> None:
        """Look at an image of the empty scene; once the scene is learnt, nothing changes it.

        But images of another size begin another scene.

        Args:
            stamp: nanoseconds.
            depth: metres, 0 where the sensor saw nothing, shape (H, W).
        """
        if self._scene is not None and self._scene.shape != depth.shape:
            self._scene = None
        if self._scene is not None:
            return
        if not self._seen or self._seen[0].shape != depth.shape or stamp < self._begin:
            self._begin = stamp
            self._seen = []
        elapsed = stamp - self._begin
        # At most so many images, spread evenly: more need memory and tell little.
        if len(self._seen) * self._duration <= elapsed * (_MOST_IMAGES - 1):
            self._seen.append(depth.copy())
        if elapsed >= self._duration:
            self._scene = empty_scene(np.stack(self._seen))
            self._seen = []

    def labels(self, depth: NDArray[np.float32], camera: Intrinsics) -> NDArray[np.int32]:
        """Return the number of the body that each pixel shows, NO_BODY for none, shape (H, W).

        Args:
            depth: metres, 0 where the sensor saw nothing, shape (H, W).
            camera: the intrinsics.
        """
        if self._scene is None or self._scene.shape != depth.shape:
            return np.full(depth.shape, NO_BODY, np.int32)
        nearest, farthest = self._range
        before = before_scene(depth, self._scene, self._margin, nearest, farthest)
        blobs = find_blobs(before, camera)
        bodies = body_sized(blobs)
        return label_bodies(blobs, bodies[np.argsort(-blobs.area[bodies], kind='stable')])


@kernel
def empty_scene(images: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return each pixel's median depth, shape (H, W), infinity where it never has one.

    Of an even number the smaller one in the middle is taken: it is a depth that was seen.

    Args:
        images: metres, 0 where the sensor saw nothing, shape (N, H, W).
    """
    count, height, width = images.shape
    scene = np.full((height, width), np.inf, np.float32)
    seen = np.empty(count, np.float32)
    for row in range(height):
        for column in range(width):
            known = 0
            for index in range(count):
                z = images[index, row, column]
                if z > 0:
                    place = known
                    while place > 0 and seen[place - 1] > z:
                        seen[place] = seen[place - 1]
                        place -= 1
                    seen[place] = z
                    known += 1
            if known > 0:
                scene[row, column] = seen[(known - 1) // 2]
    return scene


@kernel
def before_scene(
    depth: NDArray[np.float32],
    scene: NDArray[np.float32],
    margin: float,
    nearest: float,
    farthest: float,
) -> NDArray[np.float32]:
    """Return a depth image, shape (H, W), with a BARRIER at what is the scene's or out of range.

    Args:
        depth: metres, 0 where the sensor saw nothing, shape (H, W).
        scene: metres, infinity where the empty scene has no depth, shape (H, W).
        margin: metres by which a body is nearer than the scene, at least.
        nearest: metres; what is nearer is no body.
        farthest: metres; what is farther is no body.
    """
    height, width = depth.shape
    kept = np.empty((height, width), np.float32)
    for row in range(height):
        for column in range(width):
            z = depth[row, column]
            body = nearest <= z <= farthest and z <= scene[row, column] - margin
            kept[row, column] = z if body or not z > 0 else BARRIER
    return kept
