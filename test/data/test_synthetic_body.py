"""Synthetic bodies and poses: anatomy, limits, forward kinematics, the distance to solids."""

import numpy as np
import pytest
from numpy.typing import NDArray

from lsc_pose_ros.core.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.data.synthetic.body import SEGMENTS, Body, draw_body
from lsc_pose_ros.data.synthetic.pose import (
    ANGLE_NUMBERS,
    ANGLES,
    LIMITS,
    joint_positions,
    limits,
    place_segments,
    sole_height,
    within_limits,
)
from lsc_pose_ros.data.synthetic.solids import RoundCones, pose_solids, signed_distance


def source(seed: int) -> np.random.Generator:
    return np.random.Generator(np.random.PCG64(seed))


def angles_of(**degrees: float) -> NDArray[np.float64]:
    angles = np.zeros((1, len(ANGLES)))
    for name, value in degrees.items():
        angles[0, ANGLE_NUMBERS[name]] = np.radians(value)
    return angles


def joints_of(body: Body, **degrees: float) -> dict[str, NDArray[np.float64]]:
    positions = joint_positions(body, place_segments(body, angles_of(**degrees)))[0]
    return dict(zip(JOINT_NAMES, positions, strict=True))


def random_angles(seed: int, count: int) -> NDArray[np.float64]:
    low, high = limits()
    return within_limits(low + source(seed).random((count, len(ANGLES))) * (high - low))


@pytest.fixture(scope='module')
def adult() -> Body:
    return draw_body(source(4), 1.75)


@pytest.mark.parametrize('stature', [1.1, 1.35, 1.6, 1.95])
def test_body_is_as_tall_as_asked_from_sole_to_vertex(stature: float) -> None:
    for seed in range(5):
        body = draw_body(source(seed), stature)
        upright = place_segments(body, np.zeros((1, len(ANGLES))))
        cones = pose_solids(body.solids, upright)
        heads = (body.solids.segment == SEGMENTS.index('head')) & (cones.length == 0)
        vertex = (cones.origins[0, heads, 1] + cones.radii[heads, 0]).max()
        assert vertex - sole_height(body, upright)[0] == pytest.approx(stature, rel=0.01)


def test_feet_stand_on_their_soles(adult: Body) -> None:
    upright = place_segments(adult, np.zeros((1, len(ANGLES))))
    cones = pose_solids(adult.solids, upright)
    floor = sole_height(adult, upright)[0]
    ground = np.array([[[0.0, floor, 0.05], [0.1, floor, 0.05], [0.09, floor, 0.1]]])
    gap = signed_distance(ground, cones).min()
    assert abs(gap) < 0.012


def test_children_have_larger_heads_and_shorter_legs() -> None:
    child = [draw_body(source(seed), 1.1) for seed in range(20)]
    adult = [draw_body(source(seed), 1.8) for seed in range(20)]

    def mean_share(bodies: list[Body], upper: str, lower: str) -> float:
        shares = []
        for body in bodies:
            joints = joints_of(body)
            shares.append(np.linalg.norm(joints[upper] - joints[lower]) / body.stature)
        return float(np.mean(shares))

    def head(bodies: list[Body]) -> float:
        segment = SEGMENTS.index('head')
        return float(
            np.mean(
                [b.solids.radii[b.solids.segment == segment].max() / b.stature for b in bodies]
            )
        )

    assert head(child) > 1.25 * head(adult)
    assert mean_share(child, 'l_hip', 'l_ankle') < 0.93 * mean_share(adult, 'l_hip', 'l_ankle')


def test_girth_varies_between_people() -> None:
    def waist(seed: int) -> float:
        solids = draw_body(source(seed), 1.75).solids
        abdomen = solids.segment == SEGMENTS.index('abdomen')
        return float((solids.radii[abdomen, 0] * solids.squeeze[abdomen, 0]).max())

    waists = [waist(seed) for seed in range(40)]
    assert max(waists) > 1.3 * min(waists)
    assert min(waists) > 0.09
    assert max(waists) < 0.30


