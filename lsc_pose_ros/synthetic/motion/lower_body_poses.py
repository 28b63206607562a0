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

"""Poses of trunk and legs: standing, stepping, squatting, sitting, kneeling, kicking, walking.

Standing people keep their centre of mass above the feet.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.body.bone_rotations import Rig
from lsc_pose_ros.synthetic.motion.foot_placement import (
    FootPlacement,
    place_feet,
    place_under_mass,
)
from lsc_pose_ros.synthetic.motion.gait import stride_angles
from lsc_pose_ros.synthetic.motion.habitual_postures import Posture, sample_posture
from lsc_pose_ros.synthetic.motion.joint_angles import (
    ANGLE_NUMBERS,
    ANGLES,
    ARMS,
    LEG_ANGLES,
    TRUNK_ANGLES,
)
from lsc_pose_ros.synthetic.sampling import RandomStream

_Angles = NDArray[np.float64]


_TRUNK_POSTURES: tuple[tuple[float, Posture], ...] = (
    (0.62, {
        'lean': (1, 3), 'list': (0, 2), 'bend': (3, 7), 'side': (0, 5), 'twist': (0, 10),
        'nod': (5, 13), 'tilt': (0, 7), 'turn': (0, 24),
    }),
    (0.12, {'lean': (10, 8), 'bend': (25, 14), 'twist': (0, 14), 'nod': (-5, 18),
            'turn': (0, 25)}),
    (0.10, {'list': (0, 7), 'side': (0, 16), 'twist': (0, 14), 'tilt': (0, 12),
            'turn': (0, 28)}),
    (0.12, {'lean': (4, 6), 'list': (0, 3), 'twist': (0, 24), 'bend': (8, 12), 'side': (0, 8),
            'turn': (0, 36)}),
    (0.04, {'lean': (-8, 6), 'bend': (-12, 7), 'nod': (-10, 15), 'turn': (0, 25)}),
)  # fmt: skip

# The lifted leg of a person who stands on one leg.
_LIFTED_LEG_POSTURES: tuple[tuple[float, Posture], ...] = (
    (0.30, {  # knee raised
        'hip_flexion': (65, 24), 'hip_abduction': (8, 12), 'hip_rotation': (5, 14),
        'knee': (85, 26), 'ankle': (15, 12),
    }),
    (0.20, {  # kick
        'hip_flexion': (58, 22), 'hip_abduction': (5, 10), 'knee': (15, 12), 'ankle': (15, 12),
    }),
    (0.16, {  # sideways
        'hip_flexion': (8, 14), 'hip_abduction': (36, 9), 'hip_rotation': (8, 12),
        'knee': (12, 14), 'ankle': (10, 10),
    }),
    (0.16, {  # behind
        'hip_flexion': (-14, 7), 'hip_abduction': (5, 6), 'knee': (55, 35), 'ankle': (20, 15),
    }),
    (0.08, {  # foot at the other knee
        'hip_flexion': (60, 12), 'hip_abduction': (36, 8), 'hip_rotation': (36, 6),
        'knee': (105, 12), 'ankle': (20, 10),
    }),
    (0.10, {
        'hip_flexion': (40, 45), 'hip_abduction': (12, 20), 'hip_rotation': (5, 25),
        'knee': (65, 45), 'ankle': (10, 18),
    }),
)  # fmt: skip


class BodyPose(NamedTuple):
    """A pose and its kind.

    Attributes:
        kind: 'stand', 'idle', 'stoop', 'sit' (on a seat), 'sit_on_floor', 'lie' or 'walk';
            decides which arm gestures are likely.
        angles: in the order of ANGLES, radians, shape (A,); not always within limits.
    """

    kind: str
    angles: _Angles


def sample_lower_body(
    rig: Rig, stream: RandomStream, kinds: 'LowerBodyKinds | None' = None
) -> BodyPose:
    """Sample the pose of trunk and legs; the arms hang, or swing in a walking person.

    Args:
        rig: the person's rig.
        stream: the source of randomness.
        kinds: the kinds of poses; None samples all of them, mostly standing.
    """
    angles = np.zeros(len(ANGLES))
    let_arms_hang(angles)
    sample_posture(angles, '', TRUNK_ANGLES, stream.choose(_TRUNK_POSTURES), stream)
    kind, sample_kind = stream.choose(kinds or _LOWER_BODY_KINDS)
    sample_kind(rig, angles, stream)
    return BodyPose(kind, angles)


def let_arms_hang(angles: _Angles) -> None:
    """Set the arms of a pose, in place, to hang at the sides."""
    for arm, prefix in zip(ARMS, ('l_', 'r_'), strict=True):
        angles[arm] = 0.0
        angles[ANGLE_NUMBERS[f'{prefix}elevation']] = np.radians(12)


def _set(angles: _Angles, **degrees: float) -> None:
    for name, value in degrees.items():
        angles[ANGLE_NUMBERS[name]] = np.radians(value)


def _stand_at_ease(rig: Rig, angles: _Angles, stream: RandomStream) -> None:
    """Stand with the feet side by side, sometimes with the weight on one leg."""
    width = abs(stream.normal(0.12, 0.05)) + 0.03
    split = stream.normal(0.0, 0.05)
    stretch = 1 - abs(stream.normal(0.0, 0.006))
    feet = (_foot(width, split, stream), _foot(width, -split, stream))
    place_under_mass(rig, angles, feet, stretch, shift=stream.normal(0.0, 0.35) * width)


def _stand_apart(rig: Rig, angles: _Angles, stream: RandomStream) -> None:
    width = stream.between(0.15, 0.5)
    split = stream.normal(0.0, 0.1)
    stretch = 1 - abs(stream.normal(0.0, 0.02))
    feet = (_foot(width, split, stream, 14), _foot(width, -split, stream, 14))
    place_under_mass(rig, angles, feet, stretch, shift=stream.normal(0.0, 0.4) * width)


def _stand_in_stride(rig: Rig, angles: _Angles, stream: RandomStream) -> None:
    """Stand with one foot well ahead of the other, sometimes with a lifted heel."""
    split = stream.between(0.1, 0.32)
    width = abs(stream.normal(0.08, 0.06))
    heel = stream.between(0, 40) * stream.uniform()
    stretch = 1 - abs(stream.normal(0.0, 0.02))
    feet = (_foot(width, split, stream), _foot(width, -split, stream, 10, heel))
    place_under_mass(rig, angles, feet, stretch, ahead=stream.normal(0.0, 0.4) * split)


def _lunge(rig: Rig, angles: _Angles, stream: RandomStream) -> None:
    split = stream.between(0.35, 0.6)
    width = abs(stream.normal(0.08, 0.06))
    if stream.bernoulli(0.25):  # sideways
        width, split = split, width
    heel = stream.between(20, 55)
    stretch = stream.between(0.82, 0.98)
    feet = (_foot(width, split, stream), _foot(width, -split, stream, 8, heel))
    place_under_mass(rig, angles, feet, stretch, ahead=stream.between(-0.2, 0.5) * split)


def _squat(rig: Rig, angles: _Angles, stream: RandomStream) -> None:
    """Bend both legs equally, with the trunk leaned forwards for balance."""
    stretch = 0.95 - 0.62 * stream.uniform()
    lean = (1 - stretch) * stream.between(30, 75)
    _set(angles, lean=lean, bend=stream.between(0, 30), nod=stream.normal(-0.4 * lean, 12))
    width = stream.between(0.1, 0.32)
    split = stream.normal(0.0, 0.04)
    feet = (
        _foot(width, split, stream, 20),
        _foot(width, -split, stream, 20),
    )
    place_under_mass(rig, angles, feet, stretch)


def _stoop(rig: Rig, angles: _Angles, stream: RandomStream) -> None:
    """Bend down, from the hips or with the back."""
    lean = stream.between(15, 85)
    _set(angles, lean=lean, bend=stream.between(5, 55), nod=stream.normal(-10, 20))
    width = stream.between(0.06, 0.25)
    split = stream.normal(0.0, 0.12)
    stretch = 1 - 0.35 * stream.uniform() ** 2
    feet = (_foot(width, split, stream), _foot(width, -split, stream))
    place_under_mass(rig, angles, feet, stretch)


def _stand_on_one_leg(rig: Rig, angles: _Angles, stream: RandomStream) -> None:
    feet = (_foot(0.0, 0.0, stream), _foot(0.15, 0.0, stream))
    place_under_mass(rig, angles, feet, 1 - abs(stream.normal(0.0, 0.02)), shift=0.02)
    sample_posture(angles, 'r_', LEG_ANGLES, stream.choose(_LIFTED_LEG_POSTURES), stream)


def _walk(rig: Rig, angles: _Angles, stream: RandomStream) -> None:  # noqa: ARG001
    running = stream.choose(((0.5, 0.0), (0.2, 0.5), (0.3, 1.0)))
    gait = stride_angles(
        stream.uniform(), running, stream.between(0.6, 1.2), np.radians(stream.normal(0, 10))
    )
    for name in TRUNK_ANGLES:  # keeps half of the trunk's variation
        gait[ANGLE_NUMBERS[name]] += 0.5 * angles[ANGLE_NUMBERS[name]]
    angles[:] = gait


def _sit(rig: Rig, angles: _Angles, stream: RandomStream) -> None:
    """Sit on a seat between about knee height and bar-stool height."""
    upright = stream.normal(0, 1)
    _set(angles, lean=12 * upright - 6, bend=stream.normal(14 - 6 * upright, 8),
         nod=stream.normal(5, 14))  # fmt: skip
    if stream.bernoulli(0.2):  # forwards, elbows on the knees, say
        _set(angles, lean=stream.between(10, 40), bend=stream.between(10, 40))
    length = rig.leg[0] + rig.leg[1]
    height = rig.leg[1] * stream.between(0.82, 1.22) + rig.leg[2]
    width = stream.between(0.03, 0.26)
    feet = []
    for _ in range(2):
        # The feet are below the knees, drawn back, or forwards.
        ahead = rig.leg[0] / length + stream.normal(0.02, 0.12)
        feet.append(_foot(width + stream.normal(0.0, 0.03), ahead, stream, 12))
    if stream.bernoulli(0.6):
        feet[1] = feet[1]._replace(ahead=feet[0].ahead)
    place_feet(rig, angles, (feet[0], feet[1]), height)
    _cross_legs(angles, stream)


def _cross_legs(angles: _Angles, stream: RandomStream) -> None:
    """Sometimes put the right leg over the left one."""
    crossing = stream.choose(((0.78, 'none'), (0.1, 'ankle'), (0.12, 'knee')))
    if crossing == 'ankle':
        sample_posture(angles, 'r_', LEG_ANGLES, _ANKLE_ON_KNEE, stream)
    elif crossing == 'knee':
        sample_posture(angles, 'r_', LEG_ANGLES, _KNEE_ON_KNEE, stream)


_ANKLE_ON_KNEE: Posture = {
    'hip_flexion': (88, 8), 'hip_abduction': (30, 6), 'hip_rotation': (40, 4), 'knee': (100, 8),
    'ankle': (10, 8),
}  # fmt: skip
_KNEE_ON_KNEE: Posture = {
    'hip_flexion': (104, 5), 'hip_abduction': (-13, 3), 'hip_rotation': (-5, 6),
    'knee': (88, 10), 'ankle': (20, 10),
}  # fmt: skip


def _sit_on_floor(rig: Rig, angles: _Angles, stream: RandomStream) -> None:
    _set(angles, lean=stream.normal(-8, 8), bend=stream.normal(20, 10), nod=stream.normal(0, 12))
    height = 0.2 * rig.leg[0] + 0.06 * (rig.leg[0] + rig.leg[1])
    if stream.bernoulli(0.4):  # cross-legged
        for side in ('l_', 'r_'):
            _set(angles, **{f'{side}hip_flexion': stream.normal(95, 6),
                            f'{side}hip_abduction': stream.normal(42, 4),
                            f'{side}hip_rotation': stream.normal(40, 4),
                            f'{side}knee': stream.normal(120, 8), f'{side}ankle': 20})  # fmt: skip
        _set(angles, r_hip_flexion=stream.normal(108, 5))
        return
    feet = [_foot(stream.between(0.06, 0.3), stream.between(0.5, 0.97), stream, 8)
            for _ in range(2)]  # fmt: skip
    place_feet(rig, angles, (feet[0], feet[1]), height)


def _kneel(rig: Rig, angles: _Angles, stream: RandomStream) -> None:
    """Kneel on the right knee with the left foot ahead, or on both knees."""
    height = rig.leg[0] + 0.12 * rig.leg[0]
    length = rig.leg[0] + rig.leg[1]
    both = stream.bernoulli(0.4)
    thigh = stream.normal(2, 6) + (stream.between(0, 45) if both else 0.0)
    lean = np.degrees(angles[ANGLE_NUMBERS['lean']])
    placement = _foot(0.1, rig.leg[0] / length + stream.normal(0.0, 0.08), stream, 8)
    place_feet(rig, angles, (placement, placement), height)
    for side in ('l_', 'r_') if both else ('r_',):
        _set(angles, **{f'{side}hip_flexion': lean + thigh,
                        f'{side}hip_abduction': stream.normal(7, 4),
                        f'{side}hip_rotation': 0.0, f'{side}knee': 88 + thigh,
                        f'{side}ankle': stream.between(-25, 45)})  # fmt: skip


def _lie(_rig: Rig, angles: _Angles, stream: RandomStream) -> None:
    """Lie with stretched legs, or with one or both knees raised; `lying_rotation` turns it."""
    _set(angles, lean=0.0, list=0.0, bend=stream.normal(8, 8), nod=stream.normal(10, 12))
    for side in ('l_', 'r_'):
        raised = stream.between(30, 80) if stream.bernoulli(0.3) else stream.normal(8, 8)
        _set(angles, **{f'{side}hip_flexion': raised, f'{side}knee': 1.6 * abs(raised),
                        f'{side}hip_abduction': stream.normal(6, 6),
                        f'{side}hip_rotation': stream.normal(10, 14),
                        f'{side}ankle': stream.normal(25, 12)})  # fmt: skip


_Sampler = Callable[[Rig, _Angles, RandomStream], None]

LowerBodyKinds = tuple[tuple[float, tuple[str, _Sampler]], ...]
"""Kinds of poses, each with its frequency."""

_LOWER_BODY_KINDS: LowerBodyKinds = (
    (0.40, ('stand', _stand_at_ease)), (0.09, ('stand', _stand_apart)),
    (0.08, ('stand', _stand_in_stride)), (0.06, ('stand', _lunge)), (0.07, ('stand', _squat)),
    (0.06, ('stoop', _stoop)), (0.07, ('stand', _stand_on_one_leg)), (0.07, ('walk', _walk)),
    (0.07, ('sit', _sit)), (0.012, ('sit_on_floor', _sit_on_floor)), (0.018, ('stand', _kneel)),
)  # fmt: skip

AFOOT_KINDS: LowerBodyKinds = (
    (0.16, ('stand', _stand_at_ease)), (0.18, ('idle', _stand_at_ease)),
    (0.07, ('idle', _stand_apart)), (0.09, ('stand', _stand_in_stride)),
    (0.04, ('stand', _lunge)), (0.1, ('stand', _squat)),
    (0.13, ('stoop', _stoop)), (0.04, ('stand', _stand_on_one_leg)), (0.1, ('walk', _walk)),
    (0.03, ('sit_on_floor', _sit_on_floor)), (0.06, ('stand', _kneel)),
)  # fmt: skip
"""Poses of people in furnished rooms who do not sit on a seat: more of them are bent."""

SEATED_KINDS: LowerBodyKinds = ((1.0, ('sit', _sit)),)
"""Poses of people who sit on a seat."""

LYING_KINDS: LowerBodyKinds = ((1.0, ('lie', _lie)),)
"""Poses of people who lie."""


def _foot(
    lateral: float, ahead: float, stream: RandomStream, heading: float = 8.0, heel: float = 0.0
) -> FootPlacement:
    """Return a placement, toes out by about `heading`, heel lifted by `heel`, degrees."""
    return FootPlacement(
        lateral, ahead, float(np.radians(stream.normal(heading, 8))), float(np.radians(heel))
    )
