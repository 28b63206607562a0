"""What people do with trunk and legs: stand, step, squat, sit, kneel, kick, walk.

Who stands keeps the centre of mass over the feet.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.body.bone_rotations import (
    Rig,
    about_x,
    about_z,
    bone_heads,
    bone_turns,
    product,
    turned,
)
from lsc_pose_ros.synthetic.motion.gait import stride_angles
from lsc_pose_ros.synthetic.motion.habitual_postures import Posture, fill
from lsc_pose_ros.synthetic.motion.inverse_kinematics import Foot, plant
from lsc_pose_ros.synthetic.motion.joint_angles import (
    ANGLE_NUMBERS,
    ANGLES,
    ARMS,
    LEG_ANGLES,
    LEGS,
    TRUNK_ANGLES,
)
from lsc_pose_ros.synthetic.sampling import Chances

_Angles = NDArray[np.float64]


class Step(NamedTuple):
    """Where a foot is put down.

    Attributes:
        aside: outwards from the middle between the feet, in leg lengths.
        ahead: forwards from there, in leg lengths.
        heading: where the toes point, radians, positive to the outside.
        pitch: how far the heel is lifted, radians.
    """

    aside: float
    ahead: float
    heading: float
    pitch: float = 0.0


_TRUNKS: tuple[tuple[float, Posture], ...] = (
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

# The leg that does not stand.
_LIFTED: tuple[tuple[float, Posture], ...] = (
    (0.30, {  # the knee raised
        'hip_flexion': (65, 24), 'hip_abduction': (8, 12), 'hip_rotation': (5, 14),
        'knee': (85, 26), 'ankle': (15, 12),
    }),
    (0.20, {  # a kick
        'hip_flexion': (58, 22), 'hip_abduction': (5, 10), 'knee': (15, 12), 'ankle': (15, 12),
    }),
    (0.16, {  # aside
        'hip_flexion': (8, 14), 'hip_abduction': (36, 9), 'hip_rotation': (8, 12),
        'knee': (12, 14), 'ankle': (10, 10),
    }),
    (0.16, {  # behind
        'hip_flexion': (-14, 7), 'hip_abduction': (5, 6), 'knee': (55, 35), 'ankle': (20, 15),
    }),
    (0.08, {  # the foot at the other knee
        'hip_flexion': (60, 12), 'hip_abduction': (36, 8), 'hip_rotation': (36, 6),
        'knee': (105, 12), 'ankle': (20, 10),
    }),
    (0.10, {
        'hip_flexion': (40, 45), 'hip_abduction': (12, 20), 'hip_rotation': (5, 25),
        'knee': (65, 45), 'ankle': (10, 18),
    }),
)  # fmt: skip


class Stance(NamedTuple):
    """What trunk and legs do.

    Attributes:
        kind: 'stand', 'stoop', 'sit' or 'walk'; who walks swings the arms, others let them hang.
        angles: in the order of ANGLES, radians, shape (A,); not always within limits.
    """

    kind: str
    angles: _Angles


def draw_stance(rig: Rig, chances: Chances) -> Stance:
    """Draw what trunk and legs do.

    Args:
        rig: the person's.
        chances: the source of chance.
    """
    angles = np.zeros(len(ANGLES))
    let_arms_hang(angles)
    fill(angles, '', TRUNK_ANGLES, chances.choose(_TRUNKS), chances)
    kind, take = chances.choose(_STANCES)
    take(rig, angles, chances)
    return Stance(kind, angles)


def let_arms_hang(angles: _Angles) -> None:
    """Set the arms of a pose, in place, as if they hung at the sides."""
    for arm, prefix in zip(ARMS, ('l_', 'r_'), strict=True):
        angles[arm] = 0.0
        angles[ANGLE_NUMBERS[f'{prefix}elevation']] = np.radians(12)


def _set(angles: _Angles, **degrees: float) -> None:
    for name, value in degrees.items():
        angles[ANGLE_NUMBERS[name]] = np.radians(value)


def _at_ease(rig: Rig, angles: _Angles, chances: Chances) -> None:
    """Stand with the feet next to each other, the weight now and then on one leg."""
    width = abs(chances.near(0.12, 0.05)) + 0.03
    split = chances.near(0.0, 0.05)
    stretch = 1 - abs(chances.near(0.0, 0.006))
    _stand(rig, angles, (_step(width, split, chances), _step(width, -split, chances)), stretch,
           shift=chances.near(0.0, 0.35) * width)  # fmt: skip


def _apart(rig: Rig, angles: _Angles, chances: Chances) -> None:
    width = chances.between(0.15, 0.5)
    split = chances.near(0.0, 0.1)
    stretch = 1 - abs(chances.near(0.0, 0.02))
    _stand(rig, angles, (_step(width, split, chances, 14), _step(width, -split, chances, 14)),
           stretch, shift=chances.near(0.0, 0.4) * width)  # fmt: skip


def _stride(rig: Rig, angles: _Angles, chances: Chances) -> None:
    """Stand with one foot well before the other, its heel perhaps lifted."""
    split = chances.between(0.1, 0.32)
    width = abs(chances.near(0.08, 0.06))
    heel = chances.between(0, 40) * chances.share()
    stretch = 1 - abs(chances.near(0.0, 0.02))
    _stand(rig, angles, (_step(width, split, chances), _step(width, -split, chances, 10, heel)),
           stretch, ahead=chances.near(0.0, 0.4) * split)  # fmt: skip


def _lunge(rig: Rig, angles: _Angles, chances: Chances) -> None:
    split = chances.between(0.35, 0.6)
    width = abs(chances.near(0.08, 0.06))
    if chances.happens(0.25):  # sideways
        width, split = split, width
    heel = chances.between(20, 55)
    stretch = chances.between(0.82, 0.98)
    _stand(rig, angles, (_step(width, split, chances), _step(width, -split, chances, 8, heel)),
           stretch, ahead=chances.between(-0.2, 0.5) * split)  # fmt: skip


def _squat(rig: Rig, angles: _Angles, chances: Chances) -> None:
    """Bend both legs alike, the trunk brought forwards so that the person does not fall."""
    stretch = 0.95 - 0.62 * chances.share()
    lean = (1 - stretch) * chances.between(30, 75)
    _set(angles, lean=lean, bend=chances.between(0, 30), nod=chances.near(-0.4 * lean, 12))
    width = chances.between(0.1, 0.32)
    split = chances.near(0.0, 0.04)
    steps = (_step(width, split, chances, 20), _step(width, -split, chances, 20))
    _stand(rig, angles, steps, stretch)


def _stoop(rig: Rig, angles: _Angles, chances: Chances) -> None:
    """Bend down, more from the hips or more with the back."""
    lean = chances.between(15, 85)
    _set(angles, lean=lean, bend=chances.between(5, 55), nod=chances.near(-10, 20))
    width = chances.between(0.06, 0.25)
    split = chances.near(0.0, 0.12)
    stretch = 1 - 0.35 * chances.share() ** 2
    _stand(rig, angles, (_step(width, split, chances), _step(width, -split, chances)), stretch)


def _one_leg(rig: Rig, angles: _Angles, chances: Chances) -> None:
    steps = (_step(0.0, 0.0, chances), _step(0.15, 0.0, chances))
    _stand(rig, angles, steps, 1 - abs(chances.near(0.0, 0.02)), shift=0.02)
    fill(angles, 'r_', LEG_ANGLES, chances.choose(_LIFTED), chances)


def _walk(rig: Rig, angles: _Angles, chances: Chances) -> None:  # noqa: ARG001
    running = chances.choose(((0.5, 0.0), (0.2, 0.5), (0.3, 1.0)))
    gait = stride_angles(
        chances.share(), running, chances.between(0.6, 1.2), np.radians(chances.near(0, 10))
    )
    for name in TRUNK_ANGLES:  # the trunk's own scatter stays
        gait[ANGLE_NUMBERS[name]] += 0.5 * angles[ANGLE_NUMBERS[name]]
    angles[:] = gait


def _sit(rig: Rig, angles: _Angles, chances: Chances) -> None:
    """Sit on whatever is so high that the hips are from knee-high to bar-stool-high."""
    upright = chances.near(0, 1)
    _set(angles, lean=12 * upright - 6, bend=chances.near(14 - 6 * upright, 8),
         nod=chances.near(5, 14))  # fmt: skip
    if chances.happens(0.2):  # forwards, elbows on the knees, say
        _set(angles, lean=chances.between(10, 40), bend=chances.between(10, 40))
    length = rig.leg[0] + rig.leg[1]
    height = rig.leg[1] * chances.between(0.82, 1.22) + rig.leg[2]
    width = chances.between(0.03, 0.26)
    feet = []
    for _ in range(2):
        # Feet under the knees, or drawn back, or put forwards.
        ahead = rig.leg[0] / length + chances.near(0.02, 0.12)
        feet.append(_step(width + chances.near(0.0, 0.03), ahead, chances, 12))
    if chances.happens(0.6):
        feet[1] = feet[1]._replace(ahead=feet[0].ahead)
    _plant(rig, angles, (feet[0], feet[1]), height)
    _cross_legs(angles, chances)


def _cross_legs(angles: _Angles, chances: Chances) -> None:
    """Put the right leg over the left one, sometimes."""
    way = chances.choose(((0.78, 'not'), (0.1, 'ankle'), (0.12, 'knee')))
    if way == 'ankle':
        fill(angles, 'r_', LEG_ANGLES, _ANKLE_ON_KNEE, chances)
    elif way == 'knee':
        fill(angles, 'r_', LEG_ANGLES, _KNEE_ON_KNEE, chances)


_ANKLE_ON_KNEE: Posture = {
    'hip_flexion': (88, 8), 'hip_abduction': (30, 6), 'hip_rotation': (40, 4), 'knee': (100, 8),
    'ankle': (10, 8),
}  # fmt: skip
_KNEE_ON_KNEE: Posture = {
    'hip_flexion': (104, 5), 'hip_abduction': (-13, 3), 'hip_rotation': (-5, 6),
    'knee': (88, 10), 'ankle': (20, 10),
}  # fmt: skip


def _sit_on_floor(rig: Rig, angles: _Angles, chances: Chances) -> None:
    _set(angles, lean=chances.near(-8, 8), bend=chances.near(20, 10), nod=chances.near(0, 12))
    height = 0.2 * rig.leg[0] + 0.06 * (rig.leg[0] + rig.leg[1])
    if chances.happens(0.4):  # cross-legged
        for side in ('l_', 'r_'):
            _set(angles, **{f'{side}hip_flexion': chances.near(95, 6),
                            f'{side}hip_abduction': chances.near(42, 4),
                            f'{side}hip_rotation': chances.near(40, 4),
                            f'{side}knee': chances.near(120, 8), f'{side}ankle': 20})  # fmt: skip
        _set(angles, r_hip_flexion=chances.near(108, 5))
        return
    feet = [_step(chances.between(0.06, 0.3), chances.between(0.5, 0.97), chances, 8)
            for _ in range(2)]  # fmt: skip
    _plant(rig, angles, (feet[0], feet[1]), height)


def _kneel(rig: Rig, angles: _Angles, chances: Chances) -> None:
    """Kneel on the right knee, the left foot put forwards, or on both knees."""
    height = rig.leg[0] + 0.12 * rig.leg[0]
    length = rig.leg[0] + rig.leg[1]
    both = chances.happens(0.4)
    thigh = chances.near(2, 6) + (chances.between(0, 45) if both else 0.0)
    lean = np.degrees(angles[ANGLE_NUMBERS['lean']])
    step = _step(0.1, rig.leg[0] / length + chances.near(0.0, 0.08), chances, 8)
    _plant(rig, angles, (step, step), height)
    for side in ('l_', 'r_') if both else ('r_',):
        _set(angles, **{f'{side}hip_flexion': lean + thigh,
                        f'{side}hip_abduction': chances.near(7, 4),
                        f'{side}hip_rotation': 0.0, f'{side}knee': 88 + thigh,
                        f'{side}ankle': chances.between(-25, 45)})  # fmt: skip


_STANCES: tuple[tuple[float, tuple[str, Callable[[Rig, _Angles, Chances], None]]], ...] = (
    (0.40, ('stand', _at_ease)), (0.09, ('stand', _apart)), (0.08, ('stand', _stride)),
    (0.06, ('stand', _lunge)), (0.07, ('stand', _squat)), (0.06, ('stoop', _stoop)),
    (0.07, ('stand', _one_leg)), (0.07, ('walk', _walk)), (0.07, ('sit', _sit)),
    (0.012, ('sit', _sit_on_floor)), (0.018, ('stand', _kneel)),
)  # fmt: skip


def _step(
    aside: float, ahead: float, chances: Chances, heading: float = 8.0, heel: float = 0.0
) -> Step:
    """Return a step with toes turned out about `heading` and heel lifted by `heel`, degrees."""
    return Step(aside, ahead, float(np.radians(chances.near(heading, 8))), float(np.radians(heel)))


def _stand(
    rig: Rig,
    angles: _Angles,
    steps: tuple[Step, Step],
    stretch: float,
    *,
    shift: float = 0.0,
    ahead: float = 0.0,
) -> None:
    """Put both feet down under the centre of mass.

    Args:
        rig: the person's.
        angles: the trunk's are taken as they are, the legs' set.
        steps: where, from the point under the centre of mass.
        stretch: how long the straighter leg is between hip and ankle, 1 if it is straight.
        shift: how far the centre of mass is to the left of the middle, in leg lengths.
        ahead: how far before the middle, in leg lengths.
    """
    length = rig.leg[0] + rig.leg[1]
    aside, forwards = _centre_of_mass(rig, angles) / length - (shift, ahead)
    left, right = steps
    moved = (
        left._replace(aside=left.aside + aside, ahead=left.ahead + forwards),
        right._replace(aside=right.aside - aside, ahead=right.ahead + forwards),
    )
    pelvis = _pelvis_turn(angles)
    heights = []
    for step, sign in zip(moved, (1.0, -1.0), strict=True):
        hip = turned(pelvis, rig.hip * np.array([sign, 1.0, 1.0]))
        off = np.hypot(sign * step.aside * length - hip[0], step.ahead * length - hip[2])
        below = np.sqrt(max((stretch * length) ** 2 - off**2, (0.3 * length) ** 2))
        heights.append(below + _ankle_height(rig, step) - hip[1])
    _plant(rig, angles, moved, min(heights))


def _plant(rig: Rig, angles: _Angles, steps: tuple[Step, Step], height: float) -> None:
    """Put both feet down on a floor that is `height` under the pelvis, metres."""
    length = rig.leg[0] + rig.leg[1]
    pelvis = _pelvis_turn(angles)
    for side, (step, sign) in enumerate(zip(steps, (1.0, -1.0), strict=True)):
        ankle = np.array(
            [sign * step.aside * length, _ankle_height(rig, step) - height, step.ahead * length]
        )
        foot = Foot(ankle, step.heading, step.pitch)
        angles[LEGS[side]] = plant(rig, pelvis, foot, right=side == 1)


def _ankle_height(rig: Rig, step: Step) -> float:
    return float(rig.leg[2] + np.sin(step.pitch) * rig.leg[3])


def _pelvis_turn(angles: _Angles) -> NDArray[np.float64]:
    lean, tip = angles[ANGLE_NUMBERS['lean']], angles[ANGLE_NUMBERS['list']]
    return product(about_z(-tip), about_x(lean))


# Shares of the body's mass (Winter, Biomechanics and Motor Control of Human Movement, 2009).
_TRUNK_MASS, _HEAD_MASS, _ARMS_MASS, _LEGS_MASS = 0.497, 0.081, 0.1, 0.322
_LEG_CENTRE = 0.4  # where the mass of a leg is between hip and foot, shares of the way


def _centre_of_mass(rig: Rig, angles: _Angles) -> NDArray[np.float64]:
    """Return where feet have to be, to the left and forwards of the pelvis, metres, shape (2,).

    Legs whose feet are off the pelvis by c have their mass off by 0.4 c, so the whole body's is
    c = m_upper u + m_legs 0.4 c off.
    """
    turns = bone_turns(angles, rig.straight, rig.parts)
    heads = bone_heads(turns, rig.parents, rig.heads)[:, [0, 2]]
    neck, head, chest = (heads[rig.numbers[name]] for name in ('neck01', 'head', 'spine01'))
    moment = _TRUNK_MASS * 0.5 * neck + _HEAD_MASS * head + _ARMS_MASS * chest
    return np.asarray(moment / (1 - _LEGS_MASS * _LEG_CENTRE))
