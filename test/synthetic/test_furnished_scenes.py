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

"""Tests furnished scenes: what stands where, what hides people, and who sits."""

from collections.abc import Iterator

import numpy as np
import pytest

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.body.skin_parts import NO_PART
from lsc_pose_ros.synthetic.generator import (
    SyntheticScene,
    SyntheticSettings,
    synthetic_frames,
    synthetic_scenes,
)
from lsc_pose_ros.synthetic.people import PersonSampler, looks_seated
from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.clearance import is_clear
from lsc_pose_ros.synthetic.scene.furnishing import Furnishing, furnish
from lsc_pose_ros.synthetic.scene.occupant import SEAT, Occupant
from lsc_pose_ros.synthetic.scene.placement import ScenePlacement, tilt_rotation
from lsc_pose_ros.synthetic.scene.seats import CONTACT
from lsc_pose_ros.synthetic.sensors.sensors import SENSORS
from lsc_pose_ros.synthetic.settings import check

FURNISHED = SyntheticSettings(frames=24, clip_length=6, furniture=True, noise='none', seed=5)
HEIGHT = 1.3


def rooms(count: int) -> Iterator[tuple[list[Occupant], Furnishing]]:
    """Yield people with the furniture around them."""
    sampler = PersonSampler(FURNISHED)
    random = np.random.default_rng(7)
    rest = sampler.sample_body(random)
    positions = np.array([[-0.4, HEIGHT, 2.2], [0.8, HEIGHT, 3.4]])
    placement = ScenePlacement(tilt_rotation(0.1), positions, HEIGHT)
    people = [sampler.sample_person(rest, count, random) for _ in range(2)]
    for frame in range(count):
        occupants = [
            sampler.occupant(person.single_frame(frame), placement, number)
            for number, person in enumerate(people)
        ]
        yield occupants, furnish(occupants, HEIGHT, 0.5, RandomStream(random, 8192))


@pytest.fixture(scope='module')
def furnished() -> list[tuple[list[Occupant], Furnishing]]:
    return list(rooms(60))


@pytest.fixture(scope='module')
def scenes() -> list[SyntheticScene]:
    return list(synthetic_scenes(FURNISHED._replace(frames=60)))


def test_furniture_does_not_intersect_people(
    furnished: list[tuple[list[Occupant], Furnishing]],
) -> None:
    for occupants, furnishing in furnished:
        for piece in furnishing.pieces:
            for occupant in occupants:
                assert is_clear(piece.blocks, occupant.points.reshape(-1, 3), CONTACT)


def test_rooms_have_some_to_many_pieces_and_walls_around_them(
    furnished: list[tuple[list[Occupant], Furnishing]],
) -> None:
    counts = [len(furnishing.pieces) for _, furnishing in furnished]
    assert np.percentile(counts, 10) >= 2
    assert np.percentile(counts, 90) >= 8
    assert max(counts) <= 25
    assert all(len(furnishing.walls.centres) == 1 for _, furnishing in furnished)


def test_seats_touch_those_who_sit_on_them(
    furnished: list[tuple[list[Occupant], Furnishing]],
) -> None:
    seated = touched = 0
    for occupants, furnishing in furnished:
        for occupant, seat in zip(occupants, furnishing.seats, strict=True):
            if not occupant.seated:
                assert seat is None or occupant.raised
                continue
            seated += 1
            if seat is None:
                continue
            bottom = occupant.points[:, occupant.regions == SEAT].reshape(-1, 3)
            touched += not is_clear(seat.blocks, bottom, 0.02)
    assert 0.12 * 2 * len(furnished) < seated < 0.4 * 2 * len(furnished)
    assert touched >= 0.9 * seated


def test_people_on_seats_are_recognised_by_their_balance() -> None:
    sampler = PersonSampler(FURNISHED)
    random = np.random.default_rng(1)
    on_seats, others = [], []
    for _ in range(10):
        person = sampler.sample_person(sampler.sample_body(random), 30, random)
        looks = looks_seated(person.joints)
        lies = np.zeros(30, bool) if person.lying is None else person.lying.lies
        on_seats += looks[person.seated].tolist()
        others += looks[~person.seated & ~lies].tolist()
    assert np.mean(on_seats) > 0.6
    assert np.mean(others) < 0.02


