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

"""Poses of the stick figure, and the joints of the body that is retargeted to it."""

import numpy as np
from scipy.spatial.transform import Rotation

from lsc_pose_ros.synthetic.body.body_mesh import (
    pose_body,
)
from lsc_pose_ros.synthetic.geometry.rotations import axis_rotation, from_quaternions
from lsc_pose_ros.synthetic.mocap.retarget import retarget_motion

# The person's left, up and forward in the file's axes, by up and forward of the mapping.
AXES = {
    ('y', 'z'): [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ('z', '-y'): [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
    ('z', 'x'): [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
}


def turn(axis, degrees):
    return Rotation.from_rotvec(np.radians(degrees) * np.asarray(axis, float))


def stand():
    """Return the rotations from the T-pose to hanging arms."""
    return {'Leftarm': turn([0, 0, 1], -80), 'Rightarm': turn([0, 0, 1], 80)}


def possible_pose(random):
    """Return a random pose within the limits of the joints."""
    pose = {
        'Hips': turn([0, 1, 0], random.uniform(-170, 170))
        * turn([1, 0, 0], random.uniform(0, 30)),
        'Spine': turn([1, 0, 0], random.uniform(-10, 30)),
        'Chest': turn([0, 1, 0], random.uniform(-30, 30)),
        'Head': turn([1, 0, 0], random.uniform(-30, 30)),
    }
    for side, sign in (('Left', 1), ('Right', -1)):
        pose[f'{side}arm'] = turn([0, 0, 1], -sign * random.uniform(-30, 80)) * turn(
            [0, sign, 0], -random.uniform(-20, 60)
        )
        # The palm faces down in the T-pose, so the forearm bends forward.
        pose[f'{side}elbow'] = turn([0, -sign, 0], random.uniform(0, 130))
        pose[f'{side}leg'] = turn([1, 0, 0], -random.uniform(-20, 80)) * turn(
            [0, 0, sign], random.uniform(0, 30)
        )
        pose[f'{side}knee'] = turn([1, 0, 0], random.uniform(0, 100))
    return pose


def angle(first, second):
    cosine = (first * second).sum(axis=-1)
    return np.degrees(
        np.arccos(
            np.clip(
                cosine / np.linalg.norm(first, axis=-1) / np.linalg.norm(second, axis=-1), -1, 1
            )
        )
    )


def posed_joints(body, rest, clip):
    """Return the joints of the body in each frame of `clip`, heading included."""
    rotations = retarget_motion(body, rest, from_quaternions(clip.orientations.astype(float)))
    rotations[:, 0] = axis_rotation(1, clip.heading) @ rotations[:, 0]
    return np.array([pose_body(body, rest, pose, np.zeros(3)).joints for pose in rotations])
