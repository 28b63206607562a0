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

"""`lsc_pose import`: converts a public data set into a labelled recording."""

import argparse
from pathlib import Path

from lsc_pose_ros.bags import RecordingWriter, open_recording
from lsc_pose_ros.bags.storage.writer import RECORDING
from lsc_pose_ros.cli.input.importers import IMPORTERS
from lsc_pose_ros.cli.output.progress import progress
from lsc_pose_ros.datasets.utd_mhad import (
    LABEL_MARGIN,
    LAG,
    Selection,
    import_utd_mhad,
    select_sequences,
)
from lsc_pose_ros.files.kinds import HTML
from lsc_pose_ros.files.output_check import Output, check_outputs, outputs_in
from lsc_pose_ros.files.output_place import is_written_through
from lsc_pose_ros.labels.checks.problems import LabelLimits
from lsc_pose_ros.viz.report import PAGE_NAME

HELP = 'convert a public data set, images or a ROS 1 bag into a recording'

_UTD_MHAD = f"""\
Convert UTD-MHAD (Chen, Jafari, Kehtarnavaz, ICIP 2015: 27 actions in front of a Kinect v1) into
a labelled recording. Three errors of the data set are corrected:

  mirrored  its images and its X axis are mirrored. Images are flipped left-right, positions
            (X, Y up, Z) become (-X, -Y, Z) in the optical frame; left and right are the
            person's own.
  lag       its skeletons are {LAG} frames ahead of its depth: depth image k gets skeleton
            k - {LAG}, and the first {LAG} depth images of each sequence are left out.
  labels    they come from the tracker of the Kinect SDK, which sometimes loses a limb: a joint
            more than {LABEL_MARGIN} pixels outside of the mask is not labelled (NaN), unless
            --no-label-filter is given.

Frames are sorted by subject, action, trial and time; stamps are the original 30 Hz, with a gap of
a second between sequences. The number of the body in the mask is 1.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the data sets, each with its own arguments, to `parser`."""
    datasets = parser.add_subparsers(dest='dataset', required=True, metavar='DATASET')
    utd_mhad = datasets.add_parser(
        'utd-mhad',
        help='UTD-MHAD: real people in front of a Kinect v1',
        description=_UTD_MHAD,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    utd_mhad.add_argument(
        'directory',
        type=Path,
        metavar='DIR',
        help='folder that contains the folders Depth and Skeleton',
    )
    utd_mhad.add_argument(
        'output', type=Path, metavar='OUT', help='the recording: OUT.mcap, or a bag folder'
    )
    for name in ('subjects', 'actions', 'trials'):
        utd_mhad.add_argument(
            f'--{name}', type=int, nargs='+', metavar='N', help=f'only these {name} (default: all)'
        )
    utd_mhad.add_argument(
        '--stride',
        type=int,
        default=1,
        metavar='N',
        help='use each Nth frame (default: %(default)s)',
    )
    utd_mhad.add_argument(
        '--max-frames',
        type=int,
        metavar='N',
        help='choose N frames at random, spread evenly over all selected (default: all)',
    )
    utd_mhad.add_argument(
        '--seed',
        type=int,
        default=0,
        help='seed of the random choice of --max-frames (default: %(default)s)',
    )
    utd_mhad.add_argument(
        '--no-label-filter',
        dest='label_filter',
        action='store_false',
        help=f'keep labels more than {LABEL_MARGIN} pixels outside of the mask',
    )
    _add_check_options(utd_mhad)
    for name, importer in IMPORTERS.items():
        other = datasets.add_parser(name, help=importer.help, description=importer.description)
        importer.add_arguments(other)
        if importer.labelled:
            _add_check_options(other)


def _add_check_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--check',
        action=argparse.BooleanOptionalAction,
        default=True,
        help='check the imported labels, as `lsc_pose label` does (default: %(default)s)',
    )
    parser.add_argument(
        '--report', type=Path, metavar='DIR', help='write a page with the worst frames there'
    )


def run(arguments: argparse.Namespace) -> int:
    """Import the data set that `arguments` name and return the exit status.

    Raises:
        InputError: the data set or the output cannot be used.
    """
    outputs = [Output(arguments.output, RECORDING)]
    if getattr(arguments, 'report', None):  # data sets without labels have none
        outputs += outputs_in(arguments.report, {PAGE_NAME: HTML})
    check_outputs(outputs, [arguments.directory])
    writer = RecordingWriter(arguments.output)
    if arguments.dataset in IMPORTERS:
        importer = IMPORTERS[arguments.dataset]
        print(f'{arguments.output}: {importer.write(arguments, writer)}')
        labelled = importer.labelled
    else:
        print(f'{arguments.output}: {_import_utd_mhad(arguments, writer)}')
        labelled = True
    if labelled and arguments.check and not is_written_through(arguments.output):
        # The check needs the method, which an import without it need not wait for.
        from lsc_pose_ros.cli.output.label_check import check_labels, tell_report  # noqa: PLC0415

        report = check_labels(open_recording(arguments.output), '', LabelLimits())
        tell_report(arguments.output, report, arguments.report, None)
    return 0


def _import_utd_mhad(arguments: argparse.Namespace, writer: RecordingWriter) -> str:
    """Write the recording and return what it contains, in words."""
    selection = Selection(
        subjects=arguments.subjects,
        actions=arguments.actions,
        trials=arguments.trials,
        stride=arguments.stride,
        max_frames=arguments.max_frames,
        seed=arguments.seed,
    )
    sequences = select_sequences(arguments.directory, selection)
    count = sum(len(sequence.frames) for sequence in sequences)
    frames = import_utd_mhad(sequences, label_filter=arguments.label_filter)
    with writer:
        for frame in progress(frames, count, 'importing'):
            writer.write_frame(frame)
    return f'{count} frames of {len(sequences)} sequences'
