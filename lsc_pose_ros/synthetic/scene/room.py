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

"""A room around the people: floor, walls, ceiling, and boxes as furniture.

All of them are boxes that stand on the floor; the room is a box seen from inside. Nothing touches
or hides a person, so labels and joints are the same with and without the room.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.numerics.jit import exact_kernel
from lsc_pose_ros.synthetic.scene.depth_image import DepthImage
from lsc_pose_ros.synthetic.scene.placement import PersonExtent, ScenePlacement

MAX_BOXES = 8
"""Maximum number of pieces of furniture."""

_CLEARANCE = 0.15  # minimum distance between people and other things, metres
_CEILING = (2.3, 3.2)  # range of its height, metres
_WALL_DISTANCE = (0.2, 3.0)  # range of the distance of walls from people and camera, metres
_CLOSE_WALL = (0.01, 0.3)  # range of the distance of close walls, metres
_CLOSE_FRACTION = 0.4  # fraction of walls that are close in a furnished room
_MIN_SIZE = np.array([0.25, 0.3, 0.25])  # of furniture: width, height, depth, metres
_MAX_SIZE = np.array([1.6, 2.0, 1.0])
_MIN_CAMERA_DISTANCE = 0.6  # from the surface of furniture to the camera, metres


class Room(NamedTuple):
    """K boxes in the level frame at the camera: x right, y down, z away.

    Attributes:
        centres: metres, shape (K, 3); the first box is the room.
        halves: half sizes along the boxes' own axes, metres, shape (K, 3).
        rotations: cosine and sine of the boxes' rotation about the vertical axis, shape (K, 2).
    """

    centres: NDArray[np.float64]
    halves: NDArray[np.float64]
    rotations: NDArray[np.float64]


def sample_room(
    people: Sequence[PersonExtent], placement: ScenePlacement, random: np.random.Generator
) -> Room:
    """Sample a room that contains the camera and `people`, and furniture beside the people."""
    points = [
        (person.points + position).reshape(-1, 3)
        for person, position in zip(people, placement.positions, strict=True)
    ]
    floor = float(placement.positions[0, 1])
    boxes = [_sample_walls(np.concatenate(points), floor, random.random(6))]
    count = int((MAX_BOXES + 1) * random.random())
    for number, uniforms in enumerate(random.random((MAX_BOXES, 6))):
        centre, half, angle = _sample_furniture(boxes[0], floor, uniforms)
        if number < count and _is_clear(centre, half, points):
            boxes.append((centre, half, angle))
    centres, halves, angles = (np.array(field) for field in zip(*boxes, strict=True))
    return Room(centres, halves, np.stack([np.cos(angles), np.sin(angles)], axis=1))


def sample_close_walls(
    points: NDArray[np.float64], floor: float, uniforms: NDArray[np.float64]
) -> Room:
    """Sample an empty room whose walls are often close to people or camera.

    Args:
        points: of the people, metres, shape (P, 3).
        floor: y of the floor, metres.
        uniforms: random numbers, shape (10,).
    """
    angle = (uniforms[0] - 0.5) * np.pi / 2
    near = uniforms[1:5] < _CLOSE_FRACTION
    close = _CLOSE_WALL[0] + (_CLOSE_WALL[1] - _CLOSE_WALL[0]) * uniforms[5:9]
    far = _CLOSE_WALL[1] + (_WALL_DISTANCE[1] - _CLOSE_WALL[1]) * uniforms[5:9]
    centre, half, _ = _walls_around(points, floor, angle, np.where(near, close, far), uniforms[9])
    return Room(centre[None], half[None], np.array([[np.cos(angle), np.sin(angle)]]))


def render_room(
    image: DepthImage, room: Room, tilt: NDArray[np.float64], camera: Intrinsics
) -> None:
    """Draw `room` into `image`, behind and in front of what is already drawn.

    Args:
        image: the people.
        room: the room.
        tilt: rotation from the level frame to the camera's frame, shape (3, 3).
        camera: the intrinsics.
    """
    for box in range(len(room.centres)):
        columns, rows = _pixels(image.depth.shape, room, box, tilt, camera)
        # The camera is inside the room and outside all other boxes.
        draw_box(image, room, box, np.ascontiguousarray(tilt), camera, columns, rows)


@exact_kernel
def draw_box(
    image: DepthImage,
    room: Room,
    box: int,
    tilt: NDArray[np.float64],
    camera: Intrinsics,
    columns: tuple[int, int],
    rows: tuple[int, int],
) -> None:
    """Draw one box, in a range of pixels, if it is nearer than what is already drawn.

    A pixel's ray is t (x, y, 1). From inside, the point at which it leaves the box is visible.
    """
    cosine, sine = room.rotations[box, 0], room.rotations[box, 1]
    cx, cy, cz = -room.centres[box, 0], -room.centres[box, 1], -room.centres[box, 2]
    origin = (cosine * cx - sine * cz, cy, sine * cx + cosine * cz)
    halves = room.halves[box]
    inside = abs(origin[0]) < halves[0] and abs(origin[1]) < halves[1]
    inside = inside and abs(origin[2]) < halves[2]
    for row in range(rows[0], rows[1]):
        y = (row - camera.cy) / camera.fy
        for column in range(columns[0], columns[1]):
            x = (column - camera.cx) / camera.fx
            level_x = tilt[0, 0] * x + tilt[1, 0] * y + tilt[2, 0]
            level_y = tilt[0, 1] * x + tilt[1, 1] * y + tilt[2, 1]
            level_z = tilt[0, 2] * x + tilt[1, 2] * y + tilt[2, 2]
            ray = (cosine * level_x - sine * level_z, level_y, sine * level_x + cosine * level_z)
            if inside:
                depth = np.float32(leave_box(origin, ray, halves))
            else:
                enters, leaves = cross_box(origin, ray, halves)
                depth = np.float32(enters if enters > 0.0 else leaves)
                if enters > leaves or not depth > 0.0:
                    continue
            drawn = image.depth[row, column]
            if drawn == 0.0 or depth < drawn:
                image.depth[row, column] = depth
                image.labels[row, column] = NO_BODY


@exact_kernel
def leave_box(
    origin: tuple[float, float, float],
    ray: tuple[float, float, float],
    halves: NDArray[np.float64],
) -> float:
    """Return the parameter t at which a ray from inside a box leaves it; see `cross_box`."""
    leaves = math.inf
    for axis in range(3):
        direction = ray[axis]
        if direction > 0.0:
            leaves = min(leaves, (halves[axis] - origin[axis]) / direction)
        elif direction < 0.0:
            leaves = min(leaves, (-halves[axis] - origin[axis]) / direction)
    return leaves


@exact_kernel
def cross_box(
    origin: tuple[float, float, float],
    ray: tuple[float, float, float],
    halves: NDArray[np.float64],
) -> tuple[float, float]:
    """Return the parameters t at which a ray o + t d enters and leaves a box.

    It crosses the two planes of an axis at t = (-half - o) / d and (half - o) / d. It enters the
    box at the largest of the nearer crossings and leaves it at the smallest of the farther ones.

    Args:
        origin: o in the box's frame, metres.
        ray: d in the box's frame.
        halves: half sizes of the box, metres, shape (3,).

    Returns:
        Both parameters; the ray misses the box if the first is larger.
    """
    enters, leaves = -math.inf, math.inf
    for axis in range(3):
        half, start, direction = halves[axis], origin[axis], ray[axis]
        if direction == 0.0:
            if abs(start) > half:
                leaves = -math.inf
            continue
        first, last = (-half - start) / direction, (half - start) / direction
        enters = max(enters, min(first, last))
        leaves = min(leaves, max(first, last))
    return enters, leaves


_Box = tuple[NDArray[np.float64], NDArray[np.float64], float]


def _sample_walls(
    points: NDArray[np.float64], floor: float, uniforms: NDArray[np.float64]
) -> _Box:
    """Return a room that contains `points` and the camera at the origin."""
    angle = (uniforms[0] - 0.5) * np.pi / 2
    distances = _WALL_DISTANCE[0] + (_WALL_DISTANCE[1] - _WALL_DISTANCE[0]) * uniforms[1:5]
    return _walls_around(points, floor, angle, distances, uniforms[5])


def _walls_around(
    points: NDArray[np.float64],
    floor: float,
    angle: float,
    distances: NDArray[np.float64],
    ceiling_fraction: float,
) -> _Box:
    """Return a room with walls at `distances`, shape (4,), from `points` and the camera."""
    rotation = _vertical_rotation(angle)
    inside = np.concatenate([points, np.zeros((1, 3))]) @ rotation.T
    low, high = inside.min(axis=0), inside.max(axis=0)
    low[[0, 2]] -= distances[:2]
    high[[0, 2]] += distances[2:]
    ceiling = floor - (_CEILING[0] + (_CEILING[1] - _CEILING[0]) * ceiling_fraction)
    low[1], high[1] = min(ceiling, low[1] - _CLEARANCE), floor
    return rotation.T @ (0.5 * (low + high)), 0.5 * (high - low), angle


def _sample_furniture(room: _Box, floor: float, uniforms: NDArray[np.float64]) -> _Box:
    """Return a box that stands on the floor."""
    half = 0.5 * (_MIN_SIZE + (_MAX_SIZE - _MIN_SIZE) * uniforms[:3] ** 1.5)
    position = room[1] * (2 * np.array([uniforms[3], 0.5, uniforms[4]]) - 1)
    centre = room[0] + _vertical_rotation(room[2]).T @ position
    centre[1] = floor - half[1]
    return centre, half, room[2] + (uniforms[5] - 0.5) * np.pi / 4


def _is_clear(
    centre: NDArray[np.float64], half: NDArray[np.float64], people: list[NDArray[np.float64]]
) -> bool:
    """Return whether a box is away from the camera and neither touches nor hides a person."""
    radius = float(np.sqrt(half[0] ** 2 + half[2] ** 2)) + _CLEARANCE
    distance = float(np.sqrt(centre[0] ** 2 + centre[2] ** 2))
    if distance < _MIN_CAMERA_DISTANCE + radius:
        return False
    for points in people:
        away = np.sqrt(points[:, 0] ** 2 + points[:, 2] ** 2)
        if distance - radius > away.max():
            continue
        # Seen from above, the person must be outside the angle that the box covers.
        bearings = np.arctan2(points[:, 0], points[:, 2]) - np.arctan2(centre[0], centre[2])
        wide = np.arcsin(radius / distance)
        if bearings.min() < wide and bearings.max() > -wide:
            return False
    return True


def _vertical_rotation(angle: float) -> NDArray[np.float64]:
    """Return the rotation about the vertical axis from the level frame to a box's axes."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]])


def _pixels(
    shape: tuple[int, ...],
    room: Room,
    box: int,
    tilt: NDArray[np.float64],
    camera: Intrinsics,
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return the columns and the rows that can show a box: the first, and one past the last."""
    height, width = shape
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    cosine, sine = room.rotations[box]
    rotation = np.array([[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]])
    corners = (room.centres[box] + (signs * room.halves[box]) @ rotation) @ tilt.T
    if corners[:, 2].min() < 0.1:
        return (0, width), (0, height)
    u = camera.cx + camera.fx * corners[:, 0] / corners[:, 2]
    v = camera.cy + camera.fy * corners[:, 1] / corners[:, 2]
    first = np.clip(np.floor([u.min(), v.min()]), 0, [width, height]).astype(int)
    last = np.clip(np.ceil([u.max(), v.max()]) + 1, 0, [width, height]).astype(int)
    return (int(first[0]), int(last[0])), (int(first[1]), int(last[1]))
