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

"""Arms that reach to a position: anywhere around the shoulder, or down to the floor."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.body.bone_rotations import Rig, bone_orientations
from lsc_pose_ros.synthetic.geometry.rotation_kernels import rotated_back
from lsc_pose_ros.synthetic.motion.inverse_kinematics import solve_arm
from lsc_pose_ros.synthetic.motion.joint_angles import ARM_ANGLES, ARMS
from lsc_pose_ros.synthetic.sampling import RandomStream

MIRROR = np.array([-1.0, 1.0, 1.0])
"""Factors that mirror a vector between left and right."""

PRONATION = ARM_ANGLES.index('pronation')
FINGERS = ARM_ANGLES.index('fingers')

_WRIST = slice(PRONATION + 1, PRONATION + 3)
_FAR = 0.08
"""An arm whose hand would stay farther than this from its position does not move, metres."""


def reach_freely(rig: Rig, angles: NDArray[np.float64], side: int, stream: RandomStream) -> None:
    """Move a hand, 0 is the left, to a random position around the shoulder, mostly in front."""
    length = rig.arm.sum()
    direction = np.array(
        [stream.normal(-0.05, 0.5), stream.normal(-0.05, 0.5), stream.normal(0.5, 0.4)]
    )
    distance = np.sqrt((direction**2).sum())
    if distance > 1:
        direction *= stream.between(0.7, 1.0) / distance
    position = rig.shoulder[2] + length * direction
    move_hand(rig, angles[ARMS[side]], position, np.radians(stream.normal(15, 30)))
    sample_hand(angles[ARMS[side]], stream)


def reach_down(rig: Rig, angles: NDArray[np.float64], side: int, stream: RandomStream) -> None:
    """Move a hand, 0 is the left, vertically down, or beyond towards the floor or a shin."""
    orientations = bone_orientations(angles, rig.standing, rig.parts)
    chest = orientations[rig.numbers['spine01']]
    direction = np.array([stream.normal(0.05, 0.25), -1.0, stream.normal(0.25, 0.35)])
    direction *= stream.between(0.6, 1.0) / np.sqrt((direction**2).sum())
    mirror = MIRROR if side else np.ones(3)
    offset = mirror * rotated_back(chest, mirror * direction)
    position = rig.shoulder[2] + rig.arm.sum() * offset
    move_hand(rig, angles[ARMS[side]], position, np.radians(stream.normal(20, 25)))
    sample_hand(angles[ARMS[side]], stream)


def sample_hand(arm: NDArray[np.float64], stream: RandomStream) -> None:
    """Sample forearm rotation, wrist and fingers of an arm, in place."""
    arm[PRONATION] = np.radians(stream.normal(25, 40))
    arm[_WRIST] = np.radians([stream.normal(0, 12), stream.normal(-2, 6)])
    closed = stream.choose(((0.6, 12.0), (0.2, 45.0), (0.2, 85.0)))
    arm[FINGERS] = np.radians(stream.normal(closed, 8))


def move_hand(
    rig: Rig, arm: NDArray[np.float64], position: NDArray[np.float64], swivel: float
) -> float:
    """Move a hand to a position if it can get near, in place.

    Args:
        rig: the person's rig.
        arm: the arm's angles, radians.
        position: in the chest's frame, mirrored for the right arm, metres, shape (3,).
        swivel: how far the elbow is raised, radians.

    Returns:
        The distance between hand and position, metres.
    """
    solved, miss = solve_arm(rig, arm, np.ascontiguousarray(position), swivel)
    if miss < _FAR:
        arm[:] = solved
    return miss
