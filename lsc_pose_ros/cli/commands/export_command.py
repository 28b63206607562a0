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

"""`lsc_pose export`: writes the joints of a recording for other programs."""

import argparse
from pathlib import Path

from lsc_pose_ros.bags import RecordingReader
from lsc_pose_ros.bags.topics import DEFAULT_TOPICS
from lsc_pose_ros.cli.input.joint_sequence import JointSequence, read_joint_sequence
from lsc_pose_ros.cli.output.joint_tables import kind_of_table, write_joints
from lsc_pose_ros.cli.output.progress import warn
from lsc_pose_ros.cli.output.terminal_text import name_of
from lsc_pose_ros.files.output_check import Output, check_outputs

HELP = """Write the joints that a recording contains for other programs: as a table (.csv,
.parquet), as arrays (.npz), as .json, or as an animation (.bvh)."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command to `parser`."""
    parser.add_argument(
        'recording',
        type=Path,
        metavar='RECORDING',
        help='a recording with skeletons: an .mcap or .db3 file, or a bag folder',
    )
    parser.add_argument(
        '-o',
        '--output',
        type=Path,
        required=True,
        metavar='FILE',
        help='the file; its suffix names the format: .csv, .parquet, .npz, .json or .bvh',
    )
    parser.add_argument(
        '--topic',
        default='',
        metavar='TOPIC',
        help='the skeletons (default: the estimates, or the ground truth if there are none)',
    )
    parser.add_argument(
        '--frame',
        default='',
        metavar='FRAME',
        help='write positions in this frame of /tf (default: the frame of the camera)',
    )
    parser.add_argument(
        '--wide',
        action='store_true',
        help='for .csv and .parquet: one row for each body, not for each joint',
    )
    parser.add_argument(
        '--body', type=int, metavar='N', help='for .bvh: the body (default: the most frequent one)'
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the joints and return the exit status.

    Raises:
        InputError: the recording has no skeletons, or the file cannot be written.
    """
    output = Output(arguments.output, kind_of_table(arguments.output))
    check_outputs([output], [arguments.recording])
    recording = RecordingReader(arguments.recording)
    truth = DEFAULT_TOPICS.ground_truth
    ground_truth = truth if truth in recording.topics else ''
    sequence = read_joint_sequence(recording, arguments.topic, ground_truth, arguments.frame)
    write_joints(arguments.output, sequence, wide=arguments.wide, body=arguments.body)
    if sequence.without_pose:
        warn(
            f'{sequence.without_pose} bodies were left out: TF does not know {arguments.frame} at '
            'their time'
        )
    if sequence.damaged:
        warn(f'{sequence.damaged} messages of {name_of(sequence.topic)} cannot be read')
    print(
        f'{arguments.output}: {len(sequence.stamps)} skeletons of {_bodies(sequence)}, '
        f'{len(sequence.joints)} joints of {name_of(sequence.topic)}, in '
        f'{name_of(sequence.frame_id)}'
    )
    return 0


def _bodies(sequence: JointSequence) -> str:
    count = len(set(sequence.bodies))
    return f'{count} {"body" if count == 1 else "bodies"}'
