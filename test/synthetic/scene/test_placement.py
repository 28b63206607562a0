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

"""Tests the placement of camera and people, and the room around them."""

import numpy as np
import pytest
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.scene.depth_image import DepthImage
from lsc_pose_ros.synthetic.scene.placement import (
    IMAGE_MARGIN,
    PEOPLE_GAP,
    CameraConstraints,
    PersonExtent,
    ScenePlacement,
    sample_placement,
    tilt_rotation,
)
from lsc_pose_ros.synthetic.scene.room import Room, render_room, sample_room

CAMERA = Intrinsics(286.0, 286.0, 159.5, 119.5)
VIEW = CameraConstraints(
    CAMERA, 320, 240, (1.5, 4.0), camera_height=(0.5, 2.2), tilt=(-0.2, 0.5), cropped=False
)


def source(seed: int) -> np.random.Generator:
    return np.random.Generator(np.random.PCG64(seed))


def column(height: float, radius: float = 0.3) -> PersonExtent:
    """Return a person as a cylinder that sways in three frames, y down, on the floor."""
    angles = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ring = radius * np.stack([np.cos(angles), 0 * angles, np.sin(angles)], axis=1)
    points = np.concatenate([ring, ring - np.array([0, height, 0])])
    sways = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0, -0.1]])
    return PersonExtent(points + sways[:, None], np.tile([0.0, -0.6 * height, 0.0], (3, 1)))


def pixels(
    points: NDArray[np.float64], placement: ScenePlacement, number: int
) -> NDArray[np.float64]:
    camera_points = (points + placement.positions[number]) @ placement.tilt.T
    assert (camera_points[..., 2] > 0).all()
    return camera_points[..., :2] / camera_points[..., 2:] * CAMERA[:2] + CAMERA[2:4]


def assert_inside(places: NDArray[np.float64], margin: float) -> None:
    assert places.min() > margin - 1e-6
    assert (places < np.array([319, 239]) - margin + 1e-6).all()


def angle_of(placement: ScenePlacement) -> float:
    return float(np.arctan2(placement.tilt[2, 1], placement.tilt[1, 1]))


@pytest.mark.parametrize('height', [1.1, 1.7, 2.2])
def test_one_person_is_in_full_view_at_varying_positions(height: float) -> None:
    person = column(height)
    stages = [sample_placement([person], VIEW, source(seed)) for seed in range(60)]
    for placement in stages:
        assert_inside(pixels(person.points, placement, 0), IMAGE_MARGIN)
        assert 1.5 <= placement.positions[0, 2] <= 4.0
        assert 0.5 <= placement.positions[0, 1] <= 2.2
        assert -0.2 <= angle_of(placement) <= 0.5
    positions = np.array([placement.positions[0] for placement in stages])
    assert (positions.std(axis=0) > [0.15, 0.2, 0.2]).all()
    assert np.std([angle_of(placement) for placement in stages]) > 0.05


def test_person_can_be_as_near_as_the_image_allows() -> None:
    person = column(1.7)
    distances = [
        sample_placement([person], VIEW, source(seed)).positions[0, 2] for seed in range(200)
    ]
    assert min(distances) < 2.6


def test_positive_tilt_looks_down() -> None:
    ahead = np.array([0.0, 0.0, 3.0])
    assert (tilt_rotation(0.3) @ ahead)[
        1
    ] < 0  # a point level with the camera is in the upper half of the image


def test_several_people_are_on_one_floor_and_never_touch() -> None:
    people = [column(1.2), column(1.7), column(1.8)]
    for seed in range(20):
        placement = sample_placement(people, VIEW._replace(distance=(1.5, 5.0)), source(seed))
        assert np.ptp(placement.positions[:, 1]) == 0
        for number, person in enumerate(people):
            assert_inside(pixels(person.points, placement, number), IMAGE_MARGIN)
        for one in range(3):
            for other in range(one):
                first = people[one].points + placement.positions[one]
                second = people[other].points + placement.positions[other]
                for frame in range(3):
                    away = first[frame][:, None, [0, 2]] - second[frame][None, :, [0, 2]]
                    assert np.sqrt((away**2).sum(axis=-1)).min() > PEOPLE_GAP


def test_cropped_people_keep_their_trunk_in_view() -> None:
    person = column(1.9)
    constraints = VIEW._replace(distance=(0.8, 1.0), cropped=True)
    cut = 0
    for seed in range(20):
        placement = sample_placement([person], constraints, source(seed))
        assert_inside(pixels(person.trunk, placement, 0), 0)
        places = pixels(person.points, placement, 0)
        cut += bool(places.min() < 0 or places[..., 1].max() > 239)
    assert cut == 20


