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

"""Self-collision: how far a person's limbs penetrate other parts of the body.

The body is approximated by capsules (all points within a radius of a line segment), which are
fitted to the person's skin in the rest pose and move with the bones.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.synthetic.body.body_file import BodyModel
from lsc_pose_ros.synthetic.body.body_mesh import RestBody
from lsc_pose_ros.synthetic.body.bone_rotations import (
    Rig,
    bone_heads,
    bone_orientations,
    rig_of,
)
from lsc_pose_ros.synthetic.motion.joint_angles import ANGLE_NUMBERS, ANGLES

MAX_PENETRATION = 0.02
"""The penetration that is allowed, metres: flesh and clothes are soft."""

# A capsule's name, the bone that carries it, the bone at whose head it ends, and the ratio of its
# radius to the skin's mean distance from its axis. The ratio is less for flat hands and feet.
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

# The capsules against which each capsule of one side is tested; `other_` marks limbs of the other
# side, limbs without a prefix are of the same side.
_COLLISION_PARTNERS: dict[str, tuple[str, ...]] = {
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
    """The capsules that approximate one person's body.

    Attributes:
        names: of the C capsules.
        bones: the bones that carry them, shape (C,).
        ends: the ends of the axes in the rest pose, relative to the bone's head, metres, (C, 2,
            3).
        radii: metres, shape (C,).
        pairs: the pairs of capsules that are tested, shape (P, 2).
        allowed: the overlap of each pair in the person's standing pose, metres, shape (P,).
    """

    names: tuple[str, ...]
    bones: NDArray[np.int64]
    ends: NDArray[np.float64]
    radii: NDArray[np.float64]
    pairs: NDArray[np.int64]
    allowed: NDArray[np.float64]


class CollisionBody(NamedTuple):
    """One person's rig and capsules."""

    rig: Rig
    capsules: Capsules


def fit_collision_body(body: BodyModel, rest: RestBody) -> CollisionBody:
    """Return rig and capsules of one person."""
    rig = rig_of(body, rest)
    return CollisionBody(rig, fit_capsules(body, rest, rig))


def fit_capsules(body: BodyModel, rest: RestBody, rig: Rig) -> Capsules:
    """Fit capsules to a person's skin in the rest pose.

    The axes of limbs lie along their bones, and their radius is the skin's mean distance. The axes
    of the trunk lie from side to side, those of neck and head are upright.
    """
    trunk = [_fit_trunk(_skin_of(body, rest, rig, name, bone), name) for name, bone in _TRUNK]
    limb_names, limb_bones, axes = _limb_axes(rig)
    carried = np.full(len(rig.parents), -1)
    carried[limb_bones] = np.arange(len(limb_bones))
    distances = mean_distances(rest.vertices, body.skin_bones, carried, axes)
    radius_scales = [fraction for _, _, _, fraction in _LIMBS]
    names = (*(name for name, _ in _TRUNK), *limb_names)
    bones = np.array([rig.numbers[bone] for _, bone in _TRUNK] + limb_bones)
    ends = np.concatenate([np.array([axis for axis, _ in trunk]), axes])
    pairs = np.array(_pairs(names))
    capsules = Capsules(
        names=names,
        bones=bones,
        ends=ends - rig.heads[bones][:, None],
        radii=np.array(
            [radius for _, radius in trunk] + list(np.tile(radius_scales, 2) * distances)
        ),
        pairs=pairs,
        allowed=np.zeros(len(pairs)),
    )
    return capsules._replace(
        allowed=np.maximum(pair_penetrations(rig, capsules, _standing_angles()), 0.0)
    )


def _limb_axes(rig: Rig) -> tuple[list[str], list[int], NDArray[np.float64]]:
    """Return names, bones and ends in the rest pose, shape (L, 2, 3), of the limbs' capsules."""
    names, bones, ends = [], [], []
    for side in ('L', 'R'):
        for name, bone, last, _ in _LIMBS:
            pair = [rig.numbers[f'{end}.{side}'] for end in (bone, last)]
            names.append(f'{side}_{name}')
            bones.append(pair[0])
            ends.append(rig.heads[pair])
    return names, bones, np.array(ends)


def _standing_angles() -> NDArray[np.float64]:
    """Return the joint angles of a person who stands with hanging arms, shape (A,)."""
    angles = np.zeros(len(ANGLES))
    for side in ('l', 'r'):
        angles[ANGLE_NUMBERS[f'{side}_elevation']] = np.radians(12)
        angles[ANGLE_NUMBERS[f'{side}_hip_abduction']] = np.radians(3)
    return angles


