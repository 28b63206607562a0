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

"""Planes of floor, walls and ceiling, compared with the rendered room."""

import numpy as np
import pytest
from room_scene import Person, Room, empty_room, look, settings

from lsc_pose_ros.camera.rays import image_rays
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.segmentation.background_planes import (
    BAND,
    FLOOR_SLOPE,
    NOISE,
    find_background_planes,
    is_boundary,
    propose_plane,
    refine_plane,
    remove_planes,
    sample_depth,
)
from lsc_pose_ros.segmentation.blobs import BARRIER
from lsc_pose_ros.synthetic.generator import camera_of

CAMERA = camera_of(settings(320))


def true_planes(room: Room) -> dict[str, np.ndarray]:
    """Return the sides of the room as (a, b, c), normals divided by distances."""
    sides = {
        'floor': [0, 1 / room.camera_height, 0],
        'back': [0, 0, 1 / room.back],
        'left': [1 / room.left, 0, 0],
        'right': [1 / room.right, 0, 0],
        'ceiling': [0, 1 / (room.camera_height - room.ceiling), 0],
    }
    return {name: room.to_camera @ side for name, side in sides.items()}


def name_of(plane: np.ndarray, room: Room) -> str | None:
    """Return the side of a plane, within 3 degrees and 5 cm."""
    for name, side in true_planes(room).items():
        norms = np.linalg.norm(plane), np.linalg.norm(side)
        turned = np.degrees(np.arccos(np.clip(plane @ side / (norms[0] * norms[1]), -1, 1)))
        if turned < 3 and abs(1 / norms[0] - 1 / norms[1]) < 0.05:
            return name
    return None


@pytest.mark.parametrize(
    ('room', 'sides'),
    [
        (Room(), {'floor', 'back'}),
        (Room(tilt=-8), {'back', 'ceiling'}),
        (Room(tilt=20, camera_height=1.8), {'floor', 'back'}),
        (Room(turn=35, left=-1.5), {'floor', 'back', 'right'}),
        (Room(back=5.5, left=-1.2, right=1.2), {'floor', 'left', 'right'}),
    ],
)
def test_sides_of_a_room_with_people_are_found(room: Room, sides: set[str]) -> None:
    seen, camera = look(room, [Person(-0.3, 2.4, 3), Person(0.5, 2.8, 4)])
    found = {name_of(plane, room) for plane in find_background_planes(seen.depth, camera)}
    assert None not in found, found
    assert sides <= found


def test_narrow_strip_of_floor_is_found() -> None:
    room = Room(camera_height=1.36, tilt=4, turn=-5, back=3.4)
    seen, camera = look(room, [])
    assert 'floor' in {
        name_of(plane, room) for plane in find_background_planes(seen.depth, camera)
    }


def test_people_and_tables_are_no_sides() -> None:
    """The top of a table is large and flat, but there are points behind it."""
    far_away = Room(back=9, left=-9, right=9, ceiling=20, tilt=10, camera_height=1.5)
    table = ((-1.0, 0.8, 1.8), (1.0, 0.85, 3.0))
    room = far_away._replace(boxes=(table,))
    crowd = [Person(x, 3.6, seed) for seed, x in enumerate((-1.2, -0.4, 0.4, 1.2))]
    seen, camera = look(room, crowd)
    names = [name_of(plane, room) for plane in find_background_planes(seen.depth, camera)]
    assert names
    assert None not in names


@pytest.mark.parametrize('depth', [np.zeros((48, 64)), np.full((3, 3), 2.0), np.ones((1, 1))])
def test_images_without_planes(depth: np.ndarray) -> None:
    assert find_background_planes(depth.astype(np.float32), CAMERA).shape == (0, 3)


def test_same_image_gives_the_same_planes() -> None:
    seen, camera = look(Room(tilt=10), [Person()])
    np.testing.assert_array_equal(
        find_background_planes(seen.depth, camera),
        find_background_planes(seen.depth.copy(), camera),
    )


