"""A person's body: how long the segments are, where the joints sit, which solids fill them.

The body stands upright, arms hanging. A segment's frame is x to the person's left, y up, z
forward; its origin is the joint about which it turns. All lengths are metres.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.core.joints import JOINT_NAMES

SEGMENTS: tuple[str, ...] = (
    'pelvis', 'abdomen', 'chest', 'head',
    'l_upper_arm', 'l_forearm', 'l_hand', 'l_thigh', 'l_shank', 'l_foot',
    'r_upper_arm', 'r_forearm', 'r_hand', 'r_thigh', 'r_shank', 'r_foot',
)  # fmt: skip

PARENT_SEGMENTS: tuple[int, ...] = (-1, 0, 1, 2, 2, 4, 5, 0, 7, 8, 2, 10, 11, 0, 13, 14)
"""The number of the segment on which each segment hangs; -1 for the root, the pelvis."""

CHILD_STATURE, ADULT_STATURE = 1.1, 1.6


class Solids(NamedTuple):
    """Tapered capsules (round cones), squeezed across their axis, fixed to segments.

    Attributes:
        segment: the segment that carries each solid, shape (S,).
        ends: the centres of its two end spheres in the segment's frame, shape (S, 2, 3); the same
            twice for an ellipsoid.
        radii: of the two spheres, shape (S, 2).
        squeeze: by which the solid's own x and z are stretched, shape (S, 2). Its y runs along
            the axis; its x is as near to the segment's x as that allows.
    """

    segment: NDArray[np.int64]
    ends: NDArray[np.float64]
    radii: NDArray[np.float64]
    squeeze: NDArray[np.float64]


class Body(NamedTuple):
    """One person.

    Attributes:
        stature: standing height.
        pivots: each segment's origin in its parent's frame, shape (16, 3).
        joint_segments: the segment that carries each joint of the vocabulary, shape (20,).
        joint_offsets: where in that segment's frame, shape (20, 3).
        solids: what fills the body.
        ankle_height: of the ankle above the sole.
    """

    stature: float
    pivots: NDArray[np.float64]
    joint_segments: NDArray[np.int64]
    joint_offsets: NDArray[np.float64]
    solids: Solids
    ankle_height: float


class Measures(NamedTuple):
    """Lengths and half widths of one person, as shares of the stature."""

    hip: float  # half the distance of the hip joints
    thigh: float
    shank: float
    ankle: float  # the ankle's height above the sole
    foot: float
    waist: float  # from mid-hip to the torso joint
    back: float  # from the torso joint to the line of the shoulders
    neck: float  # from the line of the shoulders to the base of the neck
    shoulder: float  # half the distance of the shoulder joints
    upper_arm: float
    forearm: float
    hand: float
    head: float  # from chin to vertex
    trunk_width: float
    trunk_depth: float
    belly: float
    limb: float  # thickness of the limbs, 1 for an average person


# Segment lengths after Drillis and Contini (1966), as tabulated by Winter, Biomechanics and Motor
# Control of Human Movement; joint centres lie a little inside the landmarks. Five-year-olds after
# Snyder et al., Anthropometry of Infants, Children and Youths (1977): larger head, shorter legs,
# narrower shoulders.
_ADULT = Measures(
    hip=0.050, thigh=0.242, shank=0.243, ankle=0.043, foot=0.150, waist=0.140, back=0.148,
    neck=0.040, shoulder=0.105, upper_arm=0.175, forearm=0.147, hand=0.106, head=0.131,
    trunk_width=1.0, trunk_depth=1.0, belly=1.0, limb=1.0,
)  # fmt: skip
_CHILD = Measures(
    hip=0.049, thigh=0.212, shank=0.216, ankle=0.047, foot=0.152, waist=0.145, back=0.155,
    neck=0.034, shoulder=0.098, upper_arm=0.166, forearm=0.140, hand=0.104, head=0.176,
    trunk_width=1.02, trunk_depth=1.08, belly=1.06, limb=1.02,
)  # fmt: skip

# By how much one person differs from the next of the same stature, as a standard deviation.
_SPREAD = 0.035


def draw_body(random: np.random.Generator, stature: float) -> Body:
    """Draw the body of a person `stature` metres tall: proportions and girth vary."""
    return build_body(stature, draw_measures(random, stature))


def draw_measures(random: np.random.Generator, stature: float) -> Measures:
    """Draw the proportions of a person `stature` metres tall."""
    adult = np.clip((stature - CHILD_STATURE) / (ADULT_STATURE - CHILD_STATURE), 0.0, 1.0)
    mean = adult * np.array(_ADULT) + (1 - adult) * np.array(_CHILD)
    # Twelve uniform draws make a normal one that no library version changes.
    normal = random.random((12, len(mean))).sum(axis=0) - 6.0
    measures = Measures(*(mean * (1 + _SPREAD * np.clip(normal, -2, 2))))
    girth = 0.90 + 0.45 * random.random() ** 1.5  # clothes included
    return measures._replace(
        trunk_width=measures.trunk_width * girth,
        trunk_depth=measures.trunk_depth * girth,
        belly=measures.belly * girth ** (1 + random.random()),
        limb=measures.limb * girth**0.8,
    )


def build_body(stature: float, measures: Measures) -> Body:
    """Return the body with these proportions."""
    # The parts along the upright body must add up to the stature.
    upright = sum(
        (measures.ankle, measures.shank, measures.thigh, measures.waist, measures.back,
         measures.neck, _HEAD_OVER_NECK, measures.head / 2)
    )  # fmt: skip
    scale = stature / upright
    offsets = _joint_offsets(measures)
    return Body(
        stature=stature,
        pivots=scale * _pivots(measures),
        joint_segments=np.array([SEGMENTS.index(offsets[name][0]) for name in JOINT_NAMES]),
        joint_offsets=scale * np.array([offsets[name][1] for name in JOINT_NAMES]),
        solids=_solids(measures, scale),
        ankle_height=scale * measures.ankle,
    )


_HEAD_OVER_NECK = 0.072  # the head's centre above the base of the neck, share of the stature
_LUMBAR = 0.35  # share of the way from mid-hip to the torso joint where the abdomen bends

_Vector = tuple[float, float, float]


def _pivots(m: Measures) -> NDArray[np.float64]:
    trunk = [
        (0, 0, 0),
        (0, _LUMBAR * m.waist, 0),
        (0, (1 - _LUMBAR) * m.waist, 0),
        (0, m.back + m.neck, -0.006),
    ]
    left = [
        (m.shoulder, m.back, -0.004),
        (0, -m.upper_arm, 0),
        (0, -m.forearm, 0),
        (m.hip, 0, 0),
        (0, -m.thigh, 0),
        (0, -m.shank, 0),
    ]
    right = [(-x, y, z) for x, y, z in left]
    return np.array(trunk + left + right, dtype=np.float64)


def _joint_offsets(m: Measures) -> dict[str, tuple[str, _Vector]]:
    here = (0.0, 0.0, 0.0)
    offsets: dict[str, tuple[str, _Vector]] = {
        'head': ('head', (0.0, _HEAD_OVER_NECK, 0.010)),
        'neck': ('head', here),
        'torso': ('chest', here),
        'pelvis': ('pelvis', here),
    }
    for side in ('l', 'r'):
        offsets[f'{side}_shoulder'] = (f'{side}_upper_arm', here)
        offsets[f'{side}_elbow'] = (f'{side}_forearm', here)
        offsets[f'{side}_wrist'] = (f'{side}_hand', here)
        offsets[f'{side}_hand'] = (f'{side}_hand', (0.0, -0.42 * m.hand, 0.0))
        offsets[f'{side}_hip'] = (f'{side}_thigh', here)
        offsets[f'{side}_knee'] = (f'{side}_shank', here)
        offsets[f'{side}_ankle'] = (f'{side}_foot', here)
        offsets[f'{side}_foot'] = (f'{side}_foot', (0.0, -0.5 * m.ankle, 0.5 * m.foot))
    return offsets


class _Part(NamedTuple):
    """One solid in shares of the stature; a left one is mirrored to the right."""

    segment: str
    start: _Vector
    end: _Vector
    radii: tuple[float, float]
    squeeze: tuple[float, float] = (1.0, 1.0)


def _trunk_parts(m: Measures) -> list[_Part]:
    width, depth, belly = m.trunk_width, m.trunk_depth, m.belly
    hips = 0.45 * width + 0.55 * m.hip / _ADULT.hip * m.limb
    ribs = 0.5 * width + 0.5 * m.shoulder / _ADULT.shoulder
    abdomen = 0.068
    chest = (0.072, 0.078)
    return [
        _Part('pelvis', (0, 0.020, -0.008), (0, 0.020, -0.008), (0.080, 0.080),
              (0.100 * hips / 0.080, 0.070 * depth / 0.080)),
        _Part('abdomen', (0, -0.010, 0.002), (0, 0.085, 0.002), (abdomen, abdomen),
              (0.084 * width / abdomen, 0.064 * belly / abdomen)),
        _Part('chest', (0, 0.020, 0), (0, m.back - 0.058, 0), chest,
              (1.20 * ribs, 0.88 * depth)),
        _Part('chest', (-0.72 * m.shoulder, m.back - 0.028, -0.004),
              (0.72 * m.shoulder, m.back - 0.028, -0.004), (0.040, 0.040),
              (1.0, 1.12 * depth)),
        _Part('chest', (0, m.back + 0.9 * m.neck, -0.012), (0.8 * m.shoulder, m.back + 0.004,
              -0.006), (0.034, 0.026)),
        _Part('chest', (0, m.back + 0.9 * m.neck, -0.012), (-0.8 * m.shoulder, m.back + 0.004,
              -0.006), (0.034, 0.026)),
    ]  # fmt: skip


def _head_parts(m: Measures) -> list[_Part]:
    half = m.head / 2
    neck = 0.033 * (0.6 + 0.4 * m.limb)
    centre = (0.0, _HEAD_OVER_NECK, 0.010)
    jaw = (0.0, _HEAD_OVER_NECK - 0.5 * half, 0.020)
    return [
        _Part('head', (0, -0.020, -0.004), (0, 0.6 * _HEAD_OVER_NECK, 0.002), (1.08 * neck, neck)),
        _Part('head', centre, centre, (half, half), (0.66, 0.80)),
        _Part('head', jaw, jaw, (0.52 * half, 0.52 * half), (1.0, 1.2)),
        _Part('head', (0, _HEAD_OVER_NECK, 0.010 + 0.74 * half),
              (0, _HEAD_OVER_NECK - 0.16 * half, 0.010 + 0.88 * half),
              (0.07 * half, 0.13 * half)),
    ]  # fmt: skip


def _arm_parts(m: Measures) -> list[_Part]:
    t = m.limb
    palm, fingers = 0.45 * m.hand, 0.86 * m.hand
    return [
        _Part('l_upper_arm', (-0.004, 0.002, 0), (-0.004, -0.030, 0), (0.036 * t, 0.032 * t)),
        _Part('l_upper_arm', (0, -0.020, 0), (0, -m.upper_arm, 0), (0.030 * t, 0.024 * t)),
        _Part('l_forearm', (0, 0, 0), (0, -0.35 * m.forearm, 0), (0.024 * t, 0.025 * t)),
        _Part('l_forearm', (0, -0.30 * m.forearm, 0), (0, -m.forearm, 0),
              (0.025 * t, 0.0165 * t), (0.92, 1.0)),
        _Part('l_hand', (0, 0, 0), (0, -palm, 0.001), (0.0180, 0.0245), (0.62, 1.0)),
        _Part('l_hand', (0, -palm, 0.001), (-0.006, -fingers, 0.0), (0.0230, 0.0150),
              (0.58, 1.0)),
        _Part('l_hand', (-0.003, -0.15 * m.hand, 0.010), (-0.010, -0.50 * m.hand, 0.032),
              (0.0100, 0.0075)),
    ]  # fmt: skip


def _leg_parts(m: Measures) -> list[_Part]:
    t = m.limb
    sole = -m.ankle
    return [
        _Part('pelvis', (0.95 * m.hip, -0.010, -0.034 * t), (0.95 * m.hip, 0.010, -0.030 * t),
              (0.050 * t, 0.045 * t)),
        _Part('l_thigh', (0.004, 0.0, 0), (0.0, -m.thigh, 0), (0.054 * t, 0.034 * t),
              (0.98, 1.06)),
        _Part('l_shank', (0, 0, 0.002), (0, -0.20 * m.shank, -0.004), (0.034 * t, 0.032 * t)),
        _Part('l_shank', (0, -0.14 * m.shank, -0.006), (0, -0.45 * m.shank, -0.008),
              (0.033 * t, 0.031 * t)),
        _Part('l_shank', (0, -0.40 * m.shank, -0.006), (0, -m.shank, 0), (0.031 * t, 0.0205 * t)),
        _Part('l_foot', (0, 0, 0), (0, sole + 0.024, -0.020), (0.0215, 0.0235)),
        _Part('l_foot', (0, sole + 0.020, -0.022), (0.003, sole + 0.016, 0.62 * m.foot),
              (0.0215, 0.0240), (1.1, 0.84)),
        _Part('l_foot', (0, -0.004, 0.006), (0.002, sole + 0.020, 0.45 * m.foot),
              (0.021, 0.018)),
    ]  # fmt: skip


def _mirrored(part: _Part) -> _Part:
    (x0, y0, z0), (x1, y1, z1) = part.start, part.end
    segment = part.segment.replace('l_', 'r_', 1)
    return part._replace(segment=segment, start=(-x0, y0, z0), end=(-x1, y1, z1))


def _solids(measures: Measures, scale: float) -> Solids:
    left = _arm_parts(measures) + _leg_parts(measures)
    parts = _trunk_parts(measures) + _head_parts(measures) + left
    parts += [_mirrored(part) for part in left]
    return Solids(
        segment=np.array([SEGMENTS.index(part.segment) for part in parts]),
        ends=scale * np.array([(part.start, part.end) for part in parts], dtype=np.float64),
        radii=scale * np.array([part.radii for part in parts]),
        squeeze=np.array([part.squeeze for part in parts]),
    )
