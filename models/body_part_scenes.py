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


# ruff: noqa: INP001 - no package
"""Depth grids of furnished synthetic rooms with their body parts, to train and test on."""

import random
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from people import MocapSplit, RecordingSpec, digest_of, with_mocap

from lsc_pose_ros.body_parts.depth_grid import depth_grid
from lsc_pose_ros.cli.output.progress import progress
from lsc_pose_ros.files.kinds import archive
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.synthetic.generator import SyntheticScene, synthetic_scenes
from lsc_pose_ros.synthetic.settings import SyntheticSettings

FRAMES = 100
"""The number of frames of one recording."""

_GRIDS = archive('a file of depth grids', 'depth.npy')

_MILLIMETRES = 1000
_DEEPEST = 65_535

_ROOM = SyntheticSettings(clip_length=1, yaw=180.0, frames=FRAMES, furniture=True)

# How many of the recordings are those of each camera, relative to the others.
_SENSORS = {
    'realsense_filtered': 4,
    'kinect_v1': 5,
    'kinect_v2': 3,
    'azure': 2,
    'realsense': 5,
    'zed': 4,
    'tof': 3,
}


class PartGrids(NamedTuple):
    """What is kept of a recording: I depth grids of h x w cells.

    Attributes:
        depth: millimetres, 0 if unknown, shape (I, h, w), uint16.
        parts: the class of each cell, shape (I, h, w), uint8.
        bodies: the body number of each cell, 0 for none, shape (I, h, w), uint8.
        focal_lengths: fx and fy in cells, shape (I, 2).
    """

    depth: NDArray[np.uint16]
    parts: NDArray[np.uint8]
    bodies: NDArray[np.uint8]
    focal_lengths: NDArray[np.float32]


def any_room(number: int) -> RecordingSpec:
    """Return frames of one camera at any height, with 0 to 3 people; few are without a room."""
    choice = random.Random(number)  # noqa: S311
    sensor = choice.choices(list(_SENSORS), list(_SENSORS.values()))[0]
    people = choice.choices((0, 1, 2, 3), (0.25, 0.4, 0.25, 0.1))[0]
    alone, low = choice.random() < 0.08, choice.random() < 0.3
    return RecordingSpec(
        f'parts_{number}',
        _ROOM._replace(
            seed=600_000 + number,
            sensor=sensor,
            people=min(max(people, 1), 2) if alone else people,
            furniture=not alone,
            cropped=alone and choice.random() < 0.5,
            camera_height=(0.15, 2.0) if low else (0.3, 2.2),
            camera_tilt=(-10.0, 40.0) if low else (-20.0, 30.0),
            distance=(1.5, 5.0) if alone else choice.choice([(0.7, 5.5), (0.9, 5.0), (0.6, 2.5)]),
        ),
    )


def draw_grids(spec: RecordingSpec, mocap: MocapSplit, folder: Path) -> Path:
    """Generate a recording if it is not there yet, keep its grids, and return their file."""
    settings = with_mocap(spec.settings, mocap, test=False)
    path = folder / f'{spec.name}_{digest_of(settings, "")}.npz'
    if not path.exists():
        scenes = progress(synthetic_scenes(settings), settings.frames, spec.name)
        grids = grids_of(scenes)
        write_output(path, _GRIDS, lambda file: np.savez_compressed(file, **grids._asdict()))
    return path


def grids_of(scenes: Iterator[SyntheticScene]) -> PartGrids:
    """Return the grids of some scenes of one camera."""
    depth, parts, bodies, focal_lengths = [], [], [], []
    for scene in scenes:
        grid = depth_grid(scene.frame.depth, scene.frame.camera)
        millimetres = np.rint(grid.depth * _MILLIMETRES)
        depth.append(np.minimum(millimetres, _DEEPEST).astype(np.uint16))
        parts.append(_middle_pixels(scene.parts, grid.step))
        numbers = np.maximum(scene.frame.labels, 0)  # NO_BODY is negative
        bodies.append(_middle_pixels(numbers, grid.step).astype(np.uint8))
        focal_lengths.append(grid.focal_lengths)
    return PartGrids(
        np.array(depth), np.array(parts), np.array(bodies), np.array(focal_lengths, np.float32)
    )


def _middle_pixels(image: NDArray[np.integer], step: int) -> NDArray[np.integer]:
    height, width = image.shape[0] // step, image.shape[1] // step
    middle = step // 2
    return image[middle : height * step : step, middle : width * step : step]


def load_grids(path: Path) -> PartGrids:
    """Return the grids in a file of `draw_grids`."""
    with np.load(path, allow_pickle=False) as archive:
        return PartGrids(*(archive[name] for name in PartGrids._fields))
