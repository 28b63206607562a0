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

"""Finds bodies in front of a learnt background, for depth images without masks."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.rays import image_rays
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.segmentation.blobs import BARRIER, body_sized, find_blobs, label_bodies

_MOST_IMAGES = 15

# After the scene is learnt, every so many images it is checked whether something of the size of a
# body has left it; a check takes about as long as the segmentation of an image.
_CHECK_PERIOD = 15

# What has left is by so much nearer than what is behind it, at least, metres. The noise of the
# sensor and a curtain that moves are not.
_LEFT_MARGIN = 0.3

# While the scene is learnt, a depth that differs from it by so much is motion, metres, if the area
# is larger, square metres. People who stand show 0.01 to 0.2 within two seconds, empty rooms with
# the noise of a sensor less than 0.001.
_MOTION = 0.15
_MOTION_AREA = 0.01

# Farther depths are too noisy, metres.
_FARTHEST_MOTION = 5.0

_NOT_EMPTY = (
    'segmentation background: the scene was not empty while it was learnt: {}. Bodies are not '
    'found there; start again without people in view, or use segmentation nearest'
)
_MOVED = 'something moved in it, as people do'
_LEFT = 'something of the size of a person has left it'


class Background:
    """Learns the empty scene, then finds bodies in front of it.

    Nobody should be in view during the first seconds: the scene is the median depth of each
    pixel. After that, pixels that are nearer than the scene by a margin form blobs that are
    connected in space. Blobs of the size of a body are the bodies 1, 2, ..., the largest first.

    Attributes:
        warning: a sentence if the scene was not empty while it was learnt, otherwise ''.
    """

    def __init__(self, seconds: float, margin: float, range_min: float, range_max: float) -> None:
        """Store the settings; learning begins with the first image.

        Args:
            seconds: duration of learning, by the stamps of the images.
            margin: metres by which a body is nearer than the scene, at least.
            range_min: metres; nearer pixels are no body.
            range_max: metres; farther pixels are no body.
        """
        self._duration = round(seconds * 1e9)
        self._margin = margin
        self._range = range_min, range_max
        self._begin = 0
        self._seen: list[NDArray[np.float32]] = []
        self._images_since_check = 0
        self.warning = ''
        self._scene: NDArray[np.float32] | None = None

    @property
    def ready(self) -> bool:
        """Whether the scene is learnt; before that no body is found."""
        return self._scene is not None

    def learn(self, stamp: int, depth: NDArray[np.float32]) -> None:
        """Learn from an image of the empty scene; does nothing after the scene is learnt.

        An image of another size starts a new scene.

        Args:
            stamp: nanoseconds.
            depth: metres, 0 if unknown, shape (H, W).
        """
        if self._scene is not None and self._scene.shape != depth.shape:
            self._scene, self.warning = None, ''
        if self._scene is not None:
            return
        if not self._seen or self._seen[0].shape != depth.shape or stamp < self._begin:
            self._begin = stamp
            self._seen = []
        elapsed = stamp - self._begin
        # More images need memory and do not improve the median.
        if len(self._seen) * self._duration <= elapsed * (_MOST_IMAGES - 1):
            self._seen.append(depth.copy())
        if elapsed >= self._duration:
            self._scene = empty_scene(np.stack(self._seen))
            self._images_since_check = 0

    def labels(self, depth: NDArray[np.float32], camera: Intrinsics) -> NDArray[np.int32]:
        """Return the body number of each pixel, NO_BODY for none, shape (H, W).

        Args:
            depth: metres, 0 if unknown, shape (H, W).
            camera: the intrinsics.
        """
        if self._scene is None or self._scene.shape != depth.shape:
            return np.full(depth.shape, NO_BODY, np.int32)
        if not self.warning:
            self._check_scene(self._scene, depth, camera)
        nearest, farthest = self._range
        foreground = remove_scene(depth, self._scene, self._margin, nearest, farthest)
        blobs = find_blobs(foreground, camera)
        bodies = body_sized(blobs)
        return label_bodies(blobs, bodies[np.argsort(-blobs.area[bodies], kind='stable')])

    def _check_scene(
        self, scene: NDArray[np.float32], depth: NDArray[np.float32], camera: Intrinsics
    ) -> None:
        """Set the warning if the scene was not empty while it was learnt."""
        learnt_from, self._seen = self._seen, []
        if any(_moved_area(image, scene, camera) > _MOTION_AREA for image in learnt_from):
            self.warning = _NOT_EMPTY.format(_MOVED)
            return
        self._images_since_check += 1
        if self._images_since_check >= _CHECK_PERIOD:
            self._images_since_check = 0
            # What is now behind the scene was hidden by something that is gone.
            if self._shows_body_before(depth, scene, camera):
                self.warning = _NOT_EMPTY.format(_LEFT)

    def _shows_body_before(
        self, scene: NDArray[np.float32], image: NDArray[np.float32], camera: Intrinsics
    ) -> bool:
        """Return whether `image` shows something of the size of a body in front of `scene`."""
        margin = max(self._margin, _LEFT_MARGIN)
        known = np.where(scene > 0, scene, np.float32(0))
        foreground = remove_scene(image, known, margin, *self._range)
        return len(body_sized(find_blobs(foreground, camera))) > 0


def _moved_area(
    image: NDArray[np.float32], scene: NDArray[np.float32], camera: Intrinsics
) -> float:
    """Return the area in which an image and the scene differ, square metres.

    A pixel counts if all of its 3 x 3 neighbourhood differs, so that noise and edges do not.
    """
    nearer = np.minimum(image, scene)
    known = (image > 0) & np.isfinite(scene) & (np.maximum(image, scene) < _FARTHEST_MOTION)
    differs = known & (np.abs(image - np.where(known, scene, 0)) > _MOTION)
    inner = np.ones_like(differs[1:-1, 1:-1])
    height, width = inner.shape
    for i in range(3):
        for j in range(3):
            inner &= differs[i : height + i, j : width + j]
    area = image_rays(camera, *image.shape).area[2:-2, 2:-2]
    return float((area * nearer[1:-1, 1:-1] ** 2)[inner].sum())


@kernel
def empty_scene(images: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the median depth of each pixel, shape (H, W); infinity if it is always unknown.

    Of an even number of depths the lower median is taken, which is a measured depth.

    Args:
        images: metres, 0 if unknown, shape (N, H, W).
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
                    position = known
                    while position > 0 and seen[position - 1] > z:
                        seen[position] = seen[position - 1]
                        position -= 1
                    seen[position] = z
                    known += 1
            if known > 0:
                scene[row, column] = seen[(known - 1) // 2]
    return scene


@kernel
def remove_scene(
    depth: NDArray[np.float32],
    scene: NDArray[np.float32],
    margin: float,
    nearest: float,
    farthest: float,
) -> NDArray[np.float32]:
    """Return the depth image with a BARRIER at pixels of the scene or out of range, (H, W).

    Args:
        depth: metres, 0 if unknown, shape (H, W).
        scene: metres, infinity if unknown, shape (H, W).
        margin: metres by which a body is nearer than the scene, at least.
        nearest: metres; nearer pixels are no body.
        farthest: metres; farther pixels are no body.
    """
    height, width = depth.shape
    kept = np.empty((height, width), np.float32)
    for row in range(height):
        for column in range(width):
            z = depth[row, column]
            body = nearest <= z <= farthest and z <= scene[row, column] - margin
            kept[row, column] = z if body or not z > 0 else BARRIER
    return kept
