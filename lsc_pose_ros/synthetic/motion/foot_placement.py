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

"""Placement of both feet on the floor, below the centre of mass or below a seat."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.body.bone_rotations import Rig, bone_heads, bone_orientations
from lsc_pose_ros.synthetic.geometry.rotation_kernels import about_x, about_z, product, rotated
from lsc_pose_ros.synthetic.motion.inverse_kinematics import FootTarget, solve_leg
from lsc_pose_ros.synthetic.motion.joint_angles import ANGLE_NUMBERS, LEGS


class FootPlacement(NamedTuple):
    """Position of a foot on the floor.

    Attributes:
        lateral: outwards from the middle between the feet, in leg lengths.
        ahead: forwards from there, in leg lengths.
        heading: direction of the toes, radians, positive outwards.
        pitch: how far the heel is lifted, radians.
    """

    lateral: float
    ahead: float
    heading: float
    pitch: float = 0.0


def place_under_mass(
    rig: Rig,
    angles: NDArray[np.float64],
    placements: tuple[FootPlacement, FootPlacement],
    stretch: float,
    *,
    shift: float = 0.0,
    ahead: float = 0.0,
) -> None:
    """Place both feet below the centre of mass.

    Args:
        rig: the person's rig.
        angles: the pose; its trunk is used, its legs are set.
        placements: of the feet, relative to the point below the centre of mass.
        stretch: distance between hip and ankle of the straighter leg, 1 if it is straight.
        shift: offset of the centre of mass to the left, in leg lengths.
        ahead: offset of the centre of mass forwards, in leg lengths.
    """
    length = rig.leg[0] + rig.leg[1]
    lateral, forwards = _centre_of_mass(rig, angles) / length - (shift, ahead)
    left, right = placements
    moved = (
        left._replace(lateral=left.lateral + lateral, ahead=left.ahead + forwards),
        right._replace(lateral=right.lateral - lateral, ahead=right.ahead + forwards),
    )
    pelvis = _pelvis_orientation(angles)
    heights = []
    for placement, sign in zip(moved, (1.0, -1.0), strict=True):
        hip = rotated(pelvis, rig.hip * np.array([sign, 1.0, 1.0]))
        off = np.hypot(
            sign * placement.lateral * length - hip[0], placement.ahead * length - hip[2]
        )
        below = np.sqrt(max((stretch * length) ** 2 - off**2, (0.3 * length) ** 2))
        heights.append(below + _ankle_height(rig, placement) - hip[1])
    place_feet(rig, angles, moved, min(heights))


def place_feet(
    rig: Rig,
    angles: NDArray[np.float64],
    placements: tuple[FootPlacement, FootPlacement],
    height: float,
) -> None:
    """Place both feet on a floor that is `height` below the pelvis, metres."""
    length = rig.leg[0] + rig.leg[1]
    pelvis = _pelvis_orientation(angles)
    for side, (placement, sign) in enumerate(zip(placements, (1.0, -1.0), strict=True)):
        ankle = np.array(
            [
                sign * placement.lateral * length,
                _ankle_height(rig, placement) - height,
                placement.ahead * length,
            ]
        )
        foot = FootTarget(ankle, placement.heading, placement.pitch)
        angles[LEGS[side]] = solve_leg(rig, pelvis, foot, right=side == 1)


def _ankle_height(rig: Rig, placement: FootPlacement) -> float:
    return float(rig.leg[2] + np.sin(placement.pitch) * rig.leg[3])


def _pelvis_orientation(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    lean, tip = angles[ANGLE_NUMBERS['lean']], angles[ANGLE_NUMBERS['list']]
    return product(about_z(-tip), about_x(lean))


# Fractions of the body's mass (Winter, Biomechanics and Motor Control of Human Movement, 2009).
_TRUNK_MASS, _HEAD_MASS, _ARMS_MASS, _LEGS_MASS = 0.497, 0.081, 0.1, 0.322
_LEG_CENTRE = 0.4  # position of a leg's centre of mass on the way from hip to foot


def _centre_of_mass(rig: Rig, angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the position of the feet, left and forwards of the pelvis, for balance, metres, (2,).

    The mass of legs with feet at an offset c from the pelvis is at 0.4 c. So the whole body's
    centre of mass is above the feet if c = m_upper u + m_legs 0.4 c.
    """
    orientations = bone_orientations(angles, rig.standing, rig.parts)
    heads = bone_heads(orientations, rig.parents, rig.heads)[:, [0, 2]]
    neck, head, chest = (heads[rig.numbers[name]] for name in ('neck01', 'head', 'spine01'))
    moment = _TRUNK_MASS * 0.5 * neck + _HEAD_MASS * head + _ARMS_MASS * chest
    return np.asarray(moment / (1 - _LEGS_MASS * _LEG_CENTRE))
