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

"""The tree of coordinate frames that /tf and /tf_static describe."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.rotation import rotation_matrix

# Deeper trees are cycles.
_DEEPEST = 100


class Rotation(NamedTuple):
    """A unit quaternion."""

    x: float
    y: float
    z: float
    w: float


class FrameTransform(NamedTuple):
    """The rotation of a child frame in its parent frame.

    Attributes:
        parent: the name of the parent frame.
        child: the name of the child frame.
        rotation: turns vectors of the child frame into the parent frame.
    """

    parent: str
    child: str
    rotation: Rotation


class TransformTree:
    """The latest rotation of each frame in its parent.

    Attributes:
        version: counts the changes.
    """

    def __init__(self) -> None:
        """Start with no frames."""
        self._transforms: dict[str, FrameTransform] = {}
        self.version = 0

    def add(self, transform: FrameTransform) -> None:
        """Add a transform, or replace the one of the same child."""
        transform = FrameTransform(
            transform.parent.lstrip('/'), transform.child.lstrip('/'), transform.rotation
        )
        if self._transforms.get(transform.child) != transform:
            self._transforms[transform.child] = transform
            self.version += 1

    def ancestors(self, frame: str) -> Iterator[tuple[str, NDArray[np.float64]]]:
        """Yield each ancestor of a frame, the nearest first, and the frame's rotation in it.

        The rotation has the shape (3, 3) and turns vectors of `frame` into the ancestor.
        """
        rotation = np.eye(3)
        frame = frame.lstrip('/')
        for _ in range(_DEEPEST):
            transform = self._transforms.get(frame)
            if transform is None:
                return
            rotation = rotation_matrix(transform.rotation) @ rotation
            frame = transform.parent
            yield frame, rotation
