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

"""The options of `lsc_pose label`: where labels come from, and their check."""

import argparse
from pathlib import Path

from lsc_pose_ros.cli.input.label_sources import SOURCES
from lsc_pose_ros.cli.options.numbers import SCALES, float_from_zero, number_between
from lsc_pose_ros.cli.options.setting_options import add_setting_options
from lsc_pose_ros.cli.output.label_check import add_limit_options
from lsc_pose_ros.labels.checks.problems import KINDS
from lsc_pose_ros.labels.mirrored import MIRRORS

# Half of what a camera of 10 Hz leaves between two images.
_LONGEST_GAP = 0.1

# More than 30 years, seconds: clocks that were never set are so far off.
_LONGEST_TIME = 2e9


def add_source_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that say where labels come from."""
    group = parser.add_argument_group('where the labels come from')
    group.add_argument(
        '--from',
        dest='source_kind',
        choices=SOURCES,
        help='; '.join(f'{name}: {text}' for name, text in SOURCES.items()),
    )
    group.add_argument(
        '--source',
        type=Path,
        nargs='+',
        metavar='PATH',
        help='the file with the labels; for tf, markers and skeletons, another recording '
        '(default: RECORDING)',
    )
    group.add_argument(
        '--topic', default='', metavar='TOPIC', help='the topic of markers or skeletons'
    )
    group.add_argument(
        '--frames', type=Path, metavar='YAML', help='for tf: which frame is which joint'
    )
    group.add_argument(
        '--joints',
        metavar='VOCABULARY',
        help='the joint vocabulary: a name, such as azure or coco, or a .yaml file (default: '
        'azure for markers, coco for keypoints, plug_in_gait for c3d, else our own names)',
    )
    group.add_argument(
        '--extrinsic',
        type=Path,
        metavar='YAML',
        help="the pose of the camera's optical frame in the frame of the labels (default: from "
        'TF; a CSV file is in the frame of the camera)',
    )
    group.add_argument(
        '--scale',
        type=number_between(float, *SCALES),
        metavar='METRES',
        help='metres per unit of a csv, bvh or c3d file (default: 1; for c3d what the file says)',
    )
    group.add_argument(
        '--time-offset',
        type=number_between(float, -_LONGEST_TIME, _LONGEST_TIME),
        default=0.0,
        metavar='SECONDS',
        help='is added to the times of the labels (default: %(default)s)',
    )
    group.add_argument(
        '--max-gap',
        type=number_between(float, 0, _LONGEST_TIME),
        default=_LONGEST_GAP,
        metavar='SECONDS',
        help='labels are interpolated between two that are at most so far apart, and left out '
        'in longer gaps (default: %(default)s)',
    )
    group.add_argument(
        '--min-confidence',
        type=float_from_zero,
        default=0.0,
        metavar='C',
        help='leave out keypoints and joints of skeletons with less (default: %(default)s)',
    )
    group.add_argument(
        '--anatomy',
        action=argparse.BooleanOptionalAction,
        default=True,
        help='add the offsets of the vocabulary, which put the joints where they are in our '
        'anatomy (default: %(default)s)',
    )


def add_check_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of the check, and of what is done about it."""
    group = parser.add_argument_group('check of the labels')
    group.add_argument(
        '--check',
        action=argparse.BooleanOptionalAction,
        default=True,
        help='check the labels against depth, mask and the model; without --from, those that '
        'RECORDING has (default: %(default)s)',
    )
    group.add_argument(
        '--report', type=Path, metavar='DIR', help='write a page with the worst frames there'
    )
    group.add_argument('--json', type=Path, metavar='FILE', help='write what was found there')
    group.add_argument(
        '--correct-lag',
        action='store_true',
        help='if labels and depth are found to be apart in time, label again without the lag',
    )
    group.add_argument(
        '--mirror', choices=MIRRORS, help='undo mirroring: exchange left and right, or negate x'
    )
    kinds = '; '.join(f'{name}: {text}' for name, text in KINDS.items())
    group.add_argument(
        '--drop',
        nargs='+',
        choices=KINDS,
        default=[],
        metavar='KIND',
        help=f'leave out joints that are: {kinds}',
    )
    add_limit_options(group)
    add_setting_options(group, 'model')