def deepest_penetration(
    collision_body: CollisionBody, angles: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return how far limbs penetrate other parts of the body in N poses.

    Args:
        collision_body: the person's rig and capsules.
        angles: joint angles, radians, shape (N, A).

    Returns:
        Metres beyond the overlap of the standing pose, shape (N,); 0 without a collision.
    """
    rig, capsules = collision_body
    depths = [pair_penetrations(rig, capsules, pose).max() for pose in angles]
    return np.asarray(np.maximum(depths, 0.0))


def pair_penetrations(
    rig: Rig, capsules: Capsules, angles: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the penetration of each pair of capsules in a pose, shape (A,): metres, (P,)."""
    depths: NDArray[np.float64] = _penetrations(
        angles,
        (rig.standing, rig.parts, rig.parents, rig.heads),
        (capsules.bones, capsules.ends, capsules.radii, capsules.pairs, capsules.allowed),
    )
    return depths


def _skin_of(
    body: BodyModel, rest: RestBody, rig: Rig, name: str, bone: str
) -> NDArray[np.float64]:
    """Return every third vertex of a part of the trunk, shape (N, 3)."""
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
    few = len(skin) // 25  # ignores protruding details such as nose and ears
    low, high = ordered[few], ordered[-1 - few]
    half = 0.5 * (high - low)
    upright = name in ('neck', 'head')
    radius = 0.5 * (half[0] + half[2]) if upright else min(half[0], half[2])
    direction = np.array([0.0, 1.0, 0.0] if upright else [1.0, 0.0, 0.0])
    half_axis = np.maximum(half - radius, 0.0) * direction
    centre = 0.5 * (low + high)
    return np.array([centre - half_axis, centre + half_axis]), float(radius)


@kernel
def mean_distances(
    vertices: NDArray[np.float64],
    bones: NDArray[np.uint8],
    limbs: NDArray[np.int64],
    ends: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the mean distance of the skin from the axes, shape (L, 2, 3), of the limbs' capsules.

    Args:
        vertices: the skin, shape (V, 3).
        bones: the bones that the vertices follow, the strongest first, shape (V, 8).
        limbs: the number of each bone's capsule, -1 for none, shape (B,).
        ends: the ends of the axes, shape (L, 2, 3).

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
        fraction = min(max(along / square, 0.0), 1.0)
        squared = 0.0
        for axis in range(3):
            nearest = start[axis] + fraction * (end[axis] - start[axis])
            squared += (vertices[vertex, axis] - nearest) ** 2
        total[limb] += np.sqrt(squared)
        count[limb] += 1
    return total / count


@cache
def _pairs(names: tuple[str, ...]) -> list[tuple[int, int]]:
    """Return the pairs of capsules that must not penetrate each other, each pair once."""
    found = set()
    for one, name in enumerate(names):
        side, _, part = name.partition('_')
        for against in _COLLISION_PARTNERS.get(part, ()):
            sides = {'L': 'R', 'R': 'L'} if against.startswith('other_') else {'L': 'L', 'R': 'R'}
            whole = f'{sides[side]}_{against.removeprefix("other_")}'
            found |= {
                (min(one, other), max(one, other))
                for other, candidate in enumerate(names)
                if candidate in (whole, against)
            }
    return sorted(found)


_RigArrays = tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]
_CapsuleArrays = tuple[
    NDArray[np.int64],
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.int64],
    NDArray[np.float64],
]


@kernel
def _penetrations(
    angles: NDArray[np.float64], rig_arrays: _RigArrays, capsule_arrays: _CapsuleArrays
) -> NDArray[np.float64]:
    standing, parts, parents, rest = rig_arrays
    bones, ends, radii, pairs, allowed = capsule_arrays
    orientations = bone_orientations(angles, standing, parts)
    heads = bone_heads(orientations, parents, rest)
    posed = np.empty_like(ends)
    for capsule in range(len(bones)):
        bone = bones[capsule]
        orientation = orientations[bone]
        for end in range(2):
            x, y, z = ends[capsule, end, 0], ends[capsule, end, 1], ends[capsule, end, 2]
            for row in range(3):
                along = orientation[row, 0] * x + orientation[row, 1] * y + orientation[row, 2] * z
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
    s, t = nearest_parameters(first, second)
    squared = 0.0
    for axis in range(3):
        one = first[0, axis] + s * (first[1, axis] - first[0, axis])
        squared += (one - second[0, axis] - t * (second[1, axis] - second[0, axis])) ** 2
    return squared


@kernel
def nearest_parameters(
    first: NDArray[np.float64], second: NDArray[np.float64]
) -> tuple[float, float]:
    """Return the positions along two line segments, 0 to 1, that are nearest to each other.

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
