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

"""The angles of the joints of the human model of REP-155, from the positions of joints.

The model is the URDF of the package human_description. Its torso has the axes of the body frame,
so the angle of its waist is 0. Each limb hangs from the torso along -z, and turns by

    arm:  Rz(-s y) Rx(s p) Rz(s r) Ry(-e)    y, p, r: the shoulder's angles; e: the elbow's
    leg:  Rz(-y) Rx(s p) Ry(-r) Ry(-k)       y, p, r: the hip's angles; k: the knee's

with s = 1 on the left and s = -1 on the right. The names of the angles are those of REP-155
(y: yaw, p: pitch, r: roll). The angles of the head do not follow from positions.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.body_frame import body_frame
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS

STRAIGHT = math.radians(10)
"""A limb that is bent by less does not say how it is turned about itself: that angle is 0.

The limb of the model then differs by less than twice this angle from the person's.
"""

# The model's limits of the shoulder, radians.
_LARGEST_YAW, _LEAST_YAW, _LEAST_PITCH = 1.9, -1.1, -0.4

_SHORTEST = 0.02
"""Joints that are nearer to each other do not define a direction, metres."""

_SIDES = (('l', 1.0), ('r', -1.0))

_Vector = NDArray[np.float64]


def joint_angles(
    joints: NDArray[np.uint16], positions: NDArray[np.float32]
) -> dict[str, float] | None:
    """Return the angles of one body that follow from its joints, radians, by their names.

    Args:
        joints: the numbers of the joints, shape (J,).
        positions: metres in the camera's optical frame, NaN if unknown, shape (J, 3).

    Returns:
        The angle of the waist, which is 0, and those of each limb of which all joints are known;
        None if the body has no frame.
    """
    frame = body_frame(joints, positions)
    if frame is None:
        return None
    inside = dict(zip(joints.tolist(), frame.inside(positions), strict=True))

    def direction(start: str, end: str) -> _Vector | None:
        unknown = np.full(3, np.nan)
        ends = (inside.get(JOINT_NUMBERS[name], unknown) for name in (end, start))
        difference = np.subtract(*ends)
        length = np.linalg.norm(difference)
        return difference / length if length > _SHORTEST else None  # None for NaN

    angles = {'waist': 0.0}
    for side, sign in _SIDES:
        upper = direction(f'{side}_shoulder', f'{side}_elbow')
        lower = direction(f'{side}_elbow', f'{side}_wrist')
        if upper is not None and lower is not None:
            yaw, pitch, roll, elbow = _arm_angles(upper, lower, sign)
            angles |= _named(side, 'shoulder', yaw, pitch, roll) | {f'{side}_elbow': elbow}
        thigh = direction(f'{side}_hip', f'{side}_knee')
        shin = direction(f'{side}_knee', f'{side}_ankle')
        if thigh is not None and shin is not None:
            yaw, pitch, roll, knee = _leg_angles(thigh, shin, sign)
            angles |= _named(side, 'hip', yaw, pitch, roll) | {f'{side}_knee': knee}
    return angles


def _named(side: str, joint: str, yaw: float, pitch: float, roll: float) -> dict[str, float]:
    axes = {'y': yaw, 'p': pitch, 'r': roll}
    return {f'{side}_{axis}_{joint}': angle for axis, angle in axes.items()}


def _arm_angles(upper: _Vector, lower: _Vector, sign: float) -> tuple[float, float, float, float]:
    """Return y, p, r and e: the upper arm is Rz(-y) Rx(p) (0, 0, -1) on the left.

    Args:
        upper: the direction from the shoulder to the elbow in the torso, shape (3,).
        lower: the direction from the elbow to the wrist in the torso, shape (3,).
        sign: 1 on the left, -1 on the right, which is the mirror image.
    """
    x, y, z = upper[0], sign * upper[1], upper[2]
    pitch = math.acos(np.clip(-z, -1, 1))
    yaw = math.atan2(x, y)
    if not _LEAST_YAW <= yaw <= _LARGEST_YAW and -pitch >= _LEAST_PITCH:
        # The same direction: an arm that hangs across the body.
        yaw, pitch = yaw - math.copysign(math.pi, yaw), -pitch
    mirrored = lower * (1, sign, 1)
    x, y, z = (_about_z(-yaw) @ _about_x(pitch)).T @ mirrored
    elbow = math.acos(np.clip(-z, -1, 1))
    roll = math.atan2(y, x) if elbow > STRAIGHT else 0.0
    return yaw, pitch, roll, elbow


def _leg_angles(thigh: _Vector, shin: _Vector, sign: float) -> tuple[float, float, float, float]:
    """Return y, p, r and k; the normal of thigh and shin is Rz(-y) Rx(s p) (0, 1, 0).

    A knee that seems to be bent forward has a positive angle.

    Args:
        thigh: the direction from the hip to the knee in the torso, shape (3,).
        shin: the direction from the knee to the ankle in the torso, shape (3,).
        sign: 1 on the left, -1 on the right.
    """
    normal = np.cross(thigh, shin)
    bend = math.atan2(np.linalg.norm(normal), thigh @ shin)
    if bend > STRAIGHT:
        normal = normal / np.linalg.norm(normal) * (1 if normal[1] >= 0 else -1)
        yaw = math.atan2(normal[0], normal[1])
        pitch = math.asin(np.clip(normal[2], -1, 1))
    else:
        yaw, pitch = 0.0, math.atan2(thigh[1], -thigh[2])
    turn = (_about_z(-yaw) @ _about_x(pitch)).T
    upper, lower = turn @ thigh, turn @ shin
    roll = math.atan2(upper[0], -upper[2])
    knee = math.remainder(math.atan2(lower[0], -lower[2]) - roll, 2 * math.pi)
    return yaw, sign * pitch, roll, knee


def _about_x(angle: float) -> NDArray[np.float64]:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])


def _about_z(angle: float) -> NDArray[np.float64]:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