def test_every_joint_lies_inside_the_body_in_any_pose() -> None:
    for seed in range(6):
        body = draw_body(source(seed), 1.1 + 0.17 * seed)
        placement = place_segments(body, random_angles(seed, 50))
        cones = pose_solids(body.solids, placement)
        distance = signed_distance(joint_positions(body, placement), cones).min(axis=2)
        assert distance.max() < -0.005 * body.stature


def test_left_is_at_positive_x_and_feet_point_forwards(adult: Body) -> None:
    joints = joints_of(adult)
    for name in ('shoulder', 'elbow', 'wrist', 'hand', 'hip', 'knee', 'ankle', 'foot'):
        assert joints[f'l_{name}'][0] > 0.05
        assert joints[f'r_{name}'][0] < -0.05
    assert joints['l_foot'][2] > joints['l_ankle'][2] + 0.05
    heights = [joints[name][1] for name in ('head', 'neck', 'torso', 'pelvis', 'l_knee', 'l_foot')]
    assert (np.diff(heights) < 0).all()


@pytest.mark.parametrize(
    ('degrees', 'joint', 'axis', 'sign'),
    [
        ({'l_elevation': 90}, 'l_hand', 0, 1),  # sideways: the left hand goes left
        ({'r_elevation': 90}, 'r_hand', 0, -1),
        ({'l_elevation': 90, 'l_plane': 90}, 'l_hand', 2, 1),
        ({'l_elevation': 160}, 'l_hand', 1, 1),
        ({'l_elbow': 90}, 'l_hand', 2, 1),
        ({'l_elbow': 90, 'l_axial': 60}, 'l_hand', 0, 1),  # outwards
        ({'r_elbow': 90, 'r_axial': 60}, 'r_hand', 0, -1),
        ({'l_hip_flexion': 80}, 'l_knee', 2, 1),
        ({'l_hip_abduction': 40}, 'l_ankle', 0, 1),
        ({'r_hip_abduction': 40}, 'r_ankle', 0, -1),
        ({'l_knee': 90}, 'l_ankle', 2, -1),
        ({'l_ankle': 40}, 'l_foot', 1, -1),
        ({'bend': 60}, 'head', 2, 1),
        ({'side': 30}, 'head', 0, 1),
        ({'lean': 30}, 'head', 2, 1),
        ({'nod': 40}, 'head', 2, 1),
        ({'twist': 40}, 'l_shoulder', 2, -1),  # to the left: the left shoulder goes back
    ],
)
def test_an_angle_moves_its_joint_the_way_its_name_says(
    adult: Body, degrees: dict[str, float], joint: str, axis: int, sign: int
) -> None:
    moved = joints_of(adult, **degrees)[joint] - joints_of(adult)[joint]
    assert sign * moved[axis] > 0.02


def test_elbow_flexion_is_the_angle_between_the_bones(adult: Body) -> None:
    joints = joints_of(adult, l_elbow=70, l_elevation=50, l_plane=30, l_axial=20)
    upper = joints['l_elbow'] - joints['l_shoulder']
    lower = joints['l_wrist'] - joints['l_elbow']
    cosine = upper @ lower / np.linalg.norm(upper) / np.linalg.norm(lower)
    assert np.degrees(np.arccos(cosine)) == pytest.approx(70)


def test_bones_keep_their_length_in_any_pose(adult: Body) -> None:
    placement = place_segments(adult, random_angles(1, 100))
    positions = joint_positions(adult, placement)
    rest = joint_positions(adult, place_segments(adult, np.zeros((1, len(ANGLES)))))
    for one, other in (
        ('l_shoulder', 'l_elbow'),
        ('r_elbow', 'r_wrist'),
        ('l_wrist', 'l_hand'),
        ('pelvis', 'l_hip'),
        ('r_hip', 'r_knee'),
        ('l_knee', 'l_ankle'),
        ('r_ankle', 'r_foot'),
        ('neck', 'head'),
    ):
        pair = [JOINT_NUMBERS[one], JOINT_NUMBERS[other]]
        lengths = np.linalg.norm(np.diff(positions[:, pair], axis=1), axis=2)
        length = np.linalg.norm(np.diff(rest[:, pair], axis=1))
        np.testing.assert_allclose(lengths, length, rtol=1e-9)


