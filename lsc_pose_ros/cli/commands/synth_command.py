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

"""`lsc_pose synth`: generates a labelled recording of synthetic people."""

import argparse
from pathlib import Path
from typing import Any

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.bags.storage.writer import RECORDING
from lsc_pose_ros.cli.options.image_size import image_size
from lsc_pose_ros.cli.output.progress import progress
from lsc_pose_ros.files.output_check import Output, check_outputs
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames
from lsc_pose_ros.synthetic.sensors.sensors import NOISES, SENSORS
from lsc_pose_ros.synthetic.settings import CLIP_LENGTH, VIDEO_CLIP_LENGTH, clip_length_of

HELP = 'generate a labelled recording of synthetic people'

_DEFAULTS = SyntheticSettings()


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's own arguments to `parser`."""
    parser.add_argument(
        'output', type=Path, metavar='OUT', help='the recording: OUT.mcap, or a bag folder'
    )
    _add_amount(parser)
    _add_people(parser)
    _add_positions(parser.add_argument_group('positions of camera and people'))
    _add_sensor(parser.add_argument_group('the camera'))
    _add_mocap(
        parser.add_argument_group("motion capture, in addition to the generator's own poses")
    )


def run(arguments: argparse.Namespace) -> int:
    """Generate the recording that `arguments` describe; return the exit status.

    Raises:
        InputError: the settings or the output cannot be used.
    """
    settings = settings_of(arguments)
    frames = synthetic_frames(settings)
    inputs = filter(None, [arguments.mocap, arguments.mocap_mapping])
    check_outputs([Output(arguments.output, RECORDING)], inputs)
    writer = RecordingWriter(arguments.output)
    with writer:
        for frame in progress(frames, settings.frames, 'generating'):
            writer.write_frame(frame)
    clips = -(-settings.frames // clip_length_of(settings))
    print(f'{arguments.output}: {settings.frames} frames, {clips * settings.people} people')
    return 0


def settings_of(arguments: argparse.Namespace) -> SyntheticSettings:
    """Return the settings that `arguments` describe."""
    width, height = arguments.size or (None, None)
    given = vars(arguments) | {'width': width, 'height': height}
    values: dict[str, Any] = {}
    for name in SyntheticSettings._fields:
        value = given[name]
        values[name] = tuple(value) if isinstance(value, list) else value
    return SyntheticSettings(**values)


def _add_amount(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--frames',
        type=int,
        default=_DEFAULTS.frames,
        metavar='N',
        help='number of frames (%(default)s)',
    )
    parser.add_argument(
        '--seed',
        type=int,
        default=_DEFAULTS.seed,
        metavar='N',
        help='seed of the random numbers; the same seed gives the same frames (%(default)s)',
    )
    parser.add_argument(
        '--fps',
        type=float,
        dest='rate',
        metavar='HZ',
        help='frame rate of a video; without it, each frame has a new pose',
    )
    parser.add_argument(
        '--clip-length',
        type=int,
        metavar='N',
        help=f'frames with the same people ({CLIP_LENGTH}; {VIDEO_CLIP_LENGTH} in a video)',
    )


def _add_people(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--people',
        type=int,
        default=_DEFAULTS.people,
        metavar='N',
        help='people per frame (%(default)s)',
    )
    _add_range(parser, 'age', ('YOUNGEST', 'OLDEST'), 'age in years')
    _add_range(parser, 'stature', ('SMALLEST', 'TALLEST'), 'stature in metres')
    parser.add_argument(
        '--yaw',
        type=float,
        default=_DEFAULTS.yaw,
        metavar='DEGREES',
        help='largest angle between facing direction and camera; 180: all sides (%(default)g)',
    )


def _add_positions(parser: argparse._ArgumentGroup) -> None:
    _add_range(
        parser,
        'distance',
        ('NEAREST', 'FARTHEST'),
        'distance from the camera, metres; people who do not fit in the image stand farther away',
    )
    _add_range(
        parser,
        'height',
        ('LOWEST', 'HIGHEST'),
        'height of the camera, metres',
        dest='camera_height',
    )
    _add_range(
        parser,
        'tilt',
        ('LEAST', 'MOST'),
        'downward tilt of the camera, degrees; negative is upward',
        dest='camera_tilt',
    )
    parser.add_argument(
        '--crossing',
        action='store_true',
        help='in a video: people walk to and fro, one behind the other, hide each other, and '
        'leave the image',
    )
    parser.add_argument(
        '--cropped',
        action='store_true',
        help='let the edge of the image cut off people; otherwise they are in full view',
    )
    parser.add_argument(
        '--background',
        action='store_true',
        help='add a room with furniture around the people, which does not hide them',
    )
    parser.add_argument(
        '--furniture',
        action='store_true',
        help='add a room full of furniture, which hides parts of the people; a quarter of them '
        'sit, and some are cut off by the edge of the image; --people can be 0',
    )
    parser.add_argument(
        '--sloppy-masks',
        action='store_true',
        help='masks that are too large, too small or displaced by up to 5 %% of the width of the '
        'image, and have holes, like those of a segmenter',
    )


def _add_sensor(parser: argparse._ArgumentGroup) -> None:
    parser.add_argument(
        '--sensor',
        choices=SENSORS,
        default=_DEFAULTS.sensor,
        help='camera that defines size, field of view and noise (%(default)s): %(choices)s',
        metavar='NAME',
    )
    parser.add_argument(
        '--size',
        type=image_size,
        metavar='WIDTHxHEIGHT',
        help="size of the image, pixels (the sensor's)",
    )
    parser.add_argument(
        '--fov',
        type=float,
        dest='field_of_view',
        metavar='DEGREES',
        help="horizontal field of view (the sensor's)",
    )
    parser.add_argument(
        '--noise',
        choices=NOISES,
        metavar='NAME',
        help="noise of this sensor, or none (the sensor's own)",
    )


def _add_mocap(parser: argparse._ArgumentGroup) -> None:
    parser.add_argument('--mocap', type=Path, metavar='DIR', help='folder of BVH files')
    parser.add_argument(
        '--mocap-mapping',
        type=Path,
        metavar='FILE',
        help='mapping of the joints in the files (config/mocap/cmu.yaml)',
    )
    parser.add_argument(
        '--mocap-fraction',
        type=float,
        default=_DEFAULTS.mocap_fraction,
        metavar='FRACTION',
        help='fraction of people who move as in the files, 0 to 1 (%(default)g)',
    )
    for name, meaning in (('only', 'use only these files'), ('without', 'do not use these files')):
        parser.add_argument(
            f'--mocap-{name}',
            nargs='+',
            default=(),
            metavar='CLIP',
            help=f"{meaning}, named without '.bvh'; '05_*' is a pattern",
        )


def _add_range(
    parser: argparse._ActionsContainer,
    name: str,
    ends: tuple[str, str],
    meaning: str,
    *,
    dest: str | None = None,
) -> None:
    low, high = getattr(_DEFAULTS, dest or name)
    parser.add_argument(
        f'--{name}',
        dest=dest,
        type=float,
        nargs=2,
        default=(low, high),
        metavar=ends,
        help=f'{meaning} ({low:g} {high:g})',
    )