def test_people_who_lie_are_level_and_touch_bed_or_floor() -> None:
    sampler = PersonSampler(FURNISHED)
    random = np.random.default_rng(8)
    rest = sampler.sample_body(random)
    placement = ScenePlacement(np.eye(3), np.array([[0.0, HEIGHT, 3.0]]), HEIGHT)
    lying = on_bed = supported = 0
    people = [sampler.sample_person(rest, 40, random) for _ in range(8)]
    for person in people:
        if person.lying is None:
            continue
        for frame in np.flatnonzero(person.lying.lies):
            one = person.single_frame(int(frame))
            occupant = sampler.occupant(one, placement, 0)
            lift = person.lying.lift[frame]
            lying += 1
            on_bed += lift > 0
            assert not occupant.seated
            assert occupant.raised == (lift > 0)
            assert abs(occupant.joint('head')[1] - occupant.joint('pelvis')[1]) < 0.45
            lowest = HEIGHT - occupant.points[..., 1].max()
            assert lowest == pytest.approx(lift, abs=0.03)
            bed = furnish([occupant], HEIGHT, 0.5, RandomStream(random, 8192)).seats[0]
            if bed is not None:
                supported += 1
                assert not is_clear(bed.blocks, occupant.points.reshape(-1, 3), 0.02)
    assert 5 <= lying < 0.15 * 320
    assert 0 < on_bed < lying
    assert supported >= 0.8 * on_bed


def test_furniture_hides_parts_of_people(scenes: list[SyntheticScene]) -> None:
    """In many frames, some part of the body is missing, but somebody is nearly always seen."""
    counts = [len(np.unique(scene.parts)) - 1 for scene in scenes]
    assert np.mean(np.array(counts) < 15) > 0.3
    assert np.mean(np.array(counts) > 2) > 0.9


def test_parts_agree_with_the_labels(scenes: list[SyntheticScene]) -> None:
    for scene in scenes:
        np.testing.assert_array_equal(scene.parts != NO_PART, scene.frame.labels != NO_BODY)
        assert scene.parts.max() <= len(JOINT_NAMES)
        assert (scene.frame.depth[scene.parts != NO_PART] > 0).all()


def test_image_is_full_except_for_margins(scenes: list[SyntheticScene]) -> None:
    margins = 0
    for scene in scenes:
        measured = scene.frame.depth > 0
        rows, columns = np.flatnonzero(measured.any(axis=1)), np.flatnonzero(measured.any(axis=0))
        inner = measured[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        assert inner.mean() > 0.999
        assert rows[0] <= 0.08 * 240 + 1
        assert columns[0] <= 0.08 * 320 + 1
        margins += not measured.all()
    assert 0.15 < margins / len(scenes) < 0.6


@pytest.mark.parametrize('change', [{}, {'noise': None, 'people': 2}, {'rate': 30.0}])
def test_seed_gives_the_same_scenes(change: dict[str, object]) -> None:
    settings = FURNISHED._replace(frames=8)._replace(**change)
    for one, other in zip(synthetic_scenes(settings), synthetic_scenes(settings), strict=True):
        np.testing.assert_array_equal(one.frame.depth, other.frame.depth)
        np.testing.assert_array_equal(one.parts, other.parts)
    few = synthetic_scenes(settings._replace(frames=3))
    for scene, frame in zip(few, synthetic_frames(settings), strict=False):
        np.testing.assert_array_equal(scene.frame.labels, frame.labels)


def test_room_can_be_without_people() -> None:
    for scene in synthetic_scenes(FURNISHED._replace(people=0)):
        assert (scene.frame.labels == NO_BODY).all()
        assert scene.frame.ground_truth is not None
        assert scene.frame.ground_truth.positions.shape == (0, len(JOINT_NAMES), 3)
        assert (scene.frame.depth > 0).mean() > 0.7
        assert np.std(scene.frame.depth) > 0.05


def test_only_furnished_rooms_can_be_without_people() -> None:
    check(FURNISHED._replace(people=0))
    with pytest.raises(InputError, match='people is 0; give 1 to 8'):
        check(SyntheticSettings(people=0))
    with pytest.raises(InputError, match='people is 9; give 0 to 8'):
        check(FURNISHED._replace(people=9))


@pytest.mark.parametrize('name', SENSORS)
def test_each_sensor_shows_furnished_scenes(name: str) -> None:
    settings = FURNISHED._replace(frames=2, clip_length=2, sensor=name, noise=None, people=2)
    for scene in synthetic_scenes(settings):
        assert scene.frame.depth.shape == (SENSORS[name].height, SENSORS[name].width)
        assert (scene.frame.depth > 0).mean() > 0.2
        np.testing.assert_array_equal(scene.parts != NO_PART, scene.frame.labels != NO_BODY)


def test_furniture_stands_still_in_a_video() -> None:
    settings = FURNISHED._replace(frames=6, rate=30.0)
    frames = list(synthetic_frames(settings))
    nobody = np.all([frame.labels == NO_BODY for frame in frames], axis=0)
    for frame in frames[1:]:
        np.testing.assert_array_equal(frame.depth[nobody], frames[0].depth[nobody])