def test_mirrored_angles_give_the_mirrored_body(adult: Body) -> None:
    angles = random_angles(2, 20)
    mirrored = angles.copy()
    for name, number in ANGLE_NUMBERS.items():
        if name.startswith('l_'):
            twin = ANGLE_NUMBERS['r_' + name[2:]]
            mirrored[:, [number, twin]] = angles[:, [twin, number]]
    for name in ('side', 'twist', 'tilt', 'turn'):
        mirrored[:, ANGLE_NUMBERS[name]] *= -1
    straight = joint_positions(adult, place_segments(adult, angles))
    swapped = joint_positions(adult, place_segments(adult, mirrored))
    partners = [
        JOINT_NUMBERS[{'l': 'r', 'r': 'l'}[name[0]] + name[1:] if name[1] == '_' else name]
        for name in JOINT_NAMES
    ]
    np.testing.assert_allclose(swapped[:, partners], straight * [-1, 1, 1], atol=1e-12)


def test_segments_only_turn() -> None:
    body = draw_body(source(3), 1.5)
    rotations = place_segments(body, random_angles(5, 30)).rotations
    identity = rotations @ rotations.transpose(0, 1, 3, 2)
    np.testing.assert_allclose(identity, np.broadcast_to(np.eye(3), identity.shape), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(rotations), 1.0)


def test_limits_hold_for_any_wish() -> None:
    wishes = source(6).uniform(-7, 7, (500, len(ANGLES)))
    kept = np.degrees(within_limits(wishes))
    for name, number in ANGLE_NUMBERS.items():
        low, high = LIMITS[name if name in LIMITS else name[2:]]
        assert kept[:, number].min() >= low - 1e-9
        assert kept[:, number].max() <= high + 1e-9
    behind = kept[:, ANGLE_NUMBERS['l_plane']] < -45
    assert behind.any()
    assert kept[behind, ANGLE_NUMBERS['l_elevation']].max() < 120


def test_limits_leave_what_is_within_alone() -> None:
    angles = random_angles(7, 100)
    np.testing.assert_array_equal(within_limits(angles), angles)


def naive_distance(point: NDArray[np.float64], length: float, radii: NDArray[np.float64]) -> float:
    """The distance to a union of many spheres along the axis, which a round cone is."""
    shares = np.linspace(0, 1, 20001)
    centres = np.stack([0 * shares, length * shares, 0 * shares], axis=1)
    away = np.linalg.norm(point - centres, axis=1)
    return float((away - (radii[0] + shares * (radii[1] - radii[0]))).min())


def test_signed_distance_agrees_with_a_union_of_spheres() -> None:
    random = source(8)
    lengths = np.array([0.5, 0.3, 0.0, 0.2, 0.4])
    radii = np.array([[0.1, 0.1], [0.2, 0.05], [0.1, 0.1], [0.05, 0.2], [0.0, 0.1]])
    turns = np.linalg.qr(random.standard_normal((5, 3, 3)))[0]
    origins = random.uniform(-0.2, 0.2, (1, 5, 3))
    points = random.uniform(-0.6, 0.6, (1, 60, 3))
    cones = RoundCones(origins, turns[None], lengths, radii)
    found = signed_distance(points, cones)[0]
    for place, point in enumerate(points[0]):
        for solid in range(5):
            own = turns[solid] @ (point - origins[0, solid])
            expected = naive_distance(own, lengths[solid], radii[solid])
            assert found[place, solid] == pytest.approx(expected, abs=1e-5)


def test_signed_distance_has_the_right_sign_where_solids_are_squeezed() -> None:
    inward = np.diag([1 / 2.0, 1.0, 1 / 0.5])[None, None]
    cones = RoundCones(np.zeros((1, 1, 3)), inward, np.zeros(1), np.full((1, 2), 0.1))
    points = np.array([[[0.19, 0, 0], [0.21, 0, 0], [0, 0, 0.049], [0, 0, 0.051], [0, 0.099, 0]]])
    signs = signed_distance(points, cones)[0, :, 0] < 0
    assert signs.tolist() == [True, False, True, False, True]
