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

"""Mirrors frames for training: left and right of the people are exchanged."""

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.lens import transform_lens
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.data_types.skeletons import Skeletons

_OTHER_SIDE = {'l': 'r', 'r': 'l'}


def with_mirrored(frames: Iterable[Frame]) -> Iterator[Frame]:
    """Yield each frame and its mirror image."""
    for frame in frames:
        yield frame
        yield mirrored(frame)


def mirrored(frame: Frame) -> Frame:
    """Return the mirror image of `frame`; the left hand becomes the right hand."""
    camera, width = frame.camera, frame.depth.shape[1]
    return frame._replace(
        depth=np.ascontiguousarray(frame.depth[:, ::-1]),
        labels=np.ascontiguousarray(frame.labels[:, ::-1]),
        camera=camera._replace(
            cx=width - 1 - camera.cx,
            lens=camera.lens and transform_lens(camera.lens, np.diag([-1.0, 1.0])),
        ),
        ground_truth=None
        if frame.ground_truth is None
        else _mirrored_skeletons(frame.ground_truth),
    )


def _mirrored_skeletons(skeletons: Skeletons) -> Skeletons:
    renamed = _other_side(skeletons.joints)
    order = np.argsort(renamed, kind='stable')
    mirror = np.array([-1, 1, 1], np.float32)
    return Skeletons(
        skeletons.bodies,
        renamed[order],
        skeletons.positions[:, order] * mirror,
        skeletons.confidence[:, order],
    )


def _other_side(joints: NDArray[np.uint16]) -> NDArray[np.uint16]:
    """Return the joint number of each of `joints` in the mirror image, shape (J,)."""
    names = [JOINT_NAMES[number] for number in joints]
    other = [_OTHER_SIDE.get(name[0], '') + name[1:] if name[1] == '_' else name for name in names]
    return np.array([JOINT_NUMBERS[name] for name in other], np.uint16)
