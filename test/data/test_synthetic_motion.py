"""How synthetic people move, and where they stand."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from lsc_pose_ros.core.camera import Intrinsics
from lsc_pose_ros.data.synthetic.body import Body, draw_body
from lsc_pose_ros.data.synthetic.motion import DEEPEST, draw_motion, interpolate
from lsc_pose_ros.data.synthetic.overlap import deepest_overlap
from lsc_pose_ros.data.synthetic.pose import (
    ANGLE_NUMBERS,
    ANGLES,
    joint_positions,
    place_segments,
    within_limits,
)
from lsc_pose_ros.data.synthetic.stage import STEEPEST, Spheres, View, set_stage
from lsc_pose_ros.errors import InputError

RATE = 30.0


def source(seed: int) -> np.random.Generator:
    return np.random.Generator(np.random.PCG64(seed))


@pytest.fixture(scope='module')
def body() -> Body:
    return draw_body(source(1), 1.7)


def test_motion_keeps_limits_and_yaw(body: Body) -> None:
    for seed in range(5):
        motion = draw_motion(body, 90, RATE, 0.4, source(seed))
        assert motion.angles.shape == (90, len(ANGLES))
        np.testing.assert_allclose(within_limits(motion.angles), motion.angles, atol=0.12)
        assert np.abs(motion.yaw).max() <= 0.4


def test_motion_is_smooth(body: Body) -> None:
    for seed in range(5):
        motion = draw_motion(body, 90, RATE, 1.0, source(seed))
        joints = joint_positions(body, place_segments(body, motion.angles))
        steps = np.linalg.norm(np.diff(joints, axis=0), axis=2)
        # The fastest strikes of trained people are some 10 m/s.
        assert steps.max() * RATE < 14
        assert steps.mean() * RATE > 0.05
        turns = np.abs(np.diff(motion.angles, n=2, axis=0)).max()
        assert turns < np.radians(30)


def test_motion_is_the_same_for_the_same_seed(body: Body) -> None:
    first = draw_motion(body, 40, RATE, 1.0, source(9))
    again = draw_motion(body, 40, RATE, 1.0, source(9))
    other = draw_motion(body, 40, RATE, 1.0, source(10))
    np.testing.assert_array_equal(first.angles, again.angles)
    np.testing.assert_array_equal(first.yaw, again.yaw)
    assert np.abs(first.angles - other.angles).max() > 0.1


def test_limbs_hardly_ever_go_through_the_body() -> None:
    deepest = []
    for seed in range(8):
        person = draw_body(source(seed), 1.2 + 0.1 * seed)
        motion = draw_motion(person, 60, RATE, 1.0, source(seed))
        deepest.append(deepest_overlap(person, motion.angles))
    everything = np.concatenate(deepest)
    assert (everything <= DEEPEST + 0.01).mean() > 0.97
    assert everything.max() < 0.08


def test_overlap_sees_a_hand_in_the_chest_and_none_at_rest(body: Body) -> None:
    rest = np.zeros((1, len(ANGLES)))
    for side in ('l', 'r'):
        rest[0, ANGLE_NUMBERS[f'{side}_elevation']] = np.radians(25)
        rest[0, ANGLE_NUMBERS[f'{side}_hip_abduction']] = np.radians(5)
    assert deepest_overlap(body, rest)[0] < DEEPEST
    through = rest.copy()
    through[0, ANGLE_NUMBERS['l_axial']] = np.radians(-70)
    through[0, ANGLE_NUMBERS['l_elbow']] = np.radians(100)
    through[0, ANGLE_NUMBERS['l_elevation']] = 0.0
    assert deepest_overlap(body, through)[0] > 0.04
    crossed = rest.copy()
    crossed[0, ANGLE_NUMBERS['l_hip_abduction']] = np.radians(-12)
    crossed[0, ANGLE_NUMBERS['r_hip_abduction']] = np.radians(-12)
    assert deepest_overlap(body, crossed)[0] > DEEPEST


def test_arms_and_legs_go_everywhere() -> None:
    """A training set needs variety: hands up, forwards, aside; knees bent; backs bent."""
    angles = []
    for seed in range(20):
        person = draw_body(source(seed), 1.7)
        angles.append(draw_motion(person, 60, RATE, 1.0, source(seed)).angles)
    degrees = np.degrees(np.concatenate(angles))
    for name, spread in (('l_elevation', 35), ('r_elbow', 35), ('l_knee', 18), ('bend', 8)):
        assert degrees[:, ANGLE_NUMBERS[name]].std() > spread


def naive_interpolate(
    time: float, key_times: NDArray[np.float64], keys: NDArray[np.float64]
) -> NDArray[np.float64]:
    for first, (start, end) in enumerate(pairwise(key_times)):
        if start <= time < end or (time >= end and first == len(keys) - 2):
            u = min((time - start) / (end - start), 1.0)
            share = 10 * u**3 - 15 * u**4 + 6 * u**5
            return np.asarray((1 - share) * keys[first] + share * keys[first + 1])
    return keys[0]


def test_interpolation_goes_through_the_keys_with_minimum_jerk() -> None:
    random = source(2)
    key_times = np.array([0.0, 0.4, 1.1, 1.5])
    keys = random.standard_normal((4, 3))
    times = np.concatenate([key_times, random.random(50) * 1.6])
    values = interpolate(times, key_times, keys)
    np.testing.assert_allclose(values[:4], keys, atol=1e-12)
    expected = [naive_interpolate(time, key_times, keys) for time in times]
    np.testing.assert_allclose(values, expected, atol=1e-12)


CAMERA = Intrinsics(286.0, 286.0, 159.5, 119.5)
VIEW = View(CAMERA, 320, 240, (1.5, 4.0), cropped=False)


def column(height: float, radius: float = 0.3) -> Spheres:
    """A person made of a stack of spheres, y down, feet at 0."""
    heights = np.arange(radius, height - radius, 0.1)
    centres = np.stack([0 * heights, -heights, 0 * heights], axis=1)
    return Spheres(np.repeat(centres[None], 3, axis=0), np.full(len(heights), radius))


def outside(person: Spheres, tilt: NDArray[np.float64], offset: NDArray[np.float64]) -> float:
    """How far, in pixels, points all over the spheres project outside the image; negative: in."""
    points = source(0).standard_normal((400, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    surface = person.centres[0][:, None] + person.radii[:, None, None] * points
    seen = (surface + offset) @ tilt.T
    u = CAMERA.cx + CAMERA.fx * seen[..., 0] / seen[..., 2]
    v = CAMERA.cy + CAMERA.fy * seen[..., 1] / seen[..., 2]
    return float(max((-u).max(), (u - 319).max(), (-v).max(), (v - 239).max()))


@pytest.mark.parametrize('height', [1.1, 1.7, 2.2])
def test_one_person_stands_in_full_view_and_not_always_in_the_same_place(height: float) -> None:
    person = column(height)
    stages = [set_stage([person], VIEW, source(seed)) for seed in range(50)]
    for stage in stages:
        assert outside(person, stage.tilt, stage.offsets[0]) < -2
        assert 1.5 <= stage.offsets[0, 2] <= 4.0
        assert abs(np.arctan2(stage.tilt[2, 1], stage.tilt[1, 1])) <= STEEPEST
    offsets = np.array([stage.offsets[0] for stage in stages])
    assert (offsets.std(axis=0) > [0.15, 0.04, 0.2]).all()


def test_person_may_come_as_near_as_the_image_allows() -> None:
    person = column(1.7)
    distances = [set_stage([person], VIEW, source(seed)).offsets[0, 2] for seed in range(200)]
    assert min(distances) < 2.5


def test_several_people_share_a_floor_and_never_touch() -> None:
    people = [column(1.2), column(1.7), column(1.8)]
    for seed in range(20):
        stage = set_stage(people, VIEW._replace(distance=(1.5, 5.0)), source(seed))
        assert np.ptp(stage.offsets[:, 1]) == 0
        for person, offset in zip(people, stage.offsets, strict=True):
            assert outside(person, stage.tilt, offset) < -2
        for one, other in ((0, 1), (0, 2), (1, 2)):
            gap = np.linalg.norm((stage.offsets[one] - stage.offsets[other])[[0, 2]])
            assert gap >= 0.6


def test_cropped_people_come_closer_but_stay_in_sight() -> None:
    person = column(1.8)
    near = View(CAMERA, 320, 240, (1.0, 1.2), cropped=True)
    for seed in range(20):
        stage = set_stage([person], near, source(seed))
        middle = (person.centres[0].mean(axis=0) + stage.offsets[0]) @ stage.tilt.T
        pixel = CAMERA.cx + CAMERA.fx * middle[:2] / middle[2]
        assert 0 <= pixel[0] <= 319


def test_a_place_that_is_too_small_is_refused() -> None:
    with pytest.raises(InputError, match=r'no place found for a person .* 1 and 1\.5 m'):
        set_stage([column(1.8)], VIEW._replace(distance=(1.0, 1.5)), source(0))
    with pytest.raises(InputError, match='no place found for 8 people'):
        set_stage([column(1.8)] * 8, VIEW._replace(distance=(2.0, 3.0)), source(0))
