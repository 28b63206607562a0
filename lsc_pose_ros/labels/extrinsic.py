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

"""The pose of the camera in the world of another program, from a YAML file."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from lsc_pose_ros.errors import InputError, excerpt
from lsc_pose_ros.labels.limits import FARTHEST
from lsc_pose_ros.labels.transform_history import TransformHistory
from lsc_pose_ros.messages.label_messages import StampedTransform
from lsc_pose_ros.resources.yaml_tables import read_yaml

WORLD = 'world'
"""The frame of files that name none."""

_KEYS = {'parent', 'translation', 'rotation'}


class Extrinsic(NamedTuple):
    """The pose of the camera's optical frame in a parent frame.

    Attributes:
        parent: the name of the parent frame.
        translation: metres.
        rotation: a quaternion (x, y, z, w).
    """

    parent: str
    translation: tuple[float, float, float]
    rotation: tuple[float, float, float, float]

    def add_to(self, transforms: TransformHistory, camera: str) -> None:
        """Add the pose to `transforms`, in place of any pose that `camera` has there."""
        transforms.forget(camera)
        transforms.add(
            StampedTransform(0, self.parent, camera, self.translation, self.rotation), static=True
        )


def load_extrinsic(path: Path) -> Extrinsic:
    """Return the pose of the camera in a YAML file with translation, rotation and parent.

    Raises:
        InputError: the file cannot be read, or has no pose.
    """
    loaded = read_yaml(path, 'extrinsic')
    example = 'translation: [x, y, z] in metres and rotation: [x, y, z, w]'
    if not isinstance(loaded, dict) or not {'translation', 'rotation'} <= set(loaded) <= _KEYS:
        msg = f'{path} is no pose of a camera; give {example}, and optionally parent: FRAME'
        raise InputError(msg)
    try:
        translation = np.array(loaded['translation'], np.float64).reshape(3)
        rotation = np.array(loaded['rotation'], np.float64).reshape(4)
    except (TypeError, ValueError, OverflowError) as error:
        msg = f'{path}: {excerpt(error)}; give {example}'
        raise InputError(msg) from error
    if not (np.abs(translation) <= FARTHEST).all():  # NaN, too
        msg = f'{path}: the translation must be three numbers of metres, up to {FARTHEST:g}'
        raise InputError(msg)
    length = float(np.linalg.norm(rotation)) if (np.abs(rotation) <= 2).all() else np.nan
    if not abs(length - 1) <= 0.01:
        msg = f'{path}: the rotation must be a quaternion of length 1'
        raise InputError(msg)
    parent = loaded.get('parent', WORLD)
    if not isinstance(parent, str):
        msg = f'{path}: parent is {excerpt(repr(parent))}; give the name of a frame'
        raise InputError(msg)
    t_x, t_y, t_z = translation.tolist()
    x, y, z, w = (rotation / length).tolist()
    return Extrinsic(parent, (t_x, t_y, t_z), (x, y, z, w))
