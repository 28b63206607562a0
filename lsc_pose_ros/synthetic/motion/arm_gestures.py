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

"""Samples what the arms do: postures, reaching, touching the body, both hands together."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.body.self_collision import CollisionBody
from lsc_pose_ros.synthetic.motion.arm_reaching import reach_down, reach_freely
from lsc_pose_ros.synthetic.motion.body_touch import (
    SITTING_TOUCH_TARGETS,
    TOUCH_TARGETS,
    touch_body,
)
from lsc_pose_ros.synthetic.motion.habitual_postures import (
    ARM_POSTURES,
    HANGING,
    Posture,
    sample_posture,
)
from lsc_pose_ros.synthetic.motion.joint_angles import (
    ANGLE_NUMBERS,
    ARM_ANGLES,
    ARMS,
    LOWER_LIMITS,
    UPPER_LIMITS,
)
from lsc_pose_ros.synthetic.motion.lower_body_poses import BodyPose
from lsc_pose_ros.synthetic.motion.two_hand_gestures import (
    HAND_PAIRS,
    IDLE_HAND_PAIRS,
    move_hand_pair,
)
from lsc_pose_ros.synthetic.sampling import RandomStream

_Angles = NDArray[np.float64]

_PREFIXES = ('l_', 'r_')

_BOTH_POSTURES: tuple[tuple[float, Posture], ...] = (
    (0.25, {  # hands on the hips
        'plane': (-18, 8), 'elevation': (42, 5), 'axial': (-50, 6), 'elbow': (92, 6),
        'wrist_flexion': (20, 12), 'fingers': (20, 12),
    }),
    (0.25, {  # arms spread
        'plane': (5, 14), 'elevation': (85, 20), 'axial': (10, 30), 'elbow': (14, 14),
        'pronation': (20, 40),
    }),
    (0.20, {  # hands up
        'plane': (10, 16), 'elevation': (78, 16), 'axial': (76, 10), 'elbow': (88, 20),
        'pronation': (30, 24),
    }),
    (0.12, {  # arms up
        'plane': (30, 25), 'elevation': (152, 12), 'axial': (10, 25), 'elbow': (20, 18),
        'pronation': (0, 40),
    }),
    (0.10, {  # hands behind the head
        'plane': (8, 8), 'elevation': (104, 10), 'axial': (66, 10), 'elbow': (128, 8),
        'pronation': (0, 30), 'fingers': (25, 14),
    }),
    (0.08, {  # hands behind the back
        'plane': (-58, 8), 'elevation': (30, 6), 'axial': (-58, 6), 'elbow': (72, 12),
        'pronation': (10, 20), 'fingers': (30, 14),
    }),
)  # fmt: skip

_IDLE_POSTURES = (_BOTH_POSTURES[0], _BOTH_POSTURES[-1])  # hands on the hips, behind the back


def sample_arms(collision_body: CollisionBody, lower_body: BodyPose, stream: RandomStream) -> None:
    """Sample the pose of both arms, in place.

    Args:
        collision_body: the person's rig and capsules.
        lower_body: the pose of trunk and legs; the arms of its angles are set.
        stream: the source of randomness.
    """
    kind, angles = lower_body
    if stream.bernoulli(_BOTH_ARMS_PROBABILITY[kind]):
        _sample_both(collision_body, lower_body, stream)
        return
    for side in (0, 1):
        _sample_one(collision_body, angles, side, stream.choose(_ONE_ARM_GESTURES[kind]), stream)


_BOTH_ARMS_PROBABILITY = {
    'stand': 0.32,
    'idle': 0.65,
    'lie': 0.0,
    'stoop': 0.15,
    'sit': 0.25,
    'sit_on_floor': 0.25,
    'walk': 0.1,
}
_SITTING = ((0.4, 'rest'), (0.15, 'habit'), (0.25, 'reach'), (0.15, 'touch'), (0.05, 'any'))
_STANDING = ((0.3, 'hang'), (0.2, 'habit'), (0.25, 'reach'), (0.15, 'touch'), (0.1, 'any'))
_ONE_ARM_GESTURES: dict[str, tuple[tuple[float, str], ...]] = {
    'stand': _STANDING,
    'idle': _STANDING,
    'lie': ((0.8, 'hang'), (0.2, 'touch')),
    'stoop': ((0.6, 'down'), (0.1, 'hang'), (0.1, 'reach'), (0.15, 'touch'), (0.05, 'any')),
    'sit': _SITTING,
    'sit_on_floor': _SITTING,
    'walk': ((0.75, 'keep'), (0.08, 'habit'), (0.1, 'reach'), (0.07, 'touch')),
}


def _sample_one(
    collision_body: CollisionBody, angles: _Angles, side: int, gesture: str, stream: RandomStream
) -> None:
    if gesture == 'keep':
        return
    prefix = _PREFIXES[side]
    sample_posture(angles, prefix, ARM_ANGLES, HANGING, stream)
    if gesture == 'habit':
        sample_posture(angles, prefix, ARM_ANGLES, stream.choose(ARM_POSTURES), stream)
    elif gesture == 'any':
        for name in ARM_ANGLES:
            number = ANGLE_NUMBERS[prefix + name]
            angles[number] = stream.between(LOWER_LIMITS[number], UPPER_LIMITS[number])
    elif gesture == 'reach':
        reach_freely(collision_body.rig, angles, side, stream)
    elif gesture == 'down':
        reach_down(collision_body.rig, angles, side, stream)
    elif gesture in ('touch', 'rest'):
        targets = SITTING_TOUCH_TARGETS if gesture == 'rest' else TOUCH_TARGETS
        touch_body(collision_body, angles, side, stream.choose(targets), stream)


def _sample_both(
    collision_body: CollisionBody, lower_body: BodyPose, stream: RandomStream
) -> None:
    kind, angles = lower_body
    gesture = stream.choose(((0.55, 'hand_pair'), (0.32, 'posture'), (0.13, 'touch')))
    if gesture == 'hand_pair':
        pairs = IDLE_HAND_PAIRS if kind == 'idle' else HAND_PAIRS
        move_hand_pair(collision_body.rig, angles, stream.choose(pairs), stream)
        return
    posture = stream.choose(_IDLE_POSTURES if kind == 'idle' else _BOTH_POSTURES)
    target = stream.choose(SITTING_TOUCH_TARGETS if kind.startswith('sit') else TOUCH_TARGETS)
    for side in (0, 1):
        sample_posture(angles, _PREFIXES[side], ARM_ANGLES, posture, stream)
    if stream.bernoulli(0.5):  # nearly symmetric
        angles[ARMS[1]] = angles[ARMS[0]] + 0.2 * (angles[ARMS[1]] - angles[ARMS[0]])
    if gesture == 'touch':
        for side in (0, 1):
            touch_body(collision_body, angles, side, target, stream)
