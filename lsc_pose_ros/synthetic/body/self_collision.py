"""How far a person's limbs go through the rest of the body.

The body is made of capsules (what is within a radius of a line segment) that are fitted to the
person's skin at rest and go with the bones.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.synthetic.body.body_file import Body
from lsc_pose_ros.synthetic.body.body_mesh import Rest
from lsc_pose_ros.synthetic.body.bone_rotations import (
    Rig,
    bone_heads,
    bone_turns,
    rig_of,
)
from lsc_pose_ros.synthetic.motion.joint_angles import ANGLE_NUMBERS, ANGLES

DEEPEST = 0.02
"""How far skin may sink into skin, metres: flesh and clothes give way."""

# A capsule's name, the bone that carries it, the bone at whose head it ends, and the share of the
# mean distance of the skin from its axis that is its radius: hands and feet are flat.
_LIMBS: tuple[tuple[str, str, str, float], ...] = (
    ('upper_arm', 'upperarm01', 'upperarm02', 0.8),
    ('upper_arm', 'upperarm02', 'lowerarm01', 1.0),
    ('forearm', 'lowerarm01', 'lowerarm02', 1.0),
    ('forearm', 'lowerarm02', 'wrist', 1.0),
    ('hand', 'wrist', 'finger3-1', 0.7),
    ('fingers', 'finger3-1', 'finger3-3', 1.2),
    ('thigh', 'upperleg01', 'upperleg02', 0.9),
    ('thigh', 'upperleg02', 'lowerleg01', 1.0),
    ('shank', 'lowerleg01', 'lowerleg02', 1.0),
    ('shank', 'lowerleg02', 'foot', 1.0),
    ('foot', 'foot', 'toes', 0.8),
)
_TRUNK: tuple[tuple[str, str], ...] = (
    ('hips', 'root'), ('belly', 'spine04'), ('belly', 'spine03'), ('chest', 'spine02'),
    ('chest', 'spine01'), ('neck', 'neck02'), ('head', 'head'),
)  # fmt: skip

# Which capsules of the one side are held against which of the whole person; `other_` are those of
# the other side, no prefix on a limb its own side.
_AGAINST: dict[str, tuple[str, ...]] = {
    'upper_arm': ('head', 'other_upper_arm'),
    'forearm': (
        'hips', 'belly', 'chest', 'neck', 'head', 'thigh', 'shank', 'other_thigh', 'other_shank',
        'other_upper_arm', 'other_forearm',
    ),
    'hand': (
        'hips', 'belly', 'chest', 'neck', 'head', 'thigh', 'shank', 'foot', 'other_thigh',
        'other_shank', 'other_foot', 'upper_arm', 'other_upper_arm', 'other_forearm',
        'other_hand',
    ),
    'fingers': (
        'hips', 'belly', 'chest', 'neck', 'head', 'thigh', 'shank', 'foot', 'other_thigh',
        'other_shank', 'other_foot', 'upper_arm', 'other_upper_arm', 'other_forearm',
        'other_hand', 'other_fingers',
    ),
    'thigh': ('chest', 'other_thigh'),
    'shank': ('hips', 'other_thigh', 'other_shank', 'belly', 'chest'),
    'foot': ('hips', 'other_thigh', 'other_shank', 'other_foot'),
}  # fmt: skip


class Capsules(NamedTuple):
    """What stands for one person's flesh.

    Attributes:
        names: of the C capsules.
        bones: that carry them, shape (C,).
        ends: of the axes, at rest, metres from the bone's head, shape (C, 2, 3).
        radii: metres, shape (C,).
        pairs: which must keep off each other, shape (P, 2).
        allowed: how far each pair sinks into each other anyhow, in a person who stands straight,
            metres, shape (P,).
    """

    names: tuple[str, ...]
    bones: NDArray[np.int64]
    ends: NDArray[np.float64]
    radii: NDArray[np.float64]
    pairs: NDArray[np.int64]
    allowed: NDArray[np.float64]


class Mannequin(NamedTuple):
    """One person's bones and flesh."""

    rig: Rig
    capsules: Capsules


def mannequin_of(body: Body, rest: Rest) -> Mannequin:
    """Return bones and flesh of the person who is like `rest` at rest."""
    rig = rig_of(body, rest)
    return Mannequin(rig, fit_capsules(body, rest, rig))


