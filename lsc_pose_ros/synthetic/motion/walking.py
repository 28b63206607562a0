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

"""Walking along a path: the legs move as fast as the body."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.body.body_file import BodyModel
from lsc_pose_ros.synthetic.body.body_mesh import RestBody
from lsc_pose_ros.synthetic.body.bone_rotations import pose_rotations, rig_of
from lsc_pose_ros.synthetic.motion.gait import stride_angles
from lsc_pose_ros.synthetic.motion.joint_angles import within_limits
from lsc_pose_ros.synthetic.motion.motion import Motion

STRIDE = 1.3
"""The length of a stride, two steps, metres."""


def walking_motion(
    body: BodyModel, rest: RestBody, distance: NDArray[np.float64], yaw: NDArray[np.float64]
) -> Motion:
    """Return the motion of a person who walks.

    Args:
        body: the body model.
        rest: the person in the rest pose.
        distance: how far the person has walked, metres, shape (T,).
        yaw: the direction of the walk, as in `Motion`, radians, shape (T,).
    """
    angles = [within_limits(stride_angles(each / STRIDE % 1.0, 0.0, 1.0)) for each in distance]
    return Motion(pose_rotations(rig_of(body, rest), np.array(angles)), yaw)
