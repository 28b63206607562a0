"""What people do with their arms: gestures of both, of one, hands on the own body."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.body.bone_rotations import (
    Rig,
    bone_heads,
    bone_turns,
    turned,
    turned_back,
)
from lsc_pose_ros.synthetic.body.self_collision import DEEPEST, Mannequin, pair_overlaps
from lsc_pose_ros.synthetic.motion.habitual_postures import ARM_POSTURES, HANGING, Posture, fill
from lsc_pose_ros.synthetic.motion.inverse_kinematics import REACHED, face_palm, lay_palm, reach
from lsc_pose_ros.synthetic.motion.joint_angles import (
    ANGLE_NUMBERS,
    ARM_ANGLES,
    ARMS,
    HIGHEST,
    LOWEST,
)
from lsc_pose_ros.synthetic.motion.lower_body_poses import Stance
from lsc_pose_ros.synthetic.sampling import Chances

_Vector = NDArray[np.float64]
_Angles = NDArray[np.float64]

_PREFIXES = ('l_', 'r_')
_PRONATION = ARM_ANGLES.index('pronation')
_WRIST = slice(_PRONATION + 1, _PRONATION + 3)
_FINGERS = ARM_ANGLES.index('fingers')
_MIRROR = np.array([-1.0, 1.0, 1.0])
_FAR = 0.08
"""A hand that stays farther than this from its place is better used otherwise, metres."""


class Touch(NamedTuple):
    """A place on the own body.

    Attributes:
        part: the name of capsules; `other_` are those of the other side, `own_` of the same.
        which: of several capsules of this name, from the pelvis or the trunk outwards.
        along: how far along the capsule's axis, from and to, shares.
        outwards: the way out of the flesh, at rest and for the left hand: left, up, forwards.
        scatter: of the way out.
    """

    part: str
    which: int
    along: tuple[float, float]
    outwards: tuple[float, float, float]
    scatter: float = 0.35


_TOUCHES: tuple[tuple[float, Touch], ...] = (
    (0.14, Touch('head', 0, (0, 1), (0.8, 0.0, 0.5), 0.5)),  # ear, cheek, chin, phone
    (0.06, Touch('head', 0, (0.7, 1), (0.3, 1.0, 0.2), 0.5)),
    (0.04, Touch('head', 0, (0.3, 1), (0.5, 0.1, -1.0))),
    (0.05, Touch('neck', 0, (0, 1), (0.6, 0.0, -0.6), 0.5)),
    (0.13, Touch('chest', 1, (0, 1), (0.1, 0.1, 1.0), 0.3)),
    (0.06, Touch('belly', 0, (0, 1), (0.5, 0.0, 1.0), 0.4)),
    (0.06, Touch('belly', 1, (0, 1), (0.3, 0.1, 1.0), 0.4)),
    (0.12, Touch('hips', 0, (1, 1), (0.9, 0.2, 0.2), 0.4)),
    (0.08, Touch('other_upper_arm', 0, (0, 1), (0.0, 0.3, 1.0), 0.4)),
    (0.08, Touch('other_upper_arm', 1, (0.5, 1), (0.0, 0.3, 1.0), 0.4)),
    (0.06, Touch('other_forearm', 1, (0, 1), (0.3, 0.5, 0.5), 0.6)),
    (0.05, Touch('own_thigh', 1, (0, 0.6), (0.5, 0.0, 1.0), 0.4)),
    (0.04, Touch('own_thigh', 1, (0.8, 1), (0.1, 0.1, 1.0), 0.3)),
    (0.03, Touch('other_thigh', 1, (0.5, 1), (0.0, 0.2, 1.0), 0.3)),
)  # fmt: skip
_SITTING_TOUCHES: tuple[tuple[float, Touch], ...] = (
    (0.4, Touch('own_thigh', 1, (0.1, 0.8), (0.2, 0.0, 1.0), 0.3)),
    (0.3, Touch('own_thigh', 1, (0.8, 1), (0.1, 0.1, 1.0), 0.3)),
    (0.1, Touch('other_thigh', 1, (0.3, 1), (0.0, 0.1, 1.0), 0.3)),
    (0.1, Touch('own_shank', 0, (0, 0.6), (0.3, 0.0, 1.0), 0.3)),
    (0.1, Touch('own_shank', 1, (0.4, 1), (0.4, 0.0, 1.0), 0.4)),
)


class Together(NamedTuple):
    """Where both hands are, in arm lengths from the middle between the shoulders.

    Attributes:
        middle: of both hands: left, up, forwards.
        scatter: of the middle.
        gap: between the hands, from and to.
        across: the way from the right hand to the left one: left, up, forwards.
        palms: where they face: 'in', 'ahead', 'down', 'up' or 'any'.
        fingers: how far the hands are closed, degrees.
        swivel: of the elbows, degrees.
    """

    middle: tuple[float, float, float]
    scatter: tuple[float, float, float]
    gap: tuple[float, float]
    across: tuple[float, float, float] = (1.0, 0.0, 0.0)
    palms: str = 'in'
    fingers: float = 10.0
    swivel: float = 15.0


_TOGETHER: tuple[tuple[float, Together], ...] = (
    # Clapping; pushing; lifting or shooting a ball; carrying; the bat; the golf club; guarding.
    (0.20, Together((0, -0.15, 0.55), (0.08, 0.22, 0.12), (0.07, 0.6))),
    (0.14, Together((0, -0.02, 0.8), (0.08, 0.2, 0.18), (0.3, 0.9), palms='ahead')),
    (0.14, Together((0, 0.65, 0.35), (0.1, 0.25, 0.2), (0.1, 0.9))),
    (0.12, Together((0, -0.4, 0.5), (0.12, 0.2, 0.12), (0.25, 0.9), palms='up', fingers=25)),
    (0.10, Together((0.0, 0.0, 0.6), (0.4, 0.25, 0.12), (0.12, 0.16), (0.2, 1, 0.2), 'in', 80)),
    (0.08, Together((0.0, -0.75, 0.35), (0.2, 0.12, 0.12), (0.1, 0.16), (0.3, 1, 0.3), 'in', 80)),
    (0.12, Together((0, -0.08, 0.5), (0.08, 0.12, 0.12), (0.25, 0.5), (1, 0, 0.5), 'in', 85)),
    (0.10, Together((0, -0.3, 0.3), (0.04, 0.1, 0.04), (0.35, 0.5), (-1, 0.35, 0.2), 'any', 25,
                    25)),
)  # fmt: skip

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


def draw_arms(mannequin: Mannequin, stance: Stance, chances: Chances) -> None:
    """Draw what both arms of a pose do, in place.

    Args:
        mannequin: the person's bones and flesh.
        stance: what trunk and legs do; its angles' arms are set.
        chances: the source of chance.
    """
    kind, angles = stance
    if chances.happens(_OFTEN_BOTH[kind]):
        _both(mannequin, stance, chances)
        return
    for side in (0, 1):
        _one(mannequin, angles, side, chances.choose(_ONE[kind]), chances)


_OFTEN_BOTH = {'stand': 0.32, 'stoop': 0.15, 'sit': 0.25, 'walk': 0.1}
_ONE: dict[str, tuple[tuple[float, str], ...]] = {
    'stand': ((0.3, 'hang'), (0.2, 'habit'), (0.25, 'reach'), (0.15, 'touch'), (0.1, 'any')),
    'stoop': ((0.6, 'down'), (0.1, 'hang'), (0.1, 'reach'), (0.15, 'touch'), (0.05, 'any')),
    'sit': ((0.4, 'rest'), (0.15, 'habit'), (0.25, 'reach'), (0.15, 'touch'), (0.05, 'any')),
    'walk': ((0.75, 'keep'), (0.08, 'habit'), (0.1, 'reach'), (0.07, 'touch')),
}


def _one(mannequin: Mannequin, angles: _Angles, side: int, way: str, chances: Chances) -> None:
    if way == 'keep':
        return
    prefix = _PREFIXES[side]
    fill(angles, prefix, ARM_ANGLES, HANGING, chances)
    if way == 'habit':
        fill(angles, prefix, ARM_ANGLES, chances.choose(ARM_POSTURES), chances)
    elif way == 'any':
        for name in ARM_ANGLES:
            number = ANGLE_NUMBERS[prefix + name]
            angles[number] = chances.between(LOWEST[number], HIGHEST[number])
    elif way == 'reach':
        _reach_freely(mannequin.rig, angles, side, chances)
    elif way == 'down':
        _reach_down(mannequin.rig, angles, side, chances)
    elif way in ('touch', 'rest'):
        touches = _SITTING_TOUCHES if way == 'rest' else _TOUCHES
        touch_body(mannequin, angles, side, chances.choose(touches), chances)


def _both(mannequin: Mannequin, stance: Stance, chances: Chances) -> None:
    kind, angles = stance
    way = chances.choose(((0.55, 'together'), (0.32, 'posture'), (0.13, 'touch')))
    if way == 'together':
        _bring_together(mannequin.rig, angles, chances.choose(_TOGETHER), chances)
        return
    posture = chances.choose(_BOTH_POSTURES)
    touch = chances.choose(_SITTING_TOUCHES if kind == 'sit' else _TOUCHES)
    for side in (0, 1):
        fill(angles, _PREFIXES[side], ARM_ANGLES, posture, chances)
    if chances.happens(0.5):  # alike
        angles[ARMS[1]] = angles[ARMS[0]] + 0.2 * (angles[ARMS[1]] - angles[ARMS[0]])
    if way == 'touch':
        for side in (0, 1):
            touch_body(mannequin, angles, side, touch, chances)


def _reach_freely(rig: Rig, angles: _Angles, side: int, chances: Chances) -> None:
    """Bring a hand anywhere around the shoulder, mostly before it; draw, point, catch."""
    length = rig.arm.sum()
    way = np.array([chances.near(-0.05, 0.5), chances.near(-0.05, 0.5), chances.near(0.5, 0.4)])
    far = np.sqrt((way**2).sum())
    if far > 1:
        way *= chances.between(0.7, 1.0) / far
    place = rig.shoulder[2] + length * way
    _bring(rig, angles[ARMS[side]], place, np.radians(chances.near(15, 30)))
    _hold_hand(angles[ARMS[side]], chances)


def _reach_down(rig: Rig, angles: _Angles, side: int, chances: Chances) -> None:
    """Let a hand hang to where gravity pulls it, or beyond, towards the floor or a shin."""
    turns = bone_turns(angles, rig.straight, rig.parts)
    chest = turns[rig.numbers['spine01']]
    way = np.array([chances.near(0.05, 0.25), -1.0, chances.near(0.25, 0.35)])
    way *= chances.between(0.6, 1.0) / np.sqrt((way**2).sum())
    mirror = _MIRROR if side else np.ones(3)
    place = rig.shoulder[2] + rig.arm.sum() * mirror * turned_back(chest, mirror * way)
    _bring(rig, angles[ARMS[side]], place, np.radians(chances.near(20, 25)))
    _hold_hand(angles[ARMS[side]], chances)


def _hold_hand(arm: _Angles, chances: Chances) -> None:
    arm[_PRONATION] = np.radians(chances.near(25, 40))
    arm[_WRIST] = np.radians([chances.near(0, 12), chances.near(-2, 6)])
    closed = chances.choose(((0.6, 12.0), (0.2, 45.0), (0.2, 85.0)))
    arm[_FINGERS] = np.radians(chances.near(closed, 8))


def _bring(rig: Rig, arm: _Angles, place: _Vector, swivel: float) -> float:
    """Bring a hand to a place in the chest's axes, in place; return how far it stays away."""
    reached, miss = reach(rig, arm, np.ascontiguousarray(place), swivel)
    if miss < _FAR:
        arm[:] = reached
    return miss


