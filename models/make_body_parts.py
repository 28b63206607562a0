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


# ruff: noqa: INP001, T201 - a program, not a package
"""Train the body-part forests of the package: `make body-parts`.

The program draws samples from the synthetic recordings listed below and trains the two forests.
The samples of each recording are kept in a folder, so the program can be interrupted and started
again.

    python models/make_body_parts.py --mocap CLIPS
"""

import argparse
import hashlib
import json
import random
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from people import MocapSplit, RecordingSpec, digest_of, find_mocap, with_mocap

from lsc_pose_ros.body_parts.context import PartForests
from lsc_pose_ros.body_parts.depth_grid import depth_grid
from lsc_pose_ros.body_parts.part_forest import PartForest
from lsc_pose_ros.cli.output.progress import progress
from lsc_pose_ros.model_io.part_forest_file import save_part_forests
from lsc_pose_ros.resources.package_files import resource
from lsc_pose_ros.segmentation.people import STRIDE
from lsc_pose_ros.synthetic.generator import synthetic_scenes
from lsc_pose_ros.synthetic.settings import SyntheticSettings
from lsc_pose_ros.training.body_parts.context_samples import PartGrid, collect_context_samples
from lsc_pose_ros.training.body_parts.part_samples import (
    PartImage,
    PartSamples,
    collect_samples,
    join_samples,
    parts_of_cells,
)
from lsc_pose_ros.training.body_parts.part_training import train_part_forest
from lsc_pose_ros.training.body_parts.part_tree_growth import PartGrowth

HERE = Path(__file__).resolve().parent

TREES = 3
GROWTH = PartGrowth()
FARTHEST = 6.0
"""Cells at a larger depth are not learnt, metres."""

PEOPLE_CELLS, OTHER_CELLS = 250, 250
"""The number of samples of an image that show people, and that show none."""

CONTEXT_GROWTH = PartGrowth(features=100)
CONTEXT_CELLS = 200
"""The same for the second forest; the cells are those that the first one takes for people."""

_ROOM = SyntheticSettings(
    clip_length=1,
    yaw=180.0,
    camera_height=(0.3, 2.2),
    camera_tilt=(-20.0, 30.0),
    distance=(0.9, 5.0),
    furniture=True,
)


# How many of the frames are those of each camera, relative to the others.
_SENSORS = {'kinect_v1': 6, 'kinect_v2': 3, 'azure': 2, 'realsense': 6, 'zed': 3, 'tof': 3}


def _recordings(sensor: str, frames: int, seed: int) -> tuple[RecordingSpec, ...]:
    """Return rooms with one, two and three people, and without anybody, before one camera."""
    fractions = ((1, 0.45), (2, 0.25), (3, 0.1), (0, 0.2))
    return tuple(
        RecordingSpec(
            f'parts_{sensor}_{people}',
            _ROOM._replace(
                sensor=sensor, people=people, seed=seed + people, frames=round(frames * fraction)
            ),
        )
        for people, fraction in fractions
    )


def _all_sensors(frames: int, seed: int) -> tuple[RecordingSpec, ...]:
    """Return recordings before all cameras; about `frames` frames altogether."""
    total = sum(_SENSORS.values())
    return tuple(
        spec
        for number, (sensor, weight) in enumerate(_SENSORS.items())
        for spec in _recordings(sensor, round(frames * weight / total), seed + 100 * number)
    )


def _without_rooms(frames: int, seed: int) -> tuple[RecordingSpec, ...]:
    """Return people with nothing around them, as after a program has removed the background."""
    total = sum(_SENSORS.values())
    return tuple(
        RecordingSpec(
            f'parts_{sensor}_alone',
            _ROOM._replace(
                sensor=sensor,
                furniture=False,
                distance=(1.5, 5.0),
                cropped=number % 2 == 1,
                seed=seed + number,
                frames=round(frames * weight / total),
            ),
        )
        for number, (sensor, weight) in enumerate(_SENSORS.items())
    )


ROUNDS = (
    _all_sensors(4_600, 2_100),
    (*_all_sensors(5_000, 4_100), *_without_rooms(1_150, 5_000)),
)
"""The recordings of each round of the training.

The first round trains a forest. It draws half of the samples without people in the second round:
those that it takes for people. The forest of the second round learns from both.
"""


