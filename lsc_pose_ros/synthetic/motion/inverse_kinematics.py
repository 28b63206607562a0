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

"""Inverse kinematics of arms and legs: the angles that move a hand or a foot to a position.

Arm and leg consist of two bones each, so the law of cosines gives the flexion of elbow or knee.
The elbow can still swivel about the line from shoulder to hand; the knee has a given direction.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.synthetic.body.bone_rotations import (
    Rig,
    elevation_rotation,
    set_shoulder_rotations,
)
from lsc_pose_ros.synthetic.geometry.rotation_kernels import (
    about_x,
    about_y,
    about_z,
    product,
    rotated,
    rotated_back,
)
from lsc_pose_ros.synthetic.motion.joint_angles import (
    ARM_ANGLES,
    ARMS,
    LEGS,
    LOWER_LIMITS,
    UPPER_LIMITS,
    max_elevation,
)

REACH_TOLERANCE = 0.02
"""A hand within this distance of its target has reached it, metres."""

_ARM_LIMITS = np.stack([LOWER_LIMITS[ARMS[0]], UPPER_LIMITS[ARMS[0]]])
_LEG_LIMITS = np.stack([LOWER_LIMITS[LEGS[0]], UPPER_LIMITS[LEGS[0]]])
_PLANE, _ELEVATION, _AXIAL, _ELBOW, _PRONATION = range(5)
_FLEX = ARM_ANGLES.index('wrist_flexion')
_SHRUG = ARM_ANGLES.index('shrug')
_FLEXION, _ABDUCTION, _ROTATION, _KNEE, _ANKLE, _EVERSION, _TOES = range(7)

_TINY = 1e-6  # metres

_SWIVELS = 13  # number of swivels that are tried
_SETTLING = 4  # iterations, because the shoulder moves with the arm


class FootTarget(NamedTuple):
    """Target position and orientation of a foot, in the person's axes.

    Attributes:
        ankle: position relative to the pelvis, metres, shape (3,).
        heading: direction of knee and toes, radians, 0 forwards, positive outwards.
        pitch: how far the heel is lifted, radians.
    """

    ankle: NDArray[np.float64]
    heading: float
    pitch: float


def solve_arm(
    rig: Rig, arm: NDArray[np.float64], position: NDArray[np.float64], swivel: float
) -> tuple[NDArray[np.float64], float]:
    """Move the middle of a hand to a position, with the elbow as close to `swivel` as possible.

    Args:
        rig: the person's rig.
        arm: the left arm's angles, radians; angles that do not matter are left unchanged.
        position: relative to the head of the chest's bone, in its axes, metres, shape (3,); for
            the right arm its mirror image.
        swivel: how far the elbow is raised outwards from hanging down, radians.

    Returns:
        The arm's angles within limits, and the distance of the hand from the position, metres.
    """
    return search_swivel(arm, position, swivel, rig.shoulder, rig.arm)


@kernel
def search_swivel(
    arm: NDArray[np.float64],
    position: NDArray[np.float64],
    swivel: float,
    shoulder: NDArray[np.float64],
    lengths: NDArray[np.float64],
) -> tuple[NDArray[np.float64], float]:
    """Try swivels, the wanted one first, until the hand reaches its position."""
    best, least = arm.copy(), np.inf
    for step in range(_SWIVELS):
        off = (step + 1) // 2 * (1 if step % 2 else -1)
        tried = arm.copy()
        for _ in range(_SETTLING):
            solve_fixed_shoulder(
                tried, position, swivel + off * 2 * np.pi / _SWIVELS, shoulder, lengths
            )
        miss = _length(_blend(1.0, hand_position(tried, shoulder, lengths), -1.0, position))
        if miss < least - 1e-6:
            best, least = tried, miss
        if least < REACH_TOLERANCE:
            break
    return best, least


@kernel
def shoulder_position(
    arm: NDArray[np.float64], shoulder: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the position of the left shoulder joint in the chest's frame, shape (3,)."""
    clavicle, blade = np.empty((3, 3)), np.empty((3, 3))
    set_shoulder_rotations(arm[_PLANE], arm[_ELEVATION], arm[_SHRUG], clavicle, blade)
    inner = rotated(clavicle, _blend(1.0, shoulder[1], -1.0, shoulder[0]))
    outer = rotated(blade, _blend(1.0, shoulder[2], -1.0, shoulder[1]))
    return _blend(1.0, shoulder[0], 1.0, _blend(1.0, inner, 1.0, outer))


