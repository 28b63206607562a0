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

# ruff: noqa: INP001 - part of a program, not of a package
"""The synthetic recordings on which the models of the package are trained and evaluated."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.output.progress import progress
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

CHILDREN, ADULTS, OLD = (4.0, 12.0), (18.0, 60.0), (65.0, 85.0)
"""Ages, years."""

# Each fifth clip of the motion capture is reserved for the tests.
_HELD_OUT_STRIDE = 5


class RecordingSpec(NamedTuple):
    """A synthetic recording.

    Attributes:
        name: the name of its file and of its row in the model's card.
        settings: the settings of the generator.
    """

    name: str
    settings: SyntheticSettings


class Recipe(NamedTuple):
    """The recordings and the options of a model.

    Attributes:
        training: the recordings of the training.
        calibration: recordings of other people, on which the confidence is calibrated.
        tests: the recordings on which the model is evaluated, all together.
        others: further recordings on which it is evaluated, each on its own.
        train_options: options of `lsc_pose train` in addition to those of all models.
        memory: memory of the training, GiB; it limits the number of points per person.
    """

    training: tuple[RecordingSpec, ...]
    calibration: tuple[RecordingSpec, ...]
    tests: tuple[RecordingSpec, ...]
    others: tuple[RecordingSpec, ...]
    train_options: tuple[str, ...]
    memory: float


# New people every three frames: many people are more useful than many poses of each. Cameras on
# robots are low and look level or up; cameras on walls look down.
_ALL_ROUND = SyntheticSettings(
    clip_length=3, yaw=180.0, camera_height=(0.3, 2.2), camera_tilt=(-20.0, 30.0)
)
_FRONT = _ALL_ROUND._replace(yaw=60.0)
_ROOMS = _ALL_ROUND._replace(people=2, furniture=True)
_FRONT_ROOMS = _FRONT._replace(people=2, furniture=True)

_MANY_FRONT = RecordingSpec(
    'kinect_v1_front', _FRONT._replace(frames=12_000, seed=102, mocap_fraction=0.65)
)

# Each sensor, people from all sides.
_ALL_VIEWS = (
    RecordingSpec('test_kinect_v1', _ALL_ROUND._replace(frames=600, seed=901)),
    RecordingSpec('test_kinect_v2', _ALL_ROUND._replace(frames=300, seed=902, sensor='kinect_v2')),
    RecordingSpec('test_azure', _ALL_ROUND._replace(frames=300, seed=903, sensor='azure')),
    RecordingSpec('test_realsense', _ALL_ROUND._replace(frames=300, seed=904, sensor='realsense')),
    RecordingSpec('test_zed', _ALL_ROUND._replace(frames=300, seed=905, sensor='zed')),
    RecordingSpec('test_tof', _ALL_ROUND._replace(frames=300, seed=906, sensor='tof')),
)
# One kind of people each.
_SPECIAL_VIEWS = (
    RecordingSpec('test_front', _FRONT._replace(frames=300, seed=911)),
    RecordingSpec('test_children', _ALL_ROUND._replace(frames=300, seed=912, age=CHILDREN)),
    RecordingSpec('test_adults', _ALL_ROUND._replace(frames=300, seed=913, age=ADULTS)),
    RecordingSpec('test_old', _ALL_ROUND._replace(frames=300, seed=916, age=OLD)),
    RecordingSpec('test_cropped', _ALL_ROUND._replace(frames=300, seed=914, cropped=True)),
    RecordingSpec('test_two_people', _ALL_ROUND._replace(frames=300, seed=915, people=2)),
    RecordingSpec('test_rooms', _ROOMS._replace(frames=400, seed=921)),
    RecordingSpec('test_rooms_sloppy', _ROOMS._replace(frames=150, seed=922, sloppy_masks=True)),
)

_FRONT_VIEWS = tuple(
    RecordingSpec(
        f'front_{spec.name}', spec.settings._replace(seed=spec.settings.seed + 40, yaw=60.0)
    )
    for spec in _ALL_VIEWS
)

RECIPES: dict[str, Recipe] = {
    'default': Recipe(
        training=(
            RecordingSpec('kinect_v1', _ALL_ROUND._replace(frames=12_000, seed=101)),
            _MANY_FRONT,
            RecordingSpec(
                'kinect_v1_far', _ALL_ROUND._replace(frames=1_000, seed=103, distance=(3.0, 5.0))
            ),
            RecordingSpec(
                'kinect_v1_cropped', _ALL_ROUND._replace(frames=1_500, seed=104, cropped=True)
            ),
            RecordingSpec(
                'kinect_v1_children', _ALL_ROUND._replace(frames=1_500, seed=105, age=CHILDREN)
            ),
            RecordingSpec(
                'kinect_v2', _ALL_ROUND._replace(frames=5_000, seed=106, sensor='kinect_v2')
            ),
            RecordingSpec('azure', _ALL_ROUND._replace(frames=5_000, seed=107, sensor='azure')),
            RecordingSpec(
                'realsense', _ALL_ROUND._replace(frames=6_000, seed=108, sensor='realsense')
            ),
            RecordingSpec('zed', _ALL_ROUND._replace(frames=6_000, seed=109, sensor='zed')),
            RecordingSpec('tof', _ALL_ROUND._replace(frames=5_000, seed=110, sensor='tof')),
            # The same with other seeds.
            RecordingSpec('kinect_v1_more', _ALL_ROUND._replace(frames=4_000, seed=111)),
            RecordingSpec(
                'realsense_more', _ALL_ROUND._replace(frames=4_000, seed=114, sensor='realsense')
            ),
            RecordingSpec('zed_more', _ALL_ROUND._replace(frames=6_000, seed=115, sensor='zed')),
            # Rooms: two people each, many of them seated or half hidden.
            RecordingSpec('rooms_kinect_v1', _ROOMS._replace(frames=4_000, seed=121)),
            RecordingSpec(
                'rooms_kinect_v2', _ROOMS._replace(frames=1_500, seed=122, sensor='kinect_v2')
            ),
            RecordingSpec('rooms_azure', _ROOMS._replace(frames=2_000, seed=123, sensor='azure')),
            RecordingSpec(
                'rooms_realsense', _ROOMS._replace(frames=2_000, seed=124, sensor='realsense')
            ),
            RecordingSpec(
                'rooms_filtered',
                _ROOMS._replace(frames=800, seed=125, sensor='realsense_filtered'),
            ),
            RecordingSpec('rooms_zed', _ROOMS._replace(frames=1_000, seed=126, sensor='zed')),
            RecordingSpec('rooms_tof', _ROOMS._replace(frames=1_000, seed=127, sensor='tof')),
            RecordingSpec(
                'rooms_sloppy', _ROOMS._replace(frames=800, seed=128, sloppy_masks=True)
            ),
        ),
        calibration=(
            RecordingSpec('calibration', _ALL_ROUND._replace(frames=1_800, seed=201)),
            RecordingSpec(
                'calibration_realsense',
                _ALL_ROUND._replace(frames=900, seed=202, sensor='realsense'),
            ),
            RecordingSpec(
                'calibration_tof', _ALL_ROUND._replace(frames=900, seed=203, sensor='tof')
            ),
            RecordingSpec('calibration_rooms', _ROOMS._replace(frames=600, seed=204)),
        ),
        tests=_ALL_VIEWS,
        others=_SPECIAL_VIEWS,
        train_options=('--leaf-samples', '23', '--body-yaw'),
        memory=13.0,
    ),
    'front': Recipe(
        training=(
            _MANY_FRONT,
            RecordingSpec('front_kinect_v1', _FRONT._replace(frames=12_000, seed=301)),
            RecordingSpec('front_children', _FRONT._replace(frames=1_500, seed=302, age=CHILDREN)),
            RecordingSpec(
                'front_kinect_v2', _FRONT._replace(frames=1_500, seed=303, sensor='kinect_v2')
            ),
            RecordingSpec('front_azure', _FRONT._replace(frames=1_500, seed=304, sensor='azure')),
            RecordingSpec(
                'front_realsense', _FRONT._replace(frames=1_500, seed=305, sensor='realsense')
            ),
            RecordingSpec('front_zed', _FRONT._replace(frames=1_000, seed=306, sensor='zed')),
            RecordingSpec('front_tof', _FRONT._replace(frames=1_000, seed=307, sensor='tof')),
            RecordingSpec('front_rooms', _FRONT_ROOMS._replace(frames=2_000, seed=321)),
            RecordingSpec(
                'front_rooms_azure', _FRONT_ROOMS._replace(frames=600, seed=322, sensor='azure')
            ),
            RecordingSpec(
                'front_rooms_realsense',
                _FRONT_ROOMS._replace(frames=600, seed=323, sensor='realsense'),
            ),
        ),
        calibration=(
            RecordingSpec('front_calibration', _FRONT._replace(frames=1_000, seed=401)),
            RecordingSpec('front_calibration_rooms', _FRONT_ROOMS._replace(frames=300, seed=402)),
        ),
        tests=_FRONT_VIEWS,
        others=(),
        train_options=('--leaf-samples', '20'),
        memory=8.0,
    ),
}
"""The recipe of each model of the package, by name."""


class MocapSplit(NamedTuple):
    """The motion capture for half of the people.

    Attributes:
        folder: the folder of the BVH files; None for none.
        mapping: the mapping of their joints; None for that of the CMU clips.
        held_out: the names of the clips that only the tests use.
    """

    folder: Path | None = None
    mapping: Path | None = None
    held_out: tuple[str, ...] = ()


def find_mocap(folder: Path, mapping: Path | None) -> MocapSplit:
    """Return the clips in `folder`, some of them held out.

    Raises:
        InputError: there are too few clips to hold any out.
    """
    clips = _clips_in(folder)
    if len(clips) < _HELD_OUT_STRIDE:
        msg = f'{folder}: {len(clips)} BVH files are too few; give {_HELD_OUT_STRIDE} or more'
        raise InputError(msg)
    return MocapSplit(folder, mapping, tuple(clips[_HELD_OUT_STRIDE - 1 :: _HELD_OUT_STRIDE]))


def _clips_in(folder: Path) -> list[str]:
    return sorted(
        path.relative_to(folder).with_suffix('').as_posix() for path in folder.rglob('*.bvh')
    )


def generate(
    specs: Sequence[RecordingSpec], mocap: MocapSplit, folder: Path, *, test: bool
) -> list[Path]:
    """Generate the recordings of `specs` in `folder` and return them; existing ones are reused.

    Args:
        specs: the recordings.
        mocap: the motion capture, if any.
        folder: the folder of the recordings.
        test: whether to use the clips that are held out, or the others.

    Raises:
        InputError: the settings or the clips cannot be used.
    """
    if mocap.folder is None:
        return [_generate(spec, '', folder) for spec in specs]
    clips = ' '.join(_clips_in(mocap.folder))
    return [
        _generate(
            spec._replace(settings=with_mocap(spec.settings, mocap, test=test)), clips, folder
        )
        for spec in specs
    ]


def with_mocap(settings: SyntheticSettings, mocap: MocapSplit, *, test: bool) -> SyntheticSettings:
    """Return settings with the clips that are held out for tests, or with all others."""
    return settings._replace(
        mocap=mocap.folder,
        mocap_mapping=mocap.mapping,
        mocap_only=mocap.held_out if test else (),
        mocap_without=() if test else mocap.held_out,
    )


def _generate(spec: RecordingSpec, clips: str, folder: Path) -> Path:
    path = folder / f'{spec.name}_{digest_of(spec.settings, clips)}.mcap'
    if not path.exists():
        frames = progress(synthetic_frames(spec.settings), spec.settings.frames, spec.name)
        # The writer renames the file at the end, so an existing file is complete.
        with RecordingWriter(path) as writer:
            for frame in frames:
                writer.write_frame(frame)
    return path


def digest_of(settings: SyntheticSettings, clips: str) -> str:
    """Return a digest of the settings and of the names of the clips, but not of their folder."""
    named = settings._asdict() | {'mocap': clips, 'mocap_mapping': bool(settings.mocap_mapping)}
    return hashlib.sha256(repr(named).encode()).hexdigest()[:8]
