"""Key poses: what people do with arms, legs and back.

A key pose is put together from what each of these does: a habitual posture with some scatter, or
anything at all that joints allow.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data.synthetic.pose import (
    ANGLE_NUMBERS,
    ANGLES,
    ARM_ANGLES,
    LEG_ANGLES,
    TRUNK_ANGLES,
    limits,
    within_limits,
)

_Posture = dict[str, tuple[float, float]]  # angle: mean and scatter, degrees

# How often, and what. An angle that is not named is 0 with a scatter of 8 degrees.
_ARM_POSTURES: tuple[tuple[float, _Posture], ...] = (
    (0.18, {  # hanging
        'plane': (20, 25), 'elevation': (14, 6), 'axial': (-10, 20), 'elbow': (15, 10),
        'pronation': (20, 30),
    }),
    (0.09, {  # held out sideways
        'plane': (0, 15), 'elevation': (85, 20), 'axial': (10, 35), 'elbow': (15, 15),
        'pronation': (20, 40),
    }),
    (0.11, {  # reaching forwards
        'plane': (78, 18), 'elevation': (80, 22), 'axial': (-10, 25), 'elbow': (25, 25),
        'pronation': (30, 40),
    }),
    (0.08, {  # overhead
        'plane': (40, 30), 'elevation': (150, 15), 'axial': (10, 25), 'elbow': (25, 25),
    }),
    (0.09, {  # waving
        'plane': (15, 20), 'elevation': (65, 18), 'axial': (75, 15), 'elbow': (90, 25),
        'pronation': (30, 30),
    }),
    (0.05, {  # hand on the hip
        'plane': (-15, 10), 'elevation': (42, 6), 'axial': (-48, 8), 'elbow': (92, 8),
        'wrist_flexion': (20, 15),
    }),
    (0.06, {  # hand to the face
        'plane': (65, 15), 'elevation': (58, 15), 'axial': (-15, 12), 'elbow': (122, 12),
    }),
    (0.10, {  # across the chest
        'plane': (75, 15), 'elevation': (55, 18), 'axial': (-50, 12), 'elbow': (75, 22),
    }),
    (0.08, {  # forearm forwards
        'plane': (40, 30), 'elevation': (20, 10), 'axial': (-5, 25), 'elbow': (85, 22),
        'pronation': (10, 50),
    }),
)  # fmt: skip
_LEG_POSTURES: tuple[tuple[float, _Posture], ...] = (
    (0.55, {  # standing
        'hip_flexion': (3, 5), 'hip_abduction': (5, 5), 'hip_rotation': (8, 8), 'knee': (5, 5),
        'ankle': (0, 3),
    }),
    (0.12, {  # apart
        'hip_flexion': (5, 6), 'hip_abduction': (18, 8), 'hip_rotation': (12, 10),
        'knee': (8, 8), 'ankle': (0, 4),
    }),
    (0.10, {  # a step forwards
        'hip_flexion': (25, 10), 'hip_abduction': (4, 4), 'knee': (15, 12), 'ankle': (0, 6),
    }),
    (0.08, {  # a step backwards
        'hip_flexion': (-14, 6), 'hip_abduction': (4, 4), 'knee': (15, 10), 'ankle': (8, 8),
    }),
    (0.10, {  # the knee lifted
        'hip_flexion': (65, 20), 'hip_abduction': (8, 10), 'knee': (80, 25), 'ankle': (15, 10),
    }),
    (0.05, {  # a kick
        'hip_flexion': (55, 15), 'hip_abduction': (8, 8), 'knee': (15, 12), 'ankle': (10, 10),
    }),
)  # fmt: skip
_TRUNK_POSTURES: tuple[tuple[float, _Posture], ...] = (
    (0.70, {
        'lean': (1, 2), 'bend': (2, 6), 'side': (0, 5), 'twist': (0, 10), 'nod': (4, 12),
        'tilt': (0, 7), 'turn': (0, 22),
    }),
    (0.12, {'lean': (8, 6), 'bend': (30, 14), 'nod': (-5, 15), 'turn': (0, 20)}),
    (0.09, {'side': (0, 18), 'twist': (0, 14), 'tilt': (0, 12), 'turn': (0, 25)}),
    (0.09, {'twist': (0, 26), 'bend': (5, 10), 'turn': (0, 35)}),
)  # fmt: skip
_ANY_ARM = 0.16  # how often an arm does anything at all
_CROUCH = 0.12  # how often both legs bend together


def draw_key(random: np.random.Generator) -> NDArray[np.float64]:
    """Draw a key pose within what joints allow, radians, shape (A,)."""
    # All chances are drawn first and in one order: the same seed gives the same pose whatever
    # is chosen on the way.
    choices = random.random(8)
    scatter = _normal(random, len(ANGLES))
    uniform = random.random(len(ANGLES))
    low, high = limits()
    angles = np.zeros(len(ANGLES))

    def fill(prefix: str, names: tuple[str, ...], posture: _Posture) -> None:
        for name in names:
            number = ANGLE_NUMBERS[prefix + name]
            mean, deviation = posture.get(name, (0.0, 8.0))
            angles[number] = np.radians(mean + deviation * scatter[number])

    fill('', TRUNK_ANGLES, _choose(_TRUNK_POSTURES, choices[0]))
    for side, arm, anything, leg in (('l_', 1, 2, 3), ('r_', 4, 5, 6)):
        fill(side, ARM_ANGLES, _choose(_ARM_POSTURES, choices[arm]))
        if choices[anything] < _ANY_ARM:
            numbers = [ANGLE_NUMBERS[side + name] for name in ARM_ANGLES]
            angles[numbers] = (low + uniform * (high - low))[numbers]
        # One leg stands.
        stands = choices[7] < 0.5 if side == 'l_' else choices[7] >= 0.5
        postures = _LEG_POSTURES[:1] if stands else _LEG_POSTURES
        fill(side, LEG_ANGLES, _choose(postures, choices[leg]))
    if choices[7] % 0.5 < 0.5 * _CROUCH:
        _crouch(angles, uniform)
    return within_limits(angles)


def _crouch(angles: NDArray[np.float64], uniform: NDArray[np.float64]) -> None:
    """Bend both legs alike, with the trunk brought forwards so that the person does not fall."""
    depth = uniform[ANGLE_NUMBERS['lean']]
    thigh = np.radians(20 + 55 * depth)  # from the vertical, forwards
    shank = 0.5 * thigh  # backwards
    lean = 0.35 * thigh
    angles[ANGLE_NUMBERS['lean']] = lean
    for side in ('l', 'r'):
        apart = uniform[ANGLE_NUMBERS['l_hip_abduction']]
        angles[ANGLE_NUMBERS[f'{side}_hip_flexion']] = thigh + lean
        angles[ANGLE_NUMBERS[f'{side}_hip_abduction']] = np.radians(4 + 20 * apart)
        angles[ANGLE_NUMBERS[f'{side}_knee']] = thigh + shank
        angles[ANGLE_NUMBERS[f'{side}_ankle']] = -shank


def _choose(postures: tuple[tuple[float, _Posture], ...], chance: float) -> _Posture:
    """Return the posture into whose share `chance`, uniform in [0, 1), falls."""
    total = sum(share for share, _ in postures)
    for share, posture in postures:
        chance -= share / total
        if chance < 0:
            return posture
    return postures[-1][1]


def _normal(random: np.random.Generator, count: int) -> NDArray[np.float64]:
    """Draw normal numbers cut off at two deviations, as sums of twelve uniform ones."""
    return np.asarray(np.clip(random.random((12, count)).sum(axis=0) - 6.0, -2.0, 2.0))
