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

"""Skeletons as TF frames, named and laid out as REP-155 says."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.body_frame import body_frame, quaternion
from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.data_types.skeletons import Skeletons

_NO_ROTATION = (0.0, 0.0, 0.0, 1.0)


class Transform(NamedTuple):
    """One frame within another.

    Attributes:
        parent: the name of the other frame.
        child: the name of the frame.
        translation: its origin, metres.
        rotation: its axes, a unit quaternion (x, y, z, w).
    """

    parent: str
    child: str
    translation: tuple[float, ...]
    rotation: tuple[float, ...]


def skeleton_transforms(
    skeletons: Skeletons, frame_id: str, minimum_confidence: float = 0.0
) -> list[Transform]:
    """Return the frames of all bodies: `body_<number>` and, in it, one for each joint.

    The body's frame lies midway between the hips, x forward, z towards the head; the joints'
    frames have its axes. The joints of a body whose hips are unknown lie in the camera's frame.

    Args:
        skeletons: the bodies.
        frame_id: the camera's optical frame.
        minimum_confidence: joints below it are left out, as are those that are NaN.
    """
    names = names_of(skeletons.joints)
    transforms: list[Transform] = []
    for row, body in enumerate(skeletons.bodies.tolist()):
        sure = skeletons.confidence[row] >= minimum_confidence
        positions = np.where(sure[:, None], skeletons.positions[row], np.float32(np.nan))
        parent, places = frame_id, positions.astype(np.float64)
        frame = body_frame(skeletons.joints, positions)
        if frame is not None:
            parent, places = f'body_{body}', frame.inside(positions)
            transforms.append(
                Transform(
                    frame_id, parent, _numbers(frame.origin), _numbers(quaternion(frame.axes))
                )
            )
        transforms += [
            Transform(parent, f'{name}_{body}', _numbers(place), _NO_ROTATION)
            for name, place in zip(names, places, strict=True)
            if np.isfinite(place).all()
        ]
    return transforms


def _numbers(values: NDArray[np.float64]) -> tuple[float, ...]:
    return tuple(values.tolist())
