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

"""Gestures in which both hands act together, such as clapping, carrying or pushing."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.body.bone_rotations import Rig
from lsc_pose_ros.synthetic.motion.arm_reaching import (
    FINGERS,
    MIRROR,
    PRONATION,
    move_hand,
    sample_hand,
)
from lsc_pose_ros.synthetic.motion.inverse_kinematics import pronation_towards
from lsc_pose_ros.synthetic.motion.joint_angles import ARMS
from lsc_pose_ros.synthetic.sampling import RandomStream


class HandPair(NamedTuple):
    """Target positions of both hands, in arm lengths from the middle between the shoulders.

    Attributes:
        middle: mean position of the middle of both hands: left, up, forwards.
        scatter: standard deviation of the middle.
        gap: range of the distance between the hands.
        across: direction from the right hand to the left one: left, up, forwards.
        palms: direction that the palms face: 'in', 'ahead', 'down', 'up' or 'any'.
        fingers: how far the hands are closed, degrees.
        swivel: how far the elbows are raised, degrees.
    """

    middle: tuple[float, float, float]
    scatter: tuple[float, float, float]
    gap: tuple[float, float]
    across: tuple[float, float, float] = (1.0, 0.0, 0.0)
    palms: str = 'in'
    fingers: float = 10.0
    swivel: float = 15.0


HAND_PAIRS: tuple[tuple[float, HandPair], ...] = (
    (0.20, HandPair((0, -0.15, 0.55), (0.08, 0.22, 0.12), (0.07, 0.6))),  # clapping
    (0.14, HandPair((0, -0.02, 0.8), (0.08, 0.2, 0.18), (0.3, 0.9), palms='ahead')),  # pushing
    # Lifting or shooting a ball; carrying.
    (0.14, HandPair((0, 0.65, 0.35), (0.1, 0.25, 0.2), (0.1, 0.9))),
    (0.12, HandPair((0, -0.4, 0.5), (0.12, 0.2, 0.12), (0.25, 0.9), palms='up', fingers=25)),
    # Holding a bat or a golf club.
    (0.10, HandPair((0.0, 0.0, 0.6), (0.4, 0.25, 0.12), (0.12, 0.16), (0.2, 1, 0.2), 'in', 80)),
    (0.08, HandPair((0.0, -0.75, 0.35), (0.2, 0.12, 0.12), (0.1, 0.16), (0.3, 1, 0.3), 'in', 80)),
    # Guarding as in boxing; folding the arms.
    (0.12, HandPair((0, -0.08, 0.5), (0.08, 0.12, 0.12), (0.25, 0.5), (1, 0, 0.5), 'in', 85)),
    (
        0.10,
        HandPair((0, -0.3, 0.3), (0.04, 0.1, 0.04), (0.35, 0.5), (-1, 0.35, 0.2), 'any', 25, 25),
    ),
)

IDLE_HAND_PAIRS: tuple[tuple[float, HandPair], ...] = (
    (
        0.40,
        HandPair((0, -0.3, 0.3), (0.04, 0.1, 0.04), (0.35, 0.5), (-1, 0.35, 0.2), 'any', 25, 25),
    ),
    (0.25, HandPair((0, -0.72, 0.28), (0.05, 0.1, 0.06), (0.07, 0.2), fingers=30)),  # clasped
    (0.15, HandPair((0, -0.3, 0.42), (0.06, 0.12, 0.08), (0.08, 0.25), palms='up', fingers=40)),
    (0.20, HandPair((0, -0.42, 0.45), (0.06, 0.14, 0.08), (0.3, 0.65), palms='in', fingers=25)),
)
"""Hands of people who stand idly: folded, clasped, before the body, with something in them."""

_PALMS = {
    'in': (-1.0, 0.0, 0.0),
    'ahead': (0.0, 0.0, 1.0),
    'up': (-0.3, 1.0, 0.0),
    'down': (0.0, -1.0, 0.0),
}


def move_hand_pair(
    rig: Rig, angles: NDArray[np.float64], target: HandPair, stream: RandomStream
) -> None:
    """Move both hands near a target, in place."""
    length = float(rig.arm.sum())
    centre = rig.shoulder[2] * np.array([0.0, 1.0, 1.0])
    middle = centre + length * np.array(
        [stream.normal(mean, off) for mean, off in zip(target.middle, target.scatter, strict=True)]
    )
    across = np.array(target.across) / np.sqrt((np.array(target.across) ** 2).sum())
    half = 0.5 * length * stream.between(*target.gap) * across
    swivel = stream.normal(target.swivel, 15)
    closed = stream.normal(target.fingers, 6)
    for side, mirror in ((0, np.ones(3)), (1, MIRROR)):
        arm = angles[ARMS[side]]
        position = mirror * (middle + (half if side == 0 else -half))
        move_hand(rig, arm, position, np.radians(swivel + stream.normal(0, 6)))
        sample_hand(arm, stream)
        arm[FINGERS] = np.radians(closed)
        if target.palms in _PALMS:
            arm[PRONATION] = pronation_towards(arm, np.array(_PALMS[target.palms]))
