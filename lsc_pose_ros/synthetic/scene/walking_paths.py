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

"""Paths of people who walk to and fro and pass before each other, some out of the image."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.scene.placement import CameraConstraints, ScenePlacement, tilt_rotation

BODY_DEPTH = 0.6
"""Two people who walk side by side are so far apart, metres."""

TIGHTEST_TURN, WIDEST_TURN = 0.1, 0.3
"""The radius in which people turn round, metres."""

SPEEDS = (0.6, 1.3)
"""The slowest and the fastest walk, metres per second."""

_LENGTHS = (0.6, 1.3)  # half the length of a path, as a fraction of half the width of the view


class WalkingPath(NamedTuple):
    """Where a person walks in T frames.

    Attributes:
        positions: relative to the middle of the path, level, metres, shape (T, 3).
        yaw: the direction of the walk as in `Motion`, radians, shape (T,).
        distance: from the start along the path, metres, shape (T,).
    """

    positions: NDArray[np.float64]
    yaw: NDArray[np.float64]
    distance: NDArray[np.float64]


class CrossingPaths(NamedTuple):
    """The paths of N people.

    Attributes:
        placement: of the camera, and of the middle of each path.
        paths: of each person.
    """

    placement: ScenePlacement
    paths: list[WalkingPath]


def sample_crossing_paths(
    people: int,
    seconds: NDArray[np.float64],
    constraints: CameraConstraints,
    random: np.random.Generator,
) -> CrossingPaths:
    """Sample the paths of people who walk across the view, each in a lane of its own.

    The lanes lie one behind the other, so that the people hide each other but never touch.

    Args:
        people: their number.
        seconds: the time of each frame, shape (T,).
        constraints: the camera; its distances are those of the nearest and the farthest lane.
        random: the source of randomness.

    Raises:
        InputError: there is no room for as many lanes.
    """
    near, far = constraints.distance
    spacing = (far - near) / people
    turn = min(WIDEST_TURN, 0.5 * (spacing - BODY_DEPTH))
    if turn < TIGHTEST_TURN:
        least = near + people * (BODY_DEPTH + 2 * TIGHTEST_TURN)
        msg = (
            f'{people} people cannot walk one behind the other between {near:g} and {far:g} m; '
            f'give a largest distance of {least:g} m or more, or fewer people'
        )
        raise InputError(msg)
    height, tilt = (
        float(random.uniform(*ends)) for ends in (constraints.camera_height, constraints.tilt)
    )
    lanes = near + spacing * (random.permutation(people) + 0.5)
    view = 0.5 * constraints.width / constraints.camera.fx
    paths = [
        _walk(lane * view * random.uniform(*_LENGTHS), turn, seconds, random) for lane in lanes
    ]
    positions = np.stack([np.zeros(people), np.full(people, height), lanes], axis=1)
    return CrossingPaths(ScenePlacement(tilt_rotation(tilt), positions, height), paths)


def _walk(
    half: float, turn: float, seconds: NDArray[np.float64], random: np.random.Generator
) -> WalkingPath:
    """Return a walk at constant speed around two straight lines that are joined by half circles.

    Args:
        half: half the length of the straight lines, metres.
        turn: the radius of the half circles, metres.
        seconds: the time of each frame, shape (T,).
        random: the source of randomness.
    """
    speed, start, way = random.uniform(*SPEEDS), random.random(), random.choice([-1.0, 1.0])
    distance = speed * seconds
    line, bend = 2 * half, np.pi * turn
    along = (start * 2 * (line + bend) + distance) % (2 * (line + bend))
    back = along >= line + bend
    along = np.where(back, along - line - bend, along)
    angle = np.maximum(along - line, 0) / turn
    x = np.minimum(along, line) - half + turn * np.sin(angle)
    z = -turn * np.cos(angle)
    side = np.where(back, -1.0, 1.0)
    positions = np.stack([side * x, np.zeros_like(x), way * side * z], axis=1)
    ahead_x, ahead_z = side * np.cos(angle), way * side * np.sin(angle)
    return WalkingPath(positions, np.arctan2(ahead_x, -ahead_z), distance)