_PALMS = {
    'in': (-1.0, 0.0, 0.0),
    'ahead': (0.0, 0.0, 1.0),
    'up': (-0.3, 1.0, 0.0),
    'down': (0.0, -1.0, 0.0),
}


def _bring_together(rig: Rig, angles: _Angles, how: Together, chances: Chances) -> None:
    length = float(rig.arm.sum())
    centre = rig.shoulder[2] * np.array([0.0, 1.0, 1.0])
    middle = centre + length * np.array(
        [chances.near(mean, off) for mean, off in zip(how.middle, how.scatter, strict=True)]
    )
    across = np.array(how.across) / np.sqrt((np.array(how.across) ** 2).sum())
    half = 0.5 * length * chances.between(*how.gap) * across
    swivel = chances.near(how.swivel, 15)
    closed = chances.near(how.fingers, 6)
    for side, mirror in ((0, np.ones(3)), (1, _MIRROR)):
        arm = angles[ARMS[side]]
        place = mirror * (middle + (half if side == 0 else -half))
        _bring(rig, arm, place, np.radians(swivel + chances.near(0, 6)))
        _hold_hand(arm, chances)
        arm[_FINGERS] = np.radians(closed)
        if how.palms in _PALMS:
            arm[_PRONATION] = face_palm(arm, np.array(_PALMS[how.palms]))