def fit_capsules(body: Body, rest: Rest, rig: Rig) -> Capsules:
    """Fit capsules to a person's skin at rest.

    A limb's lie along its bones, their radius the skin's mean distance. The trunk's lie from side
    to side, those of neck and head upright.
    """
    trunk = [_fit_trunk(_skin_of(body, rest, rig, name, bone), name) for name, bone in _TRUNK]
    limb_names, limb_bones, axes = _limb_axes(rig)
    carried = np.full(len(rig.parents), -1)
    carried[limb_bones] = np.arange(len(limb_bones))
    distances = mean_distances(rest.vertices, body.skin_bones, carried, axes)
    shares = [share for _, _, _, share in _LIMBS]
    names = (*(name for name, _ in _TRUNK), *limb_names)
    bones = np.array([rig.numbers[bone] for _, bone in _TRUNK] + limb_bones)
    ends = np.concatenate([np.array([axis for axis, _ in trunk]), axes])
    pairs = np.array(_pairs(names))
    capsules = Capsules(
        names=names,
        bones=bones,
        ends=ends - rig.heads[bones][:, None],
        radii=np.array([radius for _, radius in trunk] + list(np.tile(shares, 2) * distances)),
        pairs=pairs,
        allowed=np.zeros(len(pairs)),
    )
    return capsules._replace(allowed=np.maximum(pair_overlaps(rig, capsules, _at_ease()), 0.0))


def _limb_axes(rig: Rig) -> tuple[list[str], list[int], NDArray[np.float64]]:
    """Return names, bones and ends at rest, shape (L, 2, 3), of the limbs' capsules."""
    names, bones, ends = [], [], []
    for side in ('L', 'R'):
        for name, bone, last, _ in _LIMBS:
            pair = [rig.numbers[f'{end}.{side}'] for end in (bone, last)]
            names.append(f'{side}_{name}')
            bones.append(pair[0])
            ends.append(rig.heads[pair])
    return names, bones, np.array(ends)


def _at_ease() -> NDArray[np.float64]:
    """Return the angles of a person who stands with hanging arms, shape (A,)."""
    angles = np.zeros(len(ANGLES))
    for side in ('l', 'r'):
        angles[ANGLE_NUMBERS[f'{side}_elevation']] = np.radians(12)
        angles[ANGLE_NUMBERS[f'{side}_hip_abduction']] = np.radians(3)
    return angles


