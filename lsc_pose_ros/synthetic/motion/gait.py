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

"""Walking and running: joint angles over a stride, from measurements of gait laboratories."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.motion.joint_angles import ANGLE_NUMBERS, ANGLES, ARMS, LEGS

# Degrees at each tenth of a stride, from the contact of the foot with the floor. Walking: Winter,
# The Biomechanics and Motor Control of Human Gait (1991). Running: Novacheck, The biomechanics of
# running, Gait and Posture 7 (1998).
_WALKING: dict[str, tuple[float, ...]] = {
    'hip_flexion': (28, 25, 17, 8, -2, -9, -6, 10, 24, 30),
    'knee': (4, 16, 14, 8, 5, 12, 38, 60, 46, 16),
    'ankle': (0, 4, -3, -7, -10, -8, 14, 8, 0, -1),
}
_RUNNING: dict[str, tuple[float, ...]] = {
    'hip_flexion': (35, 32, 20, 5, -8, -5, 14, 34, 46, 43),
    'knee': (18, 38, 36, 22, 20, 52, 92, 100, 66, 26),
    'ankle': (-8, -18, -22, -4, 20, 15, 5, 0, -3, -5),
}


def stride_angles(
    phase: float, running: float, size: float, hand: float = 0.0
) -> NDArray[np.float64]:
    """Return the joint angles at one phase of a stride.

    Args:
        phase: of the stride, 0 to 1; the left foot touches the floor at 0.
        running: 0 walks, 1 runs, in between is a jog.
        size: amplitude of the movements, 1 as measured.
        hand: additional flexion of the elbows, radians.

    Returns:
        The angles in the order of ANGLES, radians, shape (A,).
    """
    angles = np.zeros(len(ANGLES))
    for side in (0, 1):
        own_phase = (phase + 0.5 * side) % 1.0
        leg = {name: _at(_WALKING[name], _RUNNING[name], own_phase, running) for name in _WALKING}
        prefix = ('l_', 'r_')[side]
        for name, value in leg.items():
            angles[ANGLE_NUMBERS[prefix + name]] = np.radians(size * value)
        angles[LEGS[side]][1:3] = np.radians([2.0, 6.0])
        # The arm moves with the other leg.
        other = _at(
            _WALKING['hip_flexion'], _RUNNING['hip_flexion'], (own_phase + 0.5) % 1.0, running
        )
        forwards = size * np.radians((1.0 + 0.4 * running) * (other - 10 - 6 * running))
        angles[ARMS[side]][:5] = _arm_swing(forwards, running, hand)
    twist = np.radians(6 + 6 * running) * size * np.cos(2 * np.pi * phase)
    angles[ANGLE_NUMBERS['twist']] = twist
    angles[ANGLE_NUMBERS['turn']] = -twist
    angles[ANGLE_NUMBERS['lean']] = np.radians(2 + 8 * running)
    return angles


def _at(
    walking: tuple[float, ...], running: tuple[float, ...], own_phase: float, fraction: float
) -> float:
    """Return the value at a phase between 0 and 1 by cubic interpolation of the table, degrees."""
    table = (1 - fraction) * np.array(walking) + fraction * np.array(running)
    first = int(own_phase * len(table)) % len(table)
    u = own_phase * len(table) - int(own_phase * len(table))
    before, here, there, after = table[(first + np.arange(-1, 3)) % len(table)]
    # Catmull-Rom spline.
    bend = 2 * before - 5 * here + 4 * there - after
    cubic = 3 * (here - there) + after - before
    return float(here + 0.5 * u * (there - before + u * (bend + u * cubic)))


def _arm_swing(forwards: float, running: float, hand: float) -> NDArray[np.float64]:
    """Return plane, elevation, axial, elbow and pronation of an arm that swings at the side."""
    lateral = np.radians(9 + 9 * running)
    elevation = np.hypot(lateral, forwards)
    plane = np.arctan2(forwards, lateral)
    elbow = np.radians(18 + 68 * running) + hand + 0.5 * max(forwards, 0.0)
    return np.array([plane, elevation, np.radians(-10 - 10 * running), elbow, np.radians(15.0)])
