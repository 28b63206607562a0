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

"""Depth images of people in a room with floor, walls, ceiling and furniture."""

from functools import cache
from typing import NamedTuple

import numpy as np

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.synthetic import people as synthetic_people
from lsc_pose_ros.synthetic.body.bone_rotations import pose_rotations, rig_of
from lsc_pose_ros.synthetic.generator import SyntheticSettings, camera_of
from lsc_pose_ros.synthetic.motion.joint_angles import ANGLE_NUMBERS, ANGLES
from lsc_pose_ros.synthetic.motion.motion import Motion
from lsc_pose_ros.synthetic.scene.depth_image import DepthImage
from lsc_pose_ros.synthetic.scene.mesh_render import RenderMesh, render_meshes
from lsc_pose_ros.synthetic.scene.placement import ScenePlacement
from lsc_pose_ros.synthetic.sensors.sensors import apply_sensor


class Room(NamedTuple):
    """A room around the camera, metres and degrees; boxes are (x, y, z) from low to high."""

    camera_height: float = 1.0
    tilt: float = 0.0  # the camera is tilted down by this angle
    turn: float = 0.0  # and turned from the back wall by this angle
    back: float = 4.0
    left: float = -2.2
    right: float = 2.5
    ceiling: float = 2.6
    boxes: tuple[tuple[tuple[float, float, float], tuple[float, float, float]], ...] = ()

    @property
    def to_camera(self) -> np.ndarray:
        """From the room's level frame (x right, y down, z to the back wall) to the camera's."""
        down, aside = np.radians([self.tilt, self.turn])
        nod = [
            [1, 0, 0],
            [0, np.cos(down), -np.sin(down)],
            [0, np.sin(down), np.cos(down)],
        ]
        turn = [
            [np.cos(aside), 0, -np.sin(aside)],
            [0, 1, 0],
            [np.sin(aside), 0, np.cos(aside)],
        ]
        return np.array(nod) @ np.array(turn)


class Person(NamedTuple):
    """Position of a person in the room, and the seed of the body."""

    x: float = 0.0
    z: float = 2.3
    seed: int = 0


def settings(width: int) -> SyntheticSettings:
    return SyntheticSettings(width=width, height=width * 3 // 4)


@cache
def everybody() -> synthetic_people.PersonSampler:
    return synthetic_people.PersonSampler(settings(320))


@cache
def somebody(seed: int) -> synthetic_people.SyntheticPerson:
    """Return a standing body with its arms more or less spread."""
    random = np.random.Generator(np.random.PCG64(seed))
    rest = everybody().sample_body(random)
    angles = np.zeros(len(ANGLES))
    chances = dict(zip(ANGLES, random.random(len(ANGLES)), strict=True))
    for name, low, high in (
        ('plane', -10, 40),
        ('elevation', 15, 60),
        ('elbow', 5, 50),
        ('hip_abduction', 4, 12),
    ):
        for side in ('l', 'r'):
            joint = f'{side}_{name}'
            angles[ANGLE_NUMBERS[joint]] = np.radians(low + (high - low) * chances[joint])
    rotations = pose_rotations(rig_of(everybody().body, rest), angles[None])
    yaw = np.radians(40) * (2 * random.random(1) - 1)
    return everybody().stand_on_floor(rest, Motion(rotations, yaw))


def empty_room(room: Room, camera: Intrinsics, width: int, height: int) -> np.ndarray:
    """Depth of the room, metres, shape (height, width), without noise."""
    columns, rows = np.meshgrid(np.arange(width), np.arange(height))
    rays = np.stack(
        [(columns - camera.cx) / camera.fx, (rows - camera.cy) / camera.fy, np.ones(rows.shape)],
        axis=-1,
    )
    level = rays @ room.to_camera  # the transposed rotation of each ray
    floor = room.camera_height
    low = np.array([room.left, floor - room.ceiling, -0.5])
    high = np.array([room.right, floor, room.back])
    with np.errstate(divide='ignore', invalid='ignore'):
        depth = np.where(level > 0, high / level, low / level).min(axis=-1)
        for box_low, box_high in room.boxes:
            one, other = np.array(box_low) / level, np.array(box_high) / level
            enter = np.minimum(one, other).max(axis=-1)
            leave = np.maximum(one, other).min(axis=-1)
            depth = np.where((enter < leave) & (enter > 0) & (enter < depth), enter, depth)
    return depth


def look(
    room: Room, people: list[Person], *, width: int = 320, noise_seed: int = 1
) -> tuple[DepthImage, Intrinsics]:
    """Return the image of a Kinect in the room, and its intrinsics; people are numbered from 1."""
    camera, height = camera_of(settings(width)), width * 3 // 4
    depth = empty_room(room, camera, width, height)
    labels = np.full(depth.shape, NO_BODY, np.int32)
    offsets = np.array([(each.x, room.camera_height, each.z) for each in people])
    stage = ScenePlacement(room.to_camera, offsets, room.camera_height)
    drawn = [
        everybody().pose_in_camera(somebody(each.seed), 0, stage, number)
        for number, each in enumerate(people)
    ]
    triangles = everybody().body.triangles
    meshes = [RenderMesh(body.vertices, triangles, number) for number, body in enumerate(drawn, 1)]
    seen = render_meshes(meshes, camera, width, height)
    nearer = (seen.labels != NO_BODY) & (seen.depth < depth)
    depth = np.where(nearer, seen.depth, depth)
    labels[nearer] = seen.labels[nearer]
    clean = DepthImage(depth.astype(np.float32), labels)
    return apply_sensor('kinect_v1', clean, camera, np.random.default_rng(noise_seed)), camera


def overlap(found: np.ndarray, true: np.ndarray) -> float:
    """Intersection over union of two masks."""
    return float((found & true).sum() / max((found | true).sum(), 1))