def deepest_overlap(mannequin: Mannequin, angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how far limbs sink into other parts of the body in N poses.

    Args:
        mannequin: the person's bones and flesh.
        angles: radians, shape (N, A).

    Returns:
        Metres beyond what the person's flesh allows, shape (N,); 0 where nothing touches.
    """
    rig, capsules = mannequin
    depths = [pair_overlaps(rig, capsules, pose).max() for pose in angles]
    return np.asarray(np.maximum(depths, 0.0))


def pair_overlaps(
    rig: Rig, capsules: Capsules, angles: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return how far each pair of capsules overlaps in a pose, shape (A,): metres, (P,)."""
    depths: NDArray[np.float64] = _overlaps(
        angles,
        (rig.straight, rig.parts, rig.parents, rig.heads),
        (capsules.bones, capsules.ends, capsules.radii, capsules.pairs, capsules.allowed),
    )
    return depths


def _skin_of(body: Body, rest: Rest, rig: Rig, name: str, bone: str) -> NDArray[np.float64]:
    """Return some of the vertices of a part of the trunk, shape (N, 3)."""
    carriers = [bone, 'pelvis.L', 'pelvis.R'] if name == 'hips' else [bone]
    some = slice(None, None, 3)
    strongest = body.skin_bones[some, 0]
    own = strongest == rig.numbers[carriers[0]]
    for carrier in carriers[1:]:
        own |= strongest == rig.numbers[carrier]
    return np.asarray(rest.vertices[some][own])


def _fit_trunk(skin: NDArray[np.float64], name: str) -> tuple[NDArray[np.float64], float]:
    """Return the ends of the axis, shape (2, 3), and the radius of a part of the trunk."""
    ordered = np.sort(skin, axis=0)
    few = len(skin) // 25  # nose, ears and nipples do not count
    low, high = ordered[few], ordered[-1 - few]
    half = 0.5 * (high - low)
    upright = name in ('neck', 'head')
    radius = 0.5 * (half[0] + half[2]) if upright else min(half[0], half[2])
    direction = np.array([0.0, 1.0, 0.0] if upright else [1.0, 0.0, 0.0])
    reach = np.maximum(half - radius, 0.0) * direction
    centre = 0.5 * (low + high)
    return np.array([centre - reach, centre + reach]), float(radius)


@kernel
def mean_distances(
    vertices: NDArray[np.float64],
    bones: NDArray[np.uint8],
    limbs: NDArray[np.int64],
    ends: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the mean distance of the skin from the axes, shape (L, 2, 3), of limbs' capsules.

    Args:
        vertices: of the skin, shape (V, 3).
        bones: that they follow, the strongest first, shape (V, 8).
        limbs: the number of the capsule that each bone carries, -1 for none, shape (B,).
        ends: of the axes, shape (L, 2, 3).

    Returns:
        Metres, shape (L,).
    """
    total, count = np.zeros(len(ends)), np.zeros(len(ends))
    for vertex in range(len(vertices)):
        limb = limbs[bones[vertex, 0]]
        if limb < 0:
            continue
        start, end = ends[limb, 0], ends[limb, 1]
        square = along = 0.0
        for axis in range(3):
            square += (end[axis] - start[axis]) ** 2
            along += (vertices[vertex, axis] - start[axis]) * (end[axis] - start[axis])
        share = min(max(along / square, 0.0), 1.0)
        squared = 0.0
        for axis in range(3):
            nearest = start[axis] + share * (end[axis] - start[axis])
            squared += (vertices[vertex, axis] - nearest) ** 2
        total[limb] += np.sqrt(squared)
        count[limb] += 1
    return total / count


@cache
def _pairs(names: tuple[str, ...]) -> list[tuple[int, int]]:
    """Return which capsules must keep off each other, each pair once."""
    found = set()
    for one, name in enumerate(names):
        side, _, part = name.partition('_')
        for against in _AGAINST.get(part, ()):
            sides = {'L': 'R', 'R': 'L'} if against.startswith('other_') else {'L': 'L', 'R': 'R'}
            whole = f'{sides[side]}_{against.removeprefix("other_")}'
            found |= {
                (min(one, other), max(one, other))
                for other, candidate in enumerate(names)
                if candidate in (whole, against)
            }
    return sorted(found)


_Skeleton = tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]
_Flesh = tuple[
    NDArray[np.int64],
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.int64],
    NDArray[np.float64],
]


@kernel
def _overlaps(
    angles: NDArray[np.float64], skeleton: _Skeleton, flesh: _Flesh
) -> NDArray[np.float64]:
    straight, parts, parents, rest = skeleton
    bones, ends, radii, pairs, allowed = flesh
    turns = bone_turns(angles, straight, parts)
    heads = bone_heads(turns, parents, rest)
    posed = np.empty_like(ends)
    for capsule in range(len(bones)):
        bone = bones[capsule]
        turn = turns[bone]
        for end in range(2):
            x, y, z = ends[capsule, end, 0], ends[capsule, end, 1], ends[capsule, end, 2]
            for row in range(3):
                along = turn[row, 0] * x + turn[row, 1] * y + turn[row, 2] * z
                posed[capsule, end, row] = heads[bone, row] + along
    depths = np.empty(len(pairs))
    for pair in range(len(pairs)):
        one, other = pairs[pair, 0], pairs[pair, 1]
        squared = segment_distance(posed[one], posed[other])
        depths[pair] = radii[one] + radii[other] - np.sqrt(squared) - allowed[pair]
    return depths


@kernel
def segment_distance(first: NDArray[np.float64], second: NDArray[np.float64]) -> float:
    """Return the squared distance of two line segments, each given by its ends, shape (2, 3)."""
    s, t = nearest_shares(first, second)
    squared = 0.0
    for axis in range(3):
        one = first[0, axis] + s * (first[1, axis] - first[0, axis])
        squared += (one - second[0, axis] - t * (second[1, axis] - second[0, axis])) ** 2
    return squared


@kernel
def nearest_shares(first: NDArray[np.float64], second: NDArray[np.float64]) -> tuple[float, float]:
    """Return how far along two line segments, 0 to 1, they are nearest to each other.

    Each is given by its ends, shape (2, 3). Ericson, Real-Time Collision Detection (2005), 5.1.9.
    """
    aa = bb = ab = ag = bg = 0.0
    for axis in range(3):
        along, other = first[1, axis] - first[0, axis], second[1, axis] - second[0, axis]
        gap = first[0, axis] - second[0, axis]
        aa, bb, ab = aa + along * along, bb + other * other, ab + along * other
        ag, bg = ag + along * gap, bg + other * gap
    tiny = 1e-12
    s = t = 0.0
    across = aa * bb - ab * ab
    if aa > tiny and across > tiny * aa * bb:
        s = min(max((ab * bg - ag * bb) / across, 0.0), 1.0)
    if bb > tiny:
        t = min(max((ab * s + bg) / bb, 0.0), 1.0)
    if aa > tiny:
        s = min(max((ab * t - ag) / aa, 0.0), 1.0)
    return s, t
