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

"""Tests the sampled bodies and clothes."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.body.body_file import BodyModel, load_body
from lsc_pose_ros.synthetic.body.body_mesh import RestBody, shape_body, stature
from lsc_pose_ros.synthetic.body.clothes import (
    REGIONS,
    ClothesRegions,
    clothes_regions,
    dress,
    sample_thickness,
    vertex_normals,
)
from lsc_pose_ros.synthetic.body.population import (
    BodySampler,
    Population,
    sample_build,
    sample_stature,
)
from lsc_pose_ros.synthetic.people import hull_vertices


def source(seed: int) -> np.random.Generator:
    return np.random.Generator(np.random.PCG64(seed))


@pytest.fixture(scope='module')
def body() -> BodyModel:
    return load_body()


@pytest.fixture(scope='module')
def people(body: BodyModel) -> list[RestBody]:
    sampler, random = BodySampler(body), source(1)
    return [sampler.sample(Population(), random) for _ in range(12)]


@pytest.fixture(scope='module')
def regions(body: BodyModel) -> ClothesRegions:
    return clothes_regions(body)


def sampled(population: Population, count: int = 400) -> np.ndarray:
    """Return sampled ages, sexes and statures, shape (count, 3)."""
    random = source(2)
    return np.array([sample_stature(population, random) for _ in range(count)])


def test_all_ages_sexes_and_statures_are_sampled() -> None:
    age, sex, metres = sampled(Population()).T
    assert age.min() < 6
    assert age.max() > 75
    assert 0.2 < (age < 18).mean() < 0.4
    assert (sex == 0).mean() > 0.2
    assert (sex == 1).mean() > 0.2
    assert metres.min() < 1.1
    assert metres.max() > 1.85


@pytest.mark.parametrize(
    ('age', 'sex', 'expected'),
    [(5, 0.0, 1.08), (10, 1.0, 1.385), (30, 1.0, 1.77), (30, 0.0, 1.635)],
)
def test_statures_agree_with_age_and_sex(age: float, sex: float, expected: float) -> None:
    people = sampled(Population(age=(age, age)), 2000)
    metres = people[people[:, 1] == sex, 2]
    assert metres.mean() == pytest.approx(expected, rel=0.01)
    assert np.abs(metres / expected - 1).max() < 0.12


def test_ages_and_statures_are_within_the_population() -> None:
    age, _, metres = sampled(Population(age=(8, 30), stature=(1.5, 1.6))).T
    assert 8 <= age.min() < age.max() <= 30
    assert 1.5 <= metres.min() < metres.max() <= 1.6
    with pytest.raises(InputError, match=r'almost nobody aged 2 to 3 is 1\.7 to 1\.8 m tall'):
        sample_stature(Population(age=(2, 3), stature=(1.7, 1.8)), source(0))


def test_people_have_the_sampled_stature(body: BodyModel) -> None:
    sampler = BodySampler(body)
    for seed in range(8):
        *_, metres = sample_stature(Population(), source(seed))
        assert stature(sampler.sample(Population(), source(seed))) == pytest.approx(
            metres, abs=0.003
        )


@pytest.mark.parametrize('age', [1.0, 4.0, 12.0, 30.0, 90.0])
def test_each_sampled_build_is_valid(body: BodyModel, age: float) -> None:
    for seed in range(20):
        body_shape = sample_build(body, age, seed % 2, source(seed))
        shape_body(body, body_shape)  # refuses values out of range
        assert 0.1 <= body_shape.weight <= 0.95
        assert set(body_shape.measures) == set(body.measures)


def test_people_differ_in_girth(people: list[RestBody]) -> None:
    girths = []
    for person in people:
        waist = person.joints[JOINT_NUMBERS['torso'], 1]
        level = np.abs(person.vertices[:, 1] - waist) < 0.03
        girths.append(np.ptp(person.vertices[level, 2]) / stature(person))
    assert np.std(girths) > 0.008


def naive_normals(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    normals = np.zeros_like(vertices)
    for a, b, c in triangles.astype(int):
        normal = np.cross(vertices[b] - vertices[a], vertices[c] - vertices[a])
        normals[[a, b, c]] += normal
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)


def test_normals_agree_with_the_equation(body: BodyModel, people: list[RestBody]) -> None:
    random = np.random.default_rng(3)
    vertices = random.normal(size=(40, 3))
    vertices[7] = vertices[8] = vertices[9]  # degenerate triangles
    triangles = random.integers(0, 40, (60, 3)).astype(np.uint16)
    triangles[(triangles == 39).any(axis=1)] = (7, 8, 9)  # vertex 39 has no triangle
    expected = naive_normals(vertices, triangles)
    np.testing.assert_allclose(vertex_normals(vertices, triangles), expected, atol=1e-12)
    assert not expected[39].any()
    own = vertex_normals(people[0].vertices, body.triangles)
    expected = naive_normals(people[0].vertices, body.triangles)
    np.testing.assert_allclose(own, expected, atol=1e-9)


def test_clothes_displace_the_skin_outwards_and_keep_the_joints(
    regions: ClothesRegions, people: list[RestBody]
) -> None:
    thickest = []
    for seed, naked in enumerate(people):
        dressed = dress(regions, naked, source(seed))
        np.testing.assert_array_equal(dressed.joints, naked.joints)
        np.testing.assert_array_equal(dressed.heads, naked.heads)
        moved = dressed.vertices - naked.vertices
        outward = (moved * vertex_normals(naked.vertices, regions.triangles)).sum(axis=1)
        assert outward.min() > -1e-12
        np.testing.assert_allclose(np.linalg.norm(moved, axis=1), outward, atol=1e-9)
        thickest.append(outward.max())
    assert max(thickest) < 0.09
    assert np.std(thickest) > 0.004


def test_clothes_regions_cover_the_right_parts(body: BodyModel, regions: ClothesRegions) -> None:
    weights = dict(zip(REGIONS, regions.weights.T, strict=True))
    assert (regions.weights >= 0).all()
    vertices = body.mean[: len(body.skin_bones)].astype(float)
    joints = body.mean[len(body.skin_bones) + len(body.bones) :].astype(float)
    head = joints[0]
    assert (vertices[weights['scalp'] > 0.5] > head - [1, 0.1, 1]).all()
    face = (np.abs(vertices[:, 0]) < 0.04) & (vertices[:, 2] > head[2] + 0.05)
    face &= np.abs(vertices[:, 1] - head[1]) < 0.08
    assert face.sum() > 50
    assert regions.weights[face].max() < 0.02
    hands = np.isin(
        body.skin_bones[:, 0],
        [n for n, name in enumerate(body.bones) if str(name).startswith('finger')],
    )
    assert regions.weights[hands].max() < 0.05
    assert (vertices[weights['long_hair'] > 0.5, 2] < head[2]).all()


def test_clothes_vary() -> None:
    thickness = np.array([sample_thickness(source(seed)) for seed in range(200)])
    assert (thickness >= 0).all()
    assert thickness.max() < 0.06
    bare = dict(zip(REGIONS, (thickness == 0).mean(axis=0), strict=True))
    assert 0.3 < bare['forearm'] < 0.5
    assert 0.15 < bare['shank'] < 0.35
    assert 0.6 < bare['long_hair'] < 0.8
    assert bare['trunk'] == 0


def test_hull_vertices_approximate_the_skin(body: BodyModel, people: list[RestBody]) -> None:
    numbers = hull_vertices(body)
    assert len(numbers) < 1500
    directions = np.random.default_rng(0).normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for person in people:
        along = person.vertices @ directions.T
        assert (along.max(axis=0) - along[numbers].max(axis=0)).max() < 0.012
