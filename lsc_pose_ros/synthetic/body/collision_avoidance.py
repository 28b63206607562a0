"""Moves limbs that go through the body until they only touch it.

Motion captured from one person takes the hands of a stouter one into the hips.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.synthetic.body.body_file import Body
from lsc_pose_ros.synthetic.body.body_mesh import Rest, turn_bones
from lsc_pose_ros.synthetic.body.bone_rotations import product, rig_of, turned
from lsc_pose_ros.synthetic.body.self_collision import (
    DEEPEST,
    Capsules,
    fit_capsules,
    nearest_shares,
)
from lsc_pose_ros.synthetic.motion.rotations import from_rotation_vectors, rotation_vectors

_STEPS = 12
_MOST = np.radians(12)
"""By which a limb is moved in one step."""

_ROOTS = ('upperarm01.L', 'upperarm01.R', 'upperleg01.L', 'upperleg01.R')
"""The bones with which limbs are moved as a whole; arms give way to legs."""


def push_out(
    body: Body, rest: Rest, rotations: NDArray[np.float64], *, spread: int = 0
) -> NDArray[np.float64]:
    """Return poses in which limbs go through the body no deeper than `DEEPEST`, if it can be.

    A limb is turned as a whole, about shoulder or hip, straight away from what it is deepest in.

    Args:
        body: the body.
        rest: the person at rest.
        rotations: of the bones against their parents, shape (T, B, 3, 3).
        spread: over how many frames before and after a limb gives way, so that it does so
            smoothly; 0 where frames have nothing to do with each other.

    Returns:
        The rotations, of the same shape.
    """
    capsules = fit_capsules(body, rest, rig_of(body, rest))
    roots, pairs, allowed = _movable(body, capsules)
    pushed = np.ascontiguousarray(rotations, np.float64).copy()
    for pose in pushed:
        push_pose(
            pose,
            (body.parents, np.ascontiguousarray(rest.heads)),
            (capsules.bones, capsules.ends, capsules.radii),
            (roots, pairs, allowed),
        )
    return _smooth(rotations, pushed, np.unique(roots), spread) if spread else pushed


def _smooth(
    rotations: NDArray[np.float64],
    pushed: NDArray[np.float64],
    roots: NDArray[np.int64],
    spread: int,
) -> NDArray[np.float64]:
    """Return `rotations`, those of `roots` moved by how they are on an average around."""
    smooth = rotations.copy()
    window = np.hanning(2 * spread + 3)[1:-1]
    for root in roots:
        before = rotations[:, root]
        moved = rotation_vectors(pushed[:, root] @ before.transpose(0, 2, 1))
        padded = np.pad(moved, ((spread, spread), (0, 0)), mode='edge')
        around = np.lib.stride_tricks.sliding_window_view(padded, len(window), axis=0)
        mean = (around * window).sum(axis=-1) / window.sum()
        smooth[:, root] = from_rotation_vectors(mean) @ before
    return smooth


def _movable(
    body: Body, capsules: Capsules
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Return what moves apart pairs of capsules.

    Returns:
        The limb's root bone, shape (P,); the pairs, the capsule that moves first, shape (P, 2);
        how far they may overlap, shape (P,).
    """
    bones = [str(name) for name in body.bones]
    limb = [_limb_of(body, bone) for bone in capsules.bones]
    roots, pairs, allowed = [], [], []
    for (one, other), much in zip(capsules.pairs, capsules.allowed, strict=True):
        if limb[one] == limb[other]:
            continue
        first, second = sorted((one, other), key=lambda capsule: limb[capsule])
        roots.append(bones.index(_ROOTS[limb[first]]))
        pairs.append((first, second))
        allowed.append(much + DEEPEST)
    return np.array(roots), np.array(pairs), np.array(allowed)


def _limb_of(body: Body, bone: int) -> int:
    """Return the number in `_ROOTS` of the limb to which a bone belongs; the trunk's is 4."""
    while bone >= 0:
        name = str(body.bones[bone])
        if name in _ROOTS:
            return _ROOTS.index(name)
        bone = int(body.parents[bone])
    return len(_ROOTS)


_Skeleton = tuple[NDArray[np.int16], NDArray[np.float64]]
_Flesh = tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]
_Pairs = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]


@kernel
def push_pose(
    rotations: NDArray[np.float64], skeleton: _Skeleton, flesh: _Flesh, movable: _Pairs
) -> None:
    """Move limbs of one pose, shape (B, 3, 3), in place, the deepest overlap first.

    With r from the limb's root to where it touches and n the way out, the limb turns about r x n
    by depth / |r x n|, as that brings the point out to first order.
    """
    parents, rest = skeleton
    bones, ends, radii = flesh
    roots, pairs, allowed = movable
    posed = np.empty_like(ends)
    for _ in range(_STEPS):
        turns, heads = turn_bones(rotations, parents, rest)
        for capsule in range(len(bones)):
            bone = bones[capsule]
            for end in range(2):
                posed[capsule, end] = heads[bone] + turned(turns[bone], ends[capsule, end])
        deepest, worst = 1e-4, -1
        for pair in range(len(pairs)):
            one, other = pairs[pair]
            touching = nearest_points(posed[one], posed[other])
            gap = touching[0] - touching[1]
            depth = radii[one] + radii[other] - allowed[pair] - np.sqrt((gap * gap).sum())
            if depth > deepest:
                deepest, worst = depth, pair
        if worst < 0:
            return
        one, other = pairs[worst]
        touching = nearest_points(posed[one], posed[other])
        root = roots[worst]
        out = touching[0] - touching[1]
        length = np.sqrt((out * out).sum())
        if length < 1e-6:
            return
        axis = np.cross(touching[0] - heads[root], out / length)
        lever = np.sqrt((axis * axis).sum())
        if lever < 0.02:
            return
        angle = min(deepest / lever, _MOST)
        parent = turns[parents[root]]
        # In the parent's axes the same turn is P^T Q P.
        local = turned(parent.T, axis / lever)
        rotations[root] = product(rotation_about(local, angle), rotations[root])


@kernel
def nearest_points(
    first: NDArray[np.float64], second: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where two line segments, each given by its ends, shape (2, 3), are nearest."""
    s, t = nearest_shares(first, second)
    return first[0] + s * (first[1] - first[0]), second[0] + t * (second[1] - second[0])


@kernel
def rotation_about(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Return the rotation about a unit vector: R = c I + s [a] + (1 - c) a a^T (Rodrigues)."""
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation: NDArray[np.float64] = sine * cross
    for row in range(3):
        for column in range(3):
            rotation[row, column] += (1 - cosine) * axis[row] * axis[column]
        rotation[row, row] += cosine
    return rotation
