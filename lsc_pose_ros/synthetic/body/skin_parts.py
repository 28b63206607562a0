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

"""The part of the body that each triangle of the skin belongs to: one part per joint."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.synthetic.body.body_file import BodyModel

NO_PART = 0
"""The part of a pixel that shows no person; other parts are 1 + the joint's number."""

# The joints that a bone belongs to, by the beginning of the bone's name. '*' is the bone's side.
_JOINTS_OF_BONES: tuple[tuple[tuple[str, ...], tuple[str, ...]], ...] = (
    (('root', 'spine05', 'spine04'), ('torso', 'pelvis', 'l_hip', 'r_hip')),
    (('pelvis',), ('pelvis', '*_hip')),
    (('spine03', 'spine02'), ('torso', 'pelvis')),
    (('spine01',), ('torso', 'neck')),
    (('neck', 'head'), ('neck', 'head')),
    (('clavicle', 'shoulder'), ('neck', '*_shoulder')),
    (('upperarm',), ('*_shoulder', '*_elbow')),
    (('lowerarm',), ('*_elbow', '*_wrist')),
    (('wrist', 'metacarpal', 'finger'), ('*_wrist', '*_hand')),
    (('upperleg',), ('*_hip', '*_knee')),
    (('lowerleg',), ('*_knee', '*_ankle')),
    (('foot', 'toes'), ('*_ankle', '*_foot')),
)


def skin_parts(body: BodyModel) -> NDArray[np.int32]:
    """Return the part of each triangle, shape (T,): 1 + the number of the nearest joint.

    Distances are those in the rest pose of the average body. Only joints of the bones that the
    triangle's corners follow most are compared, so that a hand never belongs to a hip.
    """
    vertices = len(body.skin_bones)
    points = body.mean.astype(np.float64)
    joints = points[vertices + len(body.bones) :]
    middles = points[body.triangles].mean(axis=1)
    distances = np.sqrt(((middles[:, None] - joints) ** 2).sum(axis=2))
    own = np.array([_joints_of_bone(str(name)) for name in body.bones])
    allowed = own[body.skin_bones[:, 0]][body.triangles].any(axis=1)
    parts: NDArray[np.int32] = 1 + np.where(allowed, distances, np.inf).argmin(axis=1)
    return parts.astype(np.int32)


def _joints_of_bone(name: str) -> NDArray[np.bool_]:
    """Return whether each joint belongs to a bone, shape (20,)."""
    side = name[-1].lower()
    chosen = np.zeros(len(JOINT_NAMES), bool)
    for starts, joints in _JOINTS_OF_BONES:
        if name.startswith(starts):
            chosen[[JOINT_NUMBERS[joint.replace('*', side)] for joint in joints]] = True
    return chosen
