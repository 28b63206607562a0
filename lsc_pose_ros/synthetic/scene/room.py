"""A room about the people: floor, walls, ceiling, and boxes for furniture.

Each is a box that stands on the floor; the room is one seen from inside. Nothing touches or hides
a person: masks and joints are the same with and without it.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.numerics.jit import exact_kernel
from lsc_pose_ros.synthetic.scene.image import Image
from lsc_pose_ros.synthetic.scene.placement import Actor, Stage

MOST_BOXES = 8
"""Pieces of furniture in a room."""

_FREE = 0.15  # between people and whatever else, metres
_CEILING = (2.3, 3.2)  # its height, metres
_BEYOND = (0.2, 3.0)  # how far walls are behind people and camera, metres
_SMALLEST = np.array([0.25, 0.3, 0.25])  # of furniture: width, height, depth, metres
_LARGEST = np.array([1.6, 2.0, 1.0])
_NEAREST = 0.6  # furniture's middle to the camera, metres


class Scene(NamedTuple):
    """What K boxes there are, in the level frame at the camera: x right, y down, z away.

    Attributes:
        centres: metres, the first the room's, shape (K, 3).
        halves: half of their sizes along their own axes, metres, shape (K, 3).
        turns: cosine and sine of the angle by which they are turned about the vertical, (K, 2).
    """

    centres: NDArray[np.float64]
    halves: NDArray[np.float64]
    turns: NDArray[np.float64]


def draw_scene(actors: Sequence[Actor], stage: Stage, random: np.random.Generator) -> Scene:
    """Draw a room that holds the camera and `actors`, and furniture aside of them."""
    people = [
        (actor.points + offset).reshape(-1, 3)
        for actor, offset in zip(actors, stage.offsets, strict=True)
    ]
    floor = float(stage.offsets[0, 1])
    boxes = [_draw_room(np.concatenate(people), floor, random.random(6))]
    count = int((MOST_BOXES + 1) * random.random())
    for number, chances in enumerate(random.random((MOST_BOXES, 6))):
        centre, half, angle = _furniture(boxes[0], floor, chances)
        if number < count and _is_aside(centre, half, people):
            boxes.append((centre, half, angle))
    centres, halves, angles = (np.array(field) for field in zip(*boxes, strict=True))
    return Scene(centres, halves, np.stack([np.cos(angles), np.sin(angles)], axis=1))


def add_scene(image: Image, scene: Scene, tilt: NDArray[np.float64], camera: Intrinsics) -> None:
    """Draw `scene` into `image`, behind and before what is there.

    Args:
        image: the people.
        scene: the room.
        tilt: from the level frame into the camera's, shape (3, 3).
        camera: the intrinsics.
    """
    for box in range(len(scene.centres)):
        columns, rows = _pixels(image.depth.shape, scene, box, tilt, camera)
        # The camera is in the room and outside of everything else.
        draw_box(image, scene, box, np.ascontiguousarray(tilt), camera, columns, rows)


@exact_kernel
def draw_box(
    image: Image,
    scene: Scene,
    box: int,
    tilt: NDArray[np.float64],
    camera: Intrinsics,
    columns: tuple[int, int],
    rows: tuple[int, int],
) -> None:
    """Draw one box where it is nearer than what is there, in a range of pixels.

    The ray t (x, y, 1) is between the box's two planes along an axis from t = (-half - o) / d to
    (half - o) / d, or the other way round, with the camera at o and the ray's direction d in the
    box's axes. It enters the box at the last of the nearer ones, and leaves it at the first of the
    farther ones; from inside, where it leaves is seen.
    """
    cosine, sine = scene.turns[box, 0], scene.turns[box, 1]
    cx, cy, cz = -scene.centres[box, 0], -scene.centres[box, 1], -scene.centres[box, 2]
    origin = (cosine * cx - sine * cz, cy, sine * cx + cosine * cz)
    for row in range(rows[0], rows[1]):
        y = (row - camera.cy) / camera.fy
        for column in range(columns[0], columns[1]):
            x = (column - camera.cx) / camera.fx
            level_x = tilt[0, 0] * x + tilt[1, 0] * y + tilt[2, 0]
            level_y = tilt[0, 1] * x + tilt[1, 1] * y + tilt[2, 1]
            level_z = tilt[0, 2] * x + tilt[1, 2] * y + tilt[2, 2]
            ray = (cosine * level_x - sine * level_z, level_y, sine * level_x + cosine * level_z)
            enters, leaves = -math.inf, math.inf
            for axis in range(3):
                half, start, way = scene.halves[box, axis], origin[axis], ray[axis]
                if way == 0.0:
                    if abs(start) > half:
                        leaves = -math.inf
                    continue
                first, last = (-half - start) / way, (half - start) / way
                enters = max(enters, min(first, last))
                leaves = min(leaves, max(first, last))
            seen = np.float32(enters if enters > 0.0 else leaves)
            if enters > leaves or not seen > 0.0:
                continue
            there = image.depth[row, column]
            if there == 0.0 or seen < there:
                image.depth[row, column] = seen
                image.labels[row, column] = NO_BODY


_Box = tuple[NDArray[np.float64], NDArray[np.float64], float]


def _draw_room(people: NDArray[np.float64], floor: float, chances: NDArray[np.float64]) -> _Box:
    """Return a room that holds points and the camera, the origin."""
    angle = (chances[0] - 0.5) * np.pi / 2
    turn = _turn(angle)
    held = np.concatenate([people, np.zeros((1, 3))]) @ turn.T
    free = _BEYOND[0] + (_BEYOND[1] - _BEYOND[0]) * chances[1:5]
    low, high = held.min(axis=0), held.max(axis=0)
    low[[0, 2]] -= free[:2]
    high[[0, 2]] += free[2:]
    ceiling = floor - (_CEILING[0] + (_CEILING[1] - _CEILING[0]) * chances[5])
    low[1], high[1] = min(ceiling, low[1] - _FREE), floor
    return turn.T @ (0.5 * (low + high)), 0.5 * (high - low), angle


def _furniture(room: _Box, floor: float, chances: NDArray[np.float64]) -> _Box:
    """Return something that stands on the floor."""
    half = 0.5 * (_SMALLEST + (_LARGEST - _SMALLEST) * chances[:3] ** 1.5)
    place = room[1] * (2 * np.array([chances[3], 0.5, chances[4]]) - 1)
    centre = room[0] + _turn(room[2]).T @ place
    centre[1] = floor - half[1]
    return centre, half, room[2] + (chances[5] - 0.5) * np.pi / 4


def _is_aside(
    centre: NDArray[np.float64], half: NDArray[np.float64], people: list[NDArray[np.float64]]
) -> bool:
    """Tell whether a box is clear of the camera and neither touches nor hides anybody."""
    radius = float(np.sqrt(half[0] ** 2 + half[2] ** 2)) + _FREE
    distance = float(np.sqrt(centre[0] ** 2 + centre[2] ** 2))
    if distance < _NEAREST + radius:
        return False
    for points in people:
        away = np.sqrt(points[:, 0] ** 2 + points[:, 2] ** 2)
        if distance - radius > away.max():
            continue
        # As seen from above, the person is beside the box's shadow.
        bearings = np.arctan2(points[:, 0], points[:, 2]) - np.arctan2(centre[0], centre[2])
        wide = np.arcsin(radius / distance)
        if bearings.min() < wide and bearings.max() > -wide:
            return False
    return True


def _turn(angle: float) -> NDArray[np.float64]:
    """Return the turn about the vertical from the level frame into a box's axes."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]])


def _pixels(
    shape: tuple[int, ...],
    scene: Scene,
    box: int,
    tilt: NDArray[np.float64],
    camera: Intrinsics,
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return the columns and the rows that may show a box: the first, and one past the last."""
    height, width = shape
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    cosine, sine = scene.turns[box]
    turn = np.array([[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]])
    corners = (scene.centres[box] + (signs * scene.halves[box]) @ turn) @ tilt.T
    if corners[:, 2].min() < 0.1:
        return (0, width), (0, height)
    u = camera.cx + camera.fx * corners[:, 0] / corners[:, 2]
    v = camera.cy + camera.fy * corners[:, 1] / corners[:, 2]
    first = np.clip(np.floor([u.min(), v.min()]), 0, [width, height]).astype(int)
    last = np.clip(np.ceil([u.max(), v.max()]) + 1, 0, [width, height]).astype(int)
    return (int(first[0]), int(last[0])), (int(first[1]), int(last[1]))
