"""Who synthetic people are and what they wear."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.body.body_file import Body, load_body
from lsc_pose_ros.synthetic.body.body_mesh import Rest, shape_body, stature
from lsc_pose_ros.synthetic.body.clothes import (
    PARTS,
    Wardrobe,
    draw_thickness,
    dress,
    open_wardrobe,
    vertex_normals,
)
from lsc_pose_ros.synthetic.body.population import Population, Tailor, draw_build, draw_stature
from lsc_pose_ros.synthetic.people import outermost_vertices


def source(seed: int) -> np.random.Generator:
    return np.random.Generator(np.random.PCG64(seed))


@pytest.fixture(scope='module')
def body() -> Body:
    return load_body()


@pytest.fixture(scope='module')
def people(body: Body) -> list[Rest]:
    tailor, random = Tailor(body), source(1)
    return [tailor.draw(Population(), random) for _ in range(12)]


@pytest.fixture(scope='module')
def wardrobe(body: Body) -> Wardrobe:
    return open_wardrobe(body)


def drawn(population: Population, count: int = 400) -> np.ndarray:
    """Ages, sexes and statures, shape (count, 3)."""
    random = source(2)
    return np.array([draw_stature(population, random) for _ in range(count)])


def test_all_ages_sexes_and_statures_are_drawn() -> None:
    age, sex, metres = drawn(Population()).T
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
def test_statures_are_about_those_of_the_age_and_sex(
    age: float, sex: float, expected: float
) -> None:
    people = drawn(Population(age=(age, age)), 2000)
    metres = people[people[:, 1] == sex, 2]
    assert metres.mean() == pytest.approx(expected, rel=0.01)
    assert np.abs(metres / expected - 1).max() < 0.12


def test_ages_and_statures_asked_for_are_kept() -> None:
    age, _, metres = drawn(Population(age=(8, 30), stature=(1.5, 1.6))).T
    assert 8 <= age.min() < age.max() <= 30
    assert 1.5 <= metres.min() < metres.max() <= 1.6
    with pytest.raises(InputError, match=r'hardly anybody aged 2 to 3 is 1\.7 to 1\.8 m tall'):
        draw_stature(Population(age=(2, 3), stature=(1.7, 1.8)), source(0))


def test_people_are_as_tall_as_drawn(body: Body) -> None:
    tailor = Tailor(body)
    for seed in range(8):
        *_, metres = draw_stature(Population(), source(seed))
        assert stature(tailor.draw(Population(), source(seed))) == pytest.approx(metres, abs=0.003)


@pytest.mark.parametrize('age', [1.0, 4.0, 12.0, 30.0, 90.0])
def test_every_build_is_possible(body: Body, age: float) -> None:
    for seed in range(20):
        figure = draw_build(body, age, seed % 2, source(seed))
        shape_body(body, figure)  # refuses what is out of range
        assert 0.1 <= figure.weight <= 0.95
        assert set(figure.measures) == set(body.measures)


def test_people_differ_in_girth(people: list[Rest]) -> None:
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


def test_normals_are_those_of_the_equation(body: Body, people: list[Rest]) -> None:
    random = np.random.default_rng(3)
    vertices = random.normal(size=(40, 3))
    vertices[7] = vertices[8] = vertices[9]  # triangles that are points and lines
    triangles = random.integers(0, 40, (60, 3)).astype(np.uint16)
    triangles[(triangles == 39).any(axis=1)] = (7, 8, 9)  # vertex 39 is in none
    expected = naive_normals(vertices, triangles)
    np.testing.assert_allclose(vertex_normals(vertices, triangles), expected, atol=1e-12)
    assert not expected[39].any()
    own = vertex_normals(people[0].vertices, body.triangles)
    expected = naive_normals(people[0].vertices, body.triangles)
    np.testing.assert_allclose(own, expected, atol=1e-9)


def test_clothes_move_the_skin_outward_a_little_and_leave_the_joints(
    wardrobe: Wardrobe, people: list[Rest]
) -> None:
    thickest = []
    for seed, naked in enumerate(people):
        dressed = dress(wardrobe, naked, source(seed))
        np.testing.assert_array_equal(dressed.joints, naked.joints)
        np.testing.assert_array_equal(dressed.heads, naked.heads)
        moved = dressed.vertices - naked.vertices
        outward = (moved * vertex_normals(naked.vertices, wardrobe.triangles)).sum(axis=1)
        assert outward.min() > -1e-12
        np.testing.assert_allclose(np.linalg.norm(moved, axis=1), outward, atol=1e-9)
        thickest.append(outward.max())
    assert max(thickest) < 0.09
    assert np.std(thickest) > 0.004


def test_clothes_cover_what_they_are_for(body: Body, wardrobe: Wardrobe) -> None:
    shares = dict(zip(PARTS, wardrobe.shares.T, strict=True))
    assert (wardrobe.shares >= 0).all()
    vertices = body.mean[: len(body.skin_bones)].astype(float)
    joints = body.mean[len(body.skin_bones) + len(body.bones) :].astype(float)
    head = joints[0]
    assert (vertices[shares['scalp'] > 0.5] > head - [1, 0.1, 1]).all()
    face = (np.abs(vertices[:, 0]) < 0.04) & (vertices[:, 2] > head[2] + 0.05)
    face &= np.abs(vertices[:, 1] - head[1]) < 0.08
    assert face.sum() > 50
    assert wardrobe.shares[face].max() < 0.02
    hands = np.isin(
        body.skin_bones[:, 0],
        [n for n, name in enumerate(body.bones) if str(name).startswith('finger')],
    )
    assert wardrobe.shares[hands].max() < 0.05
    assert (vertices[shares['mane'] > 0.5, 2] < head[2]).all()


def test_clothes_vary() -> None:
    thickness = np.array([draw_thickness(source(seed)) for seed in range(200)])
    assert (thickness >= 0).all()
    assert thickness.max() < 0.06
    bare = dict(zip(PARTS, (thickness == 0).mean(axis=0), strict=True))
    assert 0.3 < bare['forearm'] < 0.5
    assert 0.15 < bare['shank'] < 0.35
    assert 0.6 < bare['mane'] < 0.8
    assert bare['trunk'] == 0


def test_outermost_vertices_stand_for_the_skin(body: Body, people: list[Rest]) -> None:
    numbers = outermost_vertices(body)
    assert len(numbers) < 1500
    directions = np.random.default_rng(0).normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for person in people:
        along = person.vertices @ directions.T
        assert (along.max(axis=0) - along[numbers].max(axis=0)).max() < 0.012
