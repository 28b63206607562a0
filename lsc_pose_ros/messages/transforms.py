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

"""Computes the TF frames of skeletons, with the names and axes of REP-155."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.body_frame import body_frame, quaternion
from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.data_types.skeletons import Skeletons

_NO_ROTATION = (0.0, 0.0, 0.0, 1.0)


class Transform(NamedTuple):
    """The pose of one coordinate frame in another.

    Attributes:
        parent: the name of the parent frame.
        child: the name of the child frame.
        translation: the origin of the child frame, metres.
        rotation: the orientation of the child frame, a unit quaternion (x, y, z, w).
    """

    parent: str
    child: str
    translation: tuple[float, ...]
    rotation: tuple[float, ...]


def skeleton_transforms(
    skeletons: Skeletons,
    frame_id: str,
    minimum_confidence: float = 0.0,
    identify: Callable[[int], str] = str,
) -> list[Transform]:
    """Return the frames of all bodies: `body_<id>`, and in it one for each joint.

    The body's frame lies midway between the hips, x forward, z towards the head; the joints'
    frames have its axes. The joints of a body whose hips are unknown lie in the camera's frame.

    Args:
        skeletons: the bodies.
        frame_id: the camera's optical frame.
        minimum_confidence: joints with less confidence are left out, as are joints with NaN.
        identify: returns the id of the body with a number.
    """
    names = names_of(skeletons.joints)
    transforms: list[Transform] = []
    for number, positions in zip(
        skeletons.bodies.tolist(), confident_positions(skeletons, minimum_confidence), strict=True
    ):
        body = identify(number)
        parent, child_positions = frame_id, positions.astype(np.float64)
        frame = body_frame(skeletons.joints, positions)
        if frame is not None:
            parent, child_positions = f'body_{body}', frame.inside(positions)
            transforms.append(
                Transform(
                    frame_id, parent, _numbers(frame.origin), _numbers(quaternion(frame.axes))
                )
            )
        transforms += [
            Transform(parent, f'{name}_{body}', _numbers(position), _NO_ROTATION)
            for name, position in zip(names, child_positions, strict=True)
            if np.isfinite(position).all()
        ]
    return transforms


def confident_positions(skeletons: Skeletons, minimum_confidence: float) -> NDArray[np.float32]:
    """Return the positions of the joints, NaN if they have less confidence, shape (B, J, 3)."""
    confident = skeletons.confidence >= minimum_confidence
    return np.where(confident[..., None], skeletons.positions, np.float32(np.nan))


def _numbers(values: NDArray[np.float64]) -> tuple[float, ...]:
    return tuple(values.tolist())