@kernel
def forearm_orientation(arm: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the left forearm's orientation in the chest's frame, before pronation, (3, 3)."""
    upper = product(elevation_rotation(arm[_PLANE], arm[_ELEVATION]), about_y(arm[_AXIAL]))
    return product(upper, about_x(-arm[_ELBOW]))


@kernel
def hand_position(
    arm: NDArray[np.float64], shoulder: NDArray[np.float64], lengths: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the position of the middle of the left hand with a straight wrist, shape (3,)."""
    upper = elevation_rotation(arm[_PLANE], arm[_ELEVATION])[:, 1]
    along = _blend(-lengths[0], upper, -lengths[1], forearm_orientation(arm)[:, 1])
    return _blend(1.0, shoulder_position(arm, shoulder), 1.0, along)


@kernel
def solve_fixed_shoulder(
    arm: NDArray[np.float64],
    position: NDArray[np.float64],
    swivel: float,
    shoulder: NDArray[np.float64],
    lengths: NDArray[np.float64],
) -> None:
    """Set the left arm's angles, in place, for a shoulder that stays in its position.

    With the lengths a and b and the distance d, the upper arm deviates from the line to the hand
    by alpha, cos alpha = (a^2 + d^2 - b^2) / (2 a d), and the cosine of the elbow's flexion is
    (d^2 - a^2 - b^2) / (2 a b).
    """
    a, b = lengths[0], lengths[1]
    offset = _blend(1.0, position, -1.0, shoulder_position(arm, shoulder))
    length = _length(offset)
    if length < _TINY:
        return
    u = _blend(1 / length, offset, 0.0, offset)
    closest = np.sqrt(a * a + b * b + 2 * a * b * np.cos(_ARM_LIMITS[1, _ELBOW]))
    d = min(max(length, closest), 0.9995 * (a + b))
    # The elbow hangs down, or is behind a hand that hangs down.
    down = _across(np.array([0.0, -1.0, -0.25]), u)
    pole = _blend(np.cos(swivel), down, np.sin(swivel), _cross(u, down))
    cosine = min(max((a * a + d * d - b * b) / (2 * a * d), -1.0), 1.0)
    upper = _blend(cosine, u, np.sqrt(1 - cosine * cosine), pole)
    ahead = _across(_blend(d, u, -a, upper), upper)
    arm[_ELBOW] = np.arccos(min(max((d * d - a * a - b * b) / (2 * a * b), -1.0), 1.0))
    arm[_ELEVATION] = np.arccos(min(max(-upper[1], -1.0), 1.0))
    arm[_PLANE] = np.arctan2(upper[2], upper[0])
    if _length(ahead) > _TINY:
        seen = rotated_back(elevation_rotation(arm[_PLANE], arm[_ELEVATION]), ahead)
        arm[_AXIAL] = np.arctan2(seen[0], seen[2])
    limit_arm(arm)


@kernel
def limit_arm(arm: NDArray[np.float64]) -> None:
    """Clip an arm's angles to the limits of the joints, in place."""
    for angle in range(len(arm)):
        arm[angle] = min(max(arm[angle], _ARM_LIMITS[0, angle]), _ARM_LIMITS[1, angle])
    highest = max_elevation(arm[_PLANE], _ARM_LIMITS[1, _ELEVATION])
    arm[_ELEVATION] = min(arm[_ELEVATION], highest)


@kernel
def pronation_towards(arm: NDArray[np.float64], wanted: NDArray[np.float64]) -> float:
    """Return the pronation, within limits, with which the left palm best faces a direction.

    Args:
        arm: the left arm's angles.
        wanted: the direction in the chest's axes, shape (3,).
    """
    seen = rotated_back(forearm_orientation(arm), wanted)
    best = np.arctan2(-seen[2], -seen[0])
    return float(min(max(best, _ARM_LIMITS[0, _PRONATION]), _ARM_LIMITS[1, _PRONATION]))


@kernel
def align_palm(arm: NDArray[np.float64], inwards: NDArray[np.float64]) -> None:
    """Set the left hand's angles, in place, so that the palm lies flat on a surface.

    Args:
        arm: the left arm's angles.
        inwards: direction into the surface, in the chest's axes, shape (3,).
    """
    arm[_PRONATION] = pronation_towards(arm, inwards)
    hand = product(forearm_orientation(arm), about_y(-arm[_PRONATION]))
    seen = rotated_back(hand, inwards)
    # Flexion rotates the fingers, -y, towards the palm, -x, until they are level on the surface.
    arm[_FLEX] = np.arctan2(seen[1], max(-seen[0], 0.2))
    limit_arm(arm)


def solve_leg(
    rig: Rig, pelvis: NDArray[np.float64], foot: FootTarget, *, right: bool
) -> NDArray[np.float64]:
    """Return the angles of a leg whose foot is on its target; the sole is level unless pitched.

    Args:
        rig: the person's rig.
        pelvis: the pelvis's orientation, shape (3, 3).
        foot: the target; if it is out of reach, the leg is stretched towards it.
        right: whether it is the right foot.
    """
    if right:
        mirror = np.array([[1.0, -1.0, -1.0], [-1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]])
        pelvis = mirror * pelvis
        foot = foot._replace(ankle=foot.ankle * np.array([-1.0, 1.0, 1.0]))
    return solve_left_leg(pelvis, foot.ankle, foot.heading, foot.pitch, rig.hip, rig.leg)


@kernel
def solve_left_leg(
    pelvis: NDArray[np.float64],
    ankle: NDArray[np.float64],
    heading: float,
    pitch: float,
    hip: NDArray[np.float64],
    lengths: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the angles of the left leg, shape (7,), whose ankle is at a position."""
    leg = np.zeros(7)
    a, b = lengths[0], lengths[1]
    offset = _blend(1.0, rotated_back(pelvis, ankle), -1.0, hip)
    length = max(_length(offset), _TINY)
    u = _blend(1 / length, offset, 0.0, offset)
    d = min(max(length, abs(a - b) + 0.1 * a), 0.9995 * (a + b))
    ahead = rotated_back(pelvis, np.array([np.sin(heading), 0.0, np.cos(heading)]))
    pole = _across(ahead, u)
    cosine = min(max((a * a + d * d - b * b) / (2 * a * d), -1.0), 1.0)
    sine = np.sqrt(1 - cosine * cosine)
    up = _blend(-cosine, u, -sine, pole)
    front = _blend(cosine, pole, -sine, u)
    lateral = _cross(up, front)
    # The rotation with these columns is Rx(-flexion) Rz(abduction) Ry(rotation).
    leg[_ABDUCTION] = np.arcsin(min(max(-up[0], -1.0), 1.0))
    leg[_FLEXION] = np.arctan2(-up[2], up[1])
    leg[_ROTATION] = np.arctan2(front[0], lateral[0])
    leg[_KNEE] = np.arccos(min(max((d * d - a * a - b * b) / (2 * a * b), -1.0), 1.0))
    _limit_leg(leg)
    level_foot(leg, pelvis, pitch)
    return leg


@kernel
def level_foot(leg: NDArray[np.float64], pelvis: NDArray[np.float64], pitch: float) -> None:
    """Set the ankle's angles, in place, to level the left sole except for a lifted heel."""
    turn = product(about_x(-leg[_FLEXION]), about_z(leg[_ABDUCTION]))
    turn = product(product(turn, about_y(leg[_ROTATION])), about_x(leg[_KNEE]))
    shank = product(pelvis, turn)
    leg[_ANKLE] = np.arctan2(shank[1, 2], shank[1, 1]) + pitch
    _limit_leg(leg)
    foot = product(shank, about_x(leg[_ANKLE]))
    leg[_EVERSION] = np.arctan2(-foot[1, 0], foot[1, 1])
    leg[_TOES] = max(pitch, 0.0)
    _limit_leg(leg)


@kernel
def _limit_leg(leg: NDArray[np.float64]) -> None:
    for angle in range(len(leg)):
        leg[angle] = min(max(leg[angle], _LEG_LIMITS[0, angle]), _LEG_LIMITS[1, angle])


@kernel
def _blend(
    a: float, first: NDArray[np.float64], b: float, second: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return a times the first plus b times the second vector, shape (3,)."""
    blend = np.empty(3)
    for axis in range(3):
        blend[axis] = a * first[axis] + b * second[axis]
    return blend


@kernel
def _length(vector: NDArray[np.float64]) -> float:
    return float(np.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2))


@kernel
def _cross(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    cross = np.empty(3)
    for axis in range(3):
        one, other = (axis + 1) % 3, (axis + 2) % 3
        cross[axis] = first[one] * second[other] - first[other] * second[one]
    return cross


@kernel
def _across(vector: NDArray[np.float64], unit: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the direction of the part of `vector` that is orthogonal to a unit vector, or 0."""
    along = vector[0] * unit[0] + vector[1] * unit[1] + vector[2] * unit[2]
    across = _blend(1.0, vector, -along, unit)
    length = max(_length(across), _TINY)
    return _blend(1 / length, across, 0.0, across)