_TOUCH_TRIES = (0.0, -25.0, 25.0, 50.0, 75.0)
"""By how much the elbow is raised more than wanted until nothing is in the way, degrees."""


def touch_body(
    mannequin: Mannequin, angles: _Angles, side: int, touch: Touch, chances: Chances
) -> None:
    """Lay a hand, 0 the left, on the own body, in place; if that cannot be, let it hang."""
    rig, capsules = mannequin
    place, inwards = _surface(mannequin, angles, side, touch, chances)
    swivel = chances.near(25, 25)
    closed = np.radians(chances.near(20, 10))
    hanging = angles[ARMS[side]].copy()
    for more in _TOUCH_TRIES:
        arm = hanging.copy()
        if _bring(rig, arm, place, np.radians(swivel + more)) > REACHED:
            continue
        lay_palm(arm, inwards)
        arm[_FINGERS] = closed
        angles[ARMS[side]] = arm
        # Rounded, so that the last bits, which differ between libraries, do not choose.
        if round(float(pair_overlaps(rig, capsules, angles).max()), 6) < DEEPEST:
            return
    angles[ARMS[side]] = hanging


def _surface(
    mannequin: Mannequin, angles: _Angles, side: int, touch: Touch, chances: Chances
) -> tuple[_Vector, _Vector]:
    """Return where a hand, 0 the left, touches the body, and the way into the flesh there.

    Both are in the chest's axes, the place from the chest's bone, mirrored for the right hand.
    """
    rig, capsules = mannequin
    mirror = _MIRROR if side else np.ones(3)
    number = _capsule(capsules.names, touch, side)
    share = chances.between(*touch.along)
    out = mirror * [chances.near(mean, touch.scatter) for mean in touch.outwards]
    start, end = capsules.ends[number]
    if (end - start)[0] * mirror[0] < 0:  # if it lies from side to side, 1 is the hand's own
        start, end = end, start
    along = end - start
    if '_' in touch.part:  # a limb's is long, so only across it is out of it
        out -= (out * along).sum() / max((along**2).sum(), 1e-9) * along
    out /= max(np.sqrt((out**2).sum()), 1e-6)
    hand = capsules.radii[capsules.names.index(f'{"LR"[side]}_hand')]
    surface = start + share * along + (capsules.radii[number] + 1.6 * hand) * out
    turns = bone_turns(angles, rig.straight, rig.parts)
    heads = bone_heads(turns, rig.parents, rig.heads)
    bone, chest = capsules.bones[number], rig.numbers['spine01']
    place = heads[bone] + turned(turns[bone], surface) - heads[chest]
    return (
        mirror * turned_back(turns[chest], place),
        -mirror * turned_back(turns[chest], turned(turns[bone], out)),
    )


def _capsule(names: tuple[str, ...], touch: Touch, side: int) -> int:
    """Return the number of the capsule that a hand, 0 the left, touches."""
    if touch.part.startswith('other_'):
        name = f'{"RL"[side]}_{touch.part.removeprefix("other_")}'
    elif touch.part.startswith('own_'):
        name = f'{"LR"[side]}_{touch.part.removeprefix("own_")}'
    else:
        name = touch.part
    found = [number for number, candidate in enumerate(names) if candidate == name]
    return found[touch.which]
