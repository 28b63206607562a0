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

"""Rotates limbs that penetrate the body until they only touch it.

Motion that was captured from a slim person moves the hands of a stout one into the hips.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.synthetic.body.body_file import BodyModel
from lsc_pose_ros.synthetic.body.body_mesh import RestBody, forward_kinematics
from lsc_pose_ros.synthetic.body.bone_rotations import (
    rig_of,
)
from lsc_pose_ros.synthetic.body.self_collision import (
    MAX_PENETRATION,
    Capsules,
    fit_capsules,
    nearest_parameters,
)
from lsc_pose_ros.synthetic.geometry.rotation_kernels import (
    product,
    rotated,
)
from lsc_pose_ros.synthetic.geometry.rotations import from_rotation_vectors, rotation_vectors

_MAX_STEPS = 12
_MAX_STEP_ANGLE = np.radians(12)
"""The largest rotation of a limb in one step, radians."""

_ROOTS = ('upperarm01.L', 'upperarm01.R', 'upperleg01.L', 'upperleg01.R')
"""The root bones of the limbs that are rotated; of two limbs, the first in this order moves."""


def resolve_collisions(
    body: BodyModel, rest: RestBody, rotations: NDArray[np.float64], *, spread: int = 0
) -> NDArray[np.float64]:
    """Return poses in which limbs penetrate the body by at most `MAX_PENETRATION`, if possible.

    A limb is rotated as a whole, about shoulder or hip, away from the part that it penetrates
    most.

    Args:
        body: the body model.
        rest: the person in the rest pose.
        rotations: the bones' rotations relative to their parents, shape (T, B, 3, 3).
        spread: number of frames before and after, over which corrections are smoothed; 0 if the
            frames are independent.

    Returns:
        The corrected rotations, of the same shape.
    """
    capsules = fit_capsules(body, rest, rig_of(body, rest))
    roots, pairs, allowed = _movable_pairs(body, capsules)
    resolved = np.ascontiguousarray(rotations, np.float64).copy()
    for pose in resolved:
        resolve_pose(
            pose,
            (body.parents, np.ascontiguousarray(rest.heads)),
            (capsules.bones, capsules.ends, capsules.radii),
            (roots, pairs, allowed),
        )
    return _smooth(rotations, resolved, np.unique(roots), spread) if spread else resolved


def _smooth(
    rotations: NDArray[np.float64],
    resolved: NDArray[np.float64],
    roots: NDArray[np.int64],
    spread: int,
) -> NDArray[np.float64]:
    """Return `rotations` with the corrections of `roots` averaged over a Hann window in time."""
    smooth = rotations.copy()
    window = np.hanning(2 * spread + 3)[1:-1]
    for root in roots:
        before = rotations[:, root]
        moved = rotation_vectors(resolved[:, root] @ before.transpose(0, 2, 1))
        padded = np.pad(moved, ((spread, spread), (0, 0)), mode='edge')
        around = np.lib.stride_tricks.sliding_window_view(padded, len(window), axis=0)
        mean = (around * window).sum(axis=-1) / window.sum()
        smooth[:, root] = from_rotation_vectors(mean) @ before
    return smooth


def _movable_pairs(
    body: BodyModel, capsules: Capsules
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Return the pairs of capsules that can be moved apart.

    Returns:
        The root bone of the limb that moves, shape (P,); the pairs, the capsule that moves first,
        shape (P, 2); the overlap that is allowed, metres, shape (P,).
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
        allowed.append(much + MAX_PENETRATION)
    return np.array(roots), np.array(pairs), np.array(allowed)


def _limb_of(body: BodyModel, bone: int) -> int:
    """Return the index in `_ROOTS` of the limb that a bone belongs to; 4 for the trunk."""
    while bone >= 0:
        name = str(body.bones[bone])
        if name in _ROOTS:
            return _ROOTS.index(name)
        bone = int(body.parents[bone])
    return len(_ROOTS)


_RigArrays = tuple[NDArray[np.int16], NDArray[np.float64]]
_CapsuleArrays = tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]
_Pairs = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]


@kernel
def resolve_pose(
    rotations: NDArray[np.float64],
    rig_arrays: _RigArrays,
    capsule_arrays: _CapsuleArrays,
    movable: _Pairs,
) -> None:
    """Rotate the limbs of one pose, shape (B, 3, 3), in place, the deepest penetration first.

    With r from the limb's root to the contact and n the outward direction, the limb rotates about
    r x n by depth / |r x n|, which removes the penetration to first order.
    """
    parents, rest = rig_arrays
    bones, ends, radii = capsule_arrays
    roots, pairs, allowed = movable
    posed = np.empty_like(ends)
    for _ in range(_MAX_STEPS):
        orientations, heads = forward_kinematics(rotations, parents, rest)
        for capsule in range(len(bones)):
            bone = bones[capsule]
            for end in range(2):
                posed[capsule, end] = heads[bone] + rotated(orientations[bone], ends[capsule, end])
        worst, deepest = deepest_pair(posed, radii, pairs, allowed)
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
        angle = min(deepest / lever, _MAX_STEP_ANGLE)
        parent = orientations[parents[root]]
        # In the parent's axes the same rotation is P^T Q P.
        local = rotated(parent.T, axis / lever)
        rotations[root] = product(rotation_about(local, angle), rotations[root])


@kernel
def deepest_pair(
    posed: NDArray[np.float64],
    radii: NDArray[np.float64],
    pairs: NDArray[np.int64],
    allowed: NDArray[np.float64],
) -> tuple[int, float]:
    """Return the pair of capsules with the deepest penetration, -1 for none, and its depth."""
    deepest, worst = 1e-4, -1
    for pair in range(len(pairs)):
        one, other = pairs[pair]
        touching = nearest_points(posed[one], posed[other])
        gap = touching[0] - touching[1]
        depth = radii[one] + radii[other] - allowed[pair] - np.sqrt((gap * gap).sum())
        if depth > deepest:
            deepest, worst = depth, pair
    return worst, deepest


@kernel
def nearest_points(
    first: NDArray[np.float64], second: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the nearest points of two line segments, each given by its ends, shape (2, 3)."""
    s, t = nearest_parameters(first, second)
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