def test_people_can_stay_together_and_overlap_in_the_image() -> None:
    people = [column(1.7), column(1.6), column(1.8)]
    view = VIEW._replace(together=True, bearing_difference=0.02, people_gap=0.01, cropped=True)
    nearest = []
    for seed in range(20):
        positions = sample_placement(people, view, source(seed)).positions[:, [0, 2]]
        distances = np.linalg.norm(positions[1:] - positions[0], axis=1)
        assert distances.max() <= 0.8 * 2**0.5
        assert distances.min() >= 0.6
        nearest.append(distances.min())
    assert np.min(nearest) < 0.8


def test_impossible_placement_is_refused() -> None:
    with pytest.raises(InputError, match=r'no placement found for a person .* 1 and 1\.5 m'):
        sample_placement([column(1.8)], VIEW._replace(distance=(1.0, 1.5)), source(0))
    with pytest.raises(InputError, match='no placement found for 8 people'):
        sample_placement([column(1.8)] * 8, VIEW._replace(distance=(2.0, 3.0)), source(0))
    with pytest.raises(InputError, match="larger ranges of the camera's height and tilt"):
        sample_placement([column(1.8)], VIEW._replace(camera_height=(9.0, 9.1)), source(0))


def naive_room(room: Room, tilt: NDArray[np.float64], width: int, height: int) -> np.ndarray:
    """Intersect each ray with each side of each box."""
    depth = np.full((height, width), np.inf)
    for row in range(height):
        for col in range(width):
            x = (col - CAMERA.cx) / CAMERA.fx
            y = (row - CAMERA.cy) / CAMERA.fy
            ray = tilt.T @ [x, y, 1.0]
            for centre, half, (cosine, sine) in zip(*room, strict=True):
                rotation = np.array([[cosine, 0, -sine], [0, 1, 0], [sine, 0, cosine]])
                start, way = rotation @ -centre, rotation @ ray
                for axis in range(3):
                    for side in (-1, 1):
                        t = (side * half[axis] - start[axis]) / way[axis]
                        hit = start + t * way
                        others = [k for k in range(3) if k != axis]
                        if t > 0 and (np.abs(hit[others]) <= half[others]).all():
                            depth[row, col] = min(depth[row, col], t)
    return depth


def placed_people(seed: int) -> tuple[list[PersonExtent], ScenePlacement]:
    people = [column(1.7), column(1.4)]
    return people, sample_placement(people, VIEW._replace(distance=(2.0, 5.0)), source(seed))


@pytest.mark.parametrize('seed', range(3))
def test_rendered_room_agrees_with_the_equation(seed: int) -> None:
    people, placement = placed_people(seed)
    room = sample_room(people, placement, source(seed))
    image = DepthImage(np.zeros((48, 64), np.float32), np.full((48, 64), NO_BODY, np.int32))
    render_room(image, room, placement.tilt, CAMERA)
    np.testing.assert_allclose(image.depth, naive_room(room, placement.tilt, 64, 48), rtol=1e-5)
    assert (image.labels == NO_BODY).all()


def test_room_hides_only_what_is_behind_it() -> None:
    room = Room(
        np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 3.0]]),
        np.array([[5.0, 2.0, 5.0], [0.2, 3.0, 0.5]]),
        np.array([[1.0, 0.0], [1.0, 0.0]]),
    )
    image = DepthImage(np.zeros((240, 320), np.float32), np.full((240, 320), NO_BODY, np.int32))
    image.depth[60:180, 100:220], image.labels[60:180, 100:220] = 2.8, 3
    render_room(image, room, np.eye(3), CAMERA)
    assert image.depth[120, 160] == pytest.approx(2.5)
    assert image.labels[120, 160] == NO_BODY
    assert (image.labels[60:180, 100:130] == 3).all()
    assert image.depth[120, 105] == pytest.approx(2.8)
    assert image.depth[120, 20] == pytest.approx(5.0)  # the wall
    assert image.depth[239, 20] == pytest.approx(2.0 / (119.5 / 286.0), rel=1e-5)  # the floor


def test_rooms_contain_the_people_and_furniture_does_not_hide_them() -> None:
    counts = []
    for seed in range(40):
        people, placement = placed_people(seed)
        room = sample_room(people, placement, source(seed))
        counts.append(len(room.centres) - 1)
        points = np.concatenate(
            [
                (person.points + position).reshape(-1, 3)
                for person, position in zip(people, placement.positions, strict=True)
            ]
        )
        for number, (centre, half, (cosine, sine)) in enumerate(zip(*room, strict=True)):
            rotation = np.array([[cosine, 0, -sine], [0, 1, 0], [sine, 0, cosine]])
            assert centre[1] + half[1] == pytest.approx(placement.positions[0, 1])  # on the floor
            # No box is on the way from the camera to a point of the people.
            fractions = np.linspace(0, 1, 60)[:, None, None]
            way = fractions * points - centre
            inside = (np.abs(way @ rotation.T) < half + 1e-9).all(axis=-1)
            assert inside.all() if number == 0 else not inside.any()
    assert min(counts) == 0
    assert max(counts) > 3