def _any_room(number: int) -> RecordingSpec:
    """Return 100 frames of one camera at any height, with 0 to 3 people."""
    choice = random.Random(number)  # noqa: S311
    sensors = {'realsense_filtered': 4, **_SENSORS, 'realsense': 5, 'kinect_v1': 5, 'zed': 4}
    sensor = choice.choices(list(sensors), list(sensors.values()))[0]
    people = choice.choices((0, 1, 2, 3), (0.25, 0.4, 0.25, 0.1))[0]
    alone, low = choice.random() < 0.08, choice.random() < 0.3
    return RecordingSpec(
        f'context_{number}',
        _ROOM._replace(
            frames=100,
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


CONTEXT_ROOMS = tuple(_any_room(number) for number in range(50))
"""The recordings of the second forest, which the first one has not seen."""


class Work(NamedTuple):
    """One recording whose samples are drawn by another process.

    Attributes:
        spec: the recording.
        path: the file of the samples.
        earlier: the file of an earlier forest, None for none.
        context: whether the samples are those of the second forest.
    """

    spec: RecordingSpec
    path: Path
    earlier: Path | None
    context: bool = False


def main(words: Sequence[str] | None = None) -> int:
    """Make the forest and return the exit status."""
    arguments = _parser().parse_args(words)
    arguments.directory.mkdir(parents=True, exist_ok=True)
    mocap = find_mocap(arguments.mocap, None) if arguments.mocap else MocapSplit()
    specs = [_scaled(spec, arguments.scale, mocap) for recordings in ROUNDS for spec in recordings]
    rooms = [_scaled(spec, arguments.scale, mocap) for spec in CONTEXT_ROOMS]
    first = _train_first(arguments, mocap)
    work = [_work(arguments, spec, first, context=True) for spec in rooms]
    samples = _draw_all(arguments, work)
    second = train_part_forest(join_samples(samples), TREES, CONTEXT_GROWTH, 0, print)
    provenance = {
        'recordings': ', '.join(f'{spec.name} {spec.settings.frames}' for spec in specs),
        'context': f'{sum(spec.settings.frames for spec in rooms)} synthetic frames',
        'samples': str(sum(len(each.part) for each in samples)),
        'mocap': 'CMU' if arguments.mocap else 'none',
    }
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    save_part_forests(arguments.output, PartForests(_load_forest(first), second), provenance)
    size = arguments.output.stat().st_size
    print(json.dumps(provenance | {'bytes': size, 'leaves': len(second.leaves)}, indent=1))
    return 0


def _train_first(arguments: argparse.Namespace, mocap: MocapSplit) -> Path:
    """Train the first forest in rounds, and return its file."""
    samples: list[PartSamples] = []
    earlier: Path | None = None
    for number, recordings in enumerate(ROUNDS):
        scaled = [_scaled(spec, arguments.scale, mocap) for spec in recordings]
        work = [_work(arguments, spec, earlier) for spec in scaled]
        samples += _draw_all(arguments, work)
        names = ' '.join(each.path.name for each in work)
        path = arguments.directory / f'round_{number}_{_short(names)}.npz'
        if not path.exists():
            forest = train_part_forest(join_samples(samples), TREES, GROWTH, number, print)
            _save(path, forest._asdict())
        earlier = path
    if earlier is None:
        raise AssertionError
    return earlier


def _work(
    arguments: argparse.Namespace,
    spec: RecordingSpec,
    earlier: Path | None,
    *,
    context: bool = False,
) -> Work:
    path = arguments.directory / f'{spec.name}_{_digest(spec, earlier)}.npz'
    return Work(spec, path, earlier, context)


def _draw_all(arguments: argparse.Namespace, work: Sequence[Work]) -> list[PartSamples]:
    with ProcessPoolExecutor(arguments.processes) as pool:
        return [_load(path) for path in pool.map(draw, work)]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog='models/make_body_parts.py', description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    folder = HERE.parent / 'build' / 'body_parts'
    output = resource('models').parent / 'body_parts' / 'body_parts.npz'
    parser.add_argument('--directory', type=Path, default=folder, help='folder of the samples')
    parser.add_argument('--output', type=Path, default=output, help='the file of the forest')
    parser.add_argument('--mocap', type=Path, help='folder of motion capture (BVH)')
    parser.add_argument('--scale', type=float, default=1.0, help='fraction of the frames')
    parser.add_argument('--processes', type=int, default=2, help='processes that draw samples')
    return parser


def _scaled(spec: RecordingSpec, scale: float, mocap: MocapSplit) -> RecordingSpec:
    frames = max(1, round(scale * spec.settings.frames))
    settings = with_mocap(spec.settings._replace(frames=frames), mocap, test=False)
    return spec._replace(settings=settings)


def _digest(spec: RecordingSpec, earlier: Path | None) -> str:
    return _short(digest_of(spec.settings, '') + ('' if earlier is None else earlier.name))


def _short(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:8]


def draw(work: Work) -> Path:
    """Draw the samples of one recording, if they are not there yet, and return their file."""
    if not work.path.exists():
        seed = work.spec.settings.seed
        forest = None if work.earlier is None else _load_forest(work.earlier)
        if work.context and forest is not None:
            grids = (
                PartGrid(grid, parts_of_cells(image.parts, grid.step))
                for image in _images(work.spec)
                for grid in [depth_grid(image.depth, image.camera)]
            )
            samples = collect_context_samples(grids, forest, STRIDE, CONTEXT_CELLS, FARTHEST, seed)
        else:
            samples = collect_samples(
                _images(work.spec), PEOPLE_CELLS, OTHER_CELLS, FARTHEST, seed, forest
            )
        _save(work.path, samples._asdict())
    return work.path


def _save(path: Path, arrays: dict[str, Any]) -> None:
    partial = path.with_suffix('.part.npz')
    np.savez(partial, **arrays)
    partial.replace(path)


def _load_forest(path: Path) -> PartForest:
    with np.load(path, allow_pickle=False) as archive:
        return PartForest(*(archive[name] for name in PartForest._fields))


def _images(spec: RecordingSpec) -> Iterator[PartImage]:
    scenes = synthetic_scenes(spec.settings)
    for scene in progress(scenes, spec.settings.frames, spec.name):
        yield PartImage(scene.frame.depth, scene.parts, scene.frame.camera)


def _load(path: Path) -> PartSamples:
    with np.load(path, allow_pickle=False) as archive:
        return PartSamples(*(archive[name] for name in PartSamples._fields))


if __name__ == '__main__':
    sys.exit(main())