def numpy_distances(grid, plane: np.ndarray) -> np.ndarray:
    """Return the distances of samples behind a plane, in units of the tolerance."""
    u, v = grid.right.astype(float), grid.down.astype(float)
    towards = plane[0] * u + plane[1] * v + plane[2]
    z = grid.depth.astype(float)
    return (z * towards - 1) / (BAND * np.linalg.norm(plane) + NOISE * z**2 * np.abs(towards))


@pytest.mark.parametrize('seed', range(4))
def test_proposed_plane_has_the_score_of_numpy(seed: int) -> None:
    room = Room(tilt=5 * seed, turn=10 * seed - 15)
    seen, camera = look(room, [Person(seed=seed)])
    grid = sample_depth(seen.depth, camera)
    free = grid.depth > 0
    plane, score = propose_plane(grid, free)
    every_second = np.s_[::2, ::2]
    distance = numpy_distances(grid, plane.astype(float))[every_second]
    depth = grid.depth[every_second]
    weight = 4 * grid.area[every_second] * np.minimum(depth, 4.0) ** 2
    on_it = (np.abs(distance) <= 1) & (depth > 0)
    expected = weight[on_it].sum() - weight[(distance > 2) & (depth > 0)].sum()
    assert score == pytest.approx(expected, rel=1e-3)
    assert name_of(refine_plane(grid, free, plane), room) is not None


def test_refined_plane_is_the_least_squares_plane() -> None:
    seen, camera = look(Room(tilt=8), [])
    grid = sample_depth(seen.depth, camera)
    free = grid.depth > 0
    plane, _ = propose_plane(grid, free)
    refined = refine_plane(grid, free, plane)
    on_it = free & (np.abs(numpy_distances(grid, plane.astype(float))) <= 1)
    u, v = grid.right.astype(float), grid.down.astype(float)
    matrix = np.stack([u[on_it], v[on_it], np.ones(on_it.sum())], axis=1)
    expected, *_ = np.linalg.lstsq(matrix, 1 / grid.depth[on_it].astype(float), rcond=None)
    np.testing.assert_allclose(refined, expected, rtol=1e-3, atol=1e-4)


def test_boundary_needs_area_and_nothing_behind() -> None:
    room = Room(back=3.0)
    depth = empty_room(room, CAMERA, 320, 240).astype(np.float32)
    back = true_planes(room)['back'].astype(np.float32)
    grid = sample_depth(depth, CAMERA)
    assert is_boundary(grid, grid.depth > 0, back)
    assert not is_boundary(grid, np.zeros_like(grid.depth, bool), back)
    nearer = (back * 1.5).astype(np.float32)
    assert not is_boundary(grid, grid.depth > 0, nearer)


@pytest.mark.parametrize('seed', range(4))
def test_removed_pixels_are_those_of_numpy(seed: int) -> None:
    random = np.random.default_rng(seed)
    camera = Intrinsics(50.0, 52.0, 31.5, 20.0)
    depth = random.uniform(0.2, 6.0, (40, 64)).astype(np.float32)
    depth[random.random(depth.shape) < 0.2] = 0
    planes = np.array([[0, 0.9, 0.1], [0.1, 0, 0.3], [0.4, 0.05, 0.1]], np.float32)[: seed + 1]
    found = remove_planes(depth, planes, image_rays(camera, *depth.shape), 0.4, 5.0)
    columns, rows = np.meshgrid(np.arange(64.0), np.arange(40.0))
    u, v = (columns - camera.cx) / camera.fx, (rows - camera.cy) / camera.fy
    z = depth.astype(float)
    gone = (z < 0.4) | (z > 5.0)
    doubtful = np.zeros_like(gone)
    for a, b, c in planes.astype(float):
        norm = np.sqrt(a * a + b * b + c * c)
        towards = a * u + b * v + c
        behind = (z * towards - 1) / (BAND * norm + NOISE * z * z * np.abs(towards))
        gone |= (behind >= -1) & ((behind <= 1) | (b > FLOOR_SLOPE * norm))
        doubtful |= np.abs(np.abs(behind) - 1) < 1e-3
    expected = np.where(depth == 0, 0, np.where(gone, BARRIER, depth))
    np.testing.assert_array_equal(found[~doubtful], expected[~doubtful])
    assert doubtful.mean() < 0.01
