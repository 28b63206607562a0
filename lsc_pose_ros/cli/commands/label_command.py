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

"""`lsc_pose label`: adds labels from another program to a recording."""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from lsc_pose_ros.bags import FrameReader, RecordingWriter, open_recording
from lsc_pose_ros.bags.storage.writer import RECORDING
from lsc_pose_ros.cli.input.label_sources import SOURCES, open_label_source
from lsc_pose_ros.cli.input.labelled_frames import open_recordings
from lsc_pose_ros.cli.options.numbers import float_from_zero, positive_float
from lsc_pose_ros.cli.options.setting_options import add_setting_options, settings_from
from lsc_pose_ros.cli.options.topic_options import add_topic_arguments, topics_of
from lsc_pose_ros.cli.output.label_check import (
    add_limit_options,
    check_labels,
    limits_from,
    tell_report,
)
from lsc_pose_ros.cli.output.progress import progress
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import HTML, JSON
from lsc_pose_ros.files.output_check import Output, check_outputs
from lsc_pose_ros.labels.body_matching import numbered_as_mask
from lsc_pose_ros.labels.checks.problems import (
    KINDS,
    LENGTH,
    find_problems,
    without_problems,
)
from lsc_pose_ros.labels.checks.study import LabelReport, UsualLengths
from lsc_pose_ros.labels.labelled_copy import LabelCounts, write_labelled_copy
from lsc_pose_ros.labels.mirrored import MIRRORS, MirroredLabels
from lsc_pose_ros.labels.tracks import LabelSource
from lsc_pose_ros.settings.table import MASK, FrameSettings
from lsc_pose_ros.viz.report import PAGE_NAME

HELP = """Add labels (ground_truth/skeletons) to a recording, from what another program knows about
the joints. docs/labels.md is a tutorial."""

# Half of what a camera of 10 Hz leaves between two images.
_LONGEST_GAP = 0.1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command to `parser`."""
    parser.add_argument(
        'recording',
        type=Path,
        metavar='RECORDING',
        help='the recording: an .mcap or .db3 file, or a bag folder',
    )
    parser.add_argument(
        '-o',
        '--output',
        type=Path,
        metavar='LABELLED',
        help='the labelled recording: LABELLED.mcap, or a bag folder',
    )
    _add_source_options(parser)
    _add_check_options(parser)
    add_topic_arguments(parser)


def _add_source_options(parser: argparse.ArgumentParser) -> None:
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
        type=positive_float,
        metavar='METRES',
        help='metres per unit of a csv, bvh or c3d file (default: 1; for c3d what the file says)',
    )
    group.add_argument(
        '--time-offset',
        type=float,
        default=0.0,
        metavar='SECONDS',
        help='is added to the times of the labels (default: %(default)s)',
    )
    group.add_argument(
        '--max-gap',
        type=float_from_zero,
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


def _add_check_options(parser: argparse.ArgumentParser) -> None:
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


def run(arguments: argparse.Namespace) -> int:
    """Write the labelled recording, check it, and return the exit status.

    Raises:
        InputError: the recording, the source or the output cannot be used.
    """
    if arguments.source_kind is None:
        return _check_only(arguments)
    _check(arguments)
    counts = _label(arguments)
    report = _report(arguments, arguments.output) if _is_checked(arguments) else None
    lag = None if report is None else report.lag
    if arguments.correct_lag and lag is not None and lag.found:
        print(f'{arguments.output}: shifted by {lag.seconds:+.3f} s, the lag that was found')
        arguments.time_offset += lag.seconds
        counts = _label(arguments)
        report = _report(arguments, arguments.output)
    _print(arguments.output, counts)
    if report is not None:
        tell_report(arguments.output, report, arguments.report, arguments.json)
    return 0


def _report(arguments: argparse.Namespace, recording: Path) -> LabelReport:
    reader = open_recordings(arguments, [recording])[0]
    return check_labels(reader, arguments.model, limits_from(arguments))


def _is_checked(arguments: argparse.Namespace) -> bool:
    wanted = (arguments.check, arguments.correct_lag, arguments.report, arguments.json)
    return any(wanted)


def _check_only(arguments: argparse.Namespace) -> int:
    if arguments.output is not None or not _is_checked(arguments):
        msg = f'name the source of the labels with --from: {", ".join(SOURCES)}'
        raise InputError(msg)
    check_outputs(_reports(arguments), [arguments.recording])
    report = _report(arguments, arguments.recording)
    tell_report(arguments.recording, report, arguments.report, arguments.json)
    return 0


def _label(arguments: argparse.Namespace) -> LabelCounts:
    """Write the labelled recording and return what it contains."""
    reader = open_unturned(arguments)
    source = _source(arguments, reader)
    limits, lengths = limits_from(arguments), UsualLengths([])
    if LENGTH in arguments.drop:
        labelled = (
            frame._replace(ground_truth=_numbered(source.at(number, frame), frame, reader))
            for number, frame in enumerate(reader)
        )
        lengths = UsualLengths(progress(labelled, reader.count, 'measuring limbs'))
        source = _source(arguments, reader)

    def clean(frame: Frame, skeletons: Skeletons) -> Skeletons:
        problems = find_problems(frame, skeletons, limits, lengths.at(frame.stamp))
        return without_problems(skeletons, problems, arguments.drop)

    counts = LabelCounts()
    with RecordingWriter(arguments.output) as writer:
        frames = write_labelled_copy(reader, source, writer, counts, clean)
        for _ in progress(frames, reader.count, 'labelling'):
            pass
        _check_labels(counts, [*source.warnings, *reader.warnings])
    for warning in [*source.warnings, *reader.warnings]:
        print(f'lsc_pose: warning: {warning}', file=sys.stderr)
    return counts


def _source(arguments: argparse.Namespace, reader: FrameReader) -> LabelSource:
    source = open_label_source(arguments, next(iter(reader)))
    return MirroredLabels(source, arguments.mirror) if arguments.mirror else source


def _numbered(skeletons: Skeletons, frame: Frame, reader: FrameReader) -> Skeletons:
    return numbered_as_mask(skeletons, frame) if reader.topics.mask else skeletons


def open_unturned(arguments: argparse.Namespace) -> FrameReader:
    """Open the recording; its frames are as the camera took them, with masks if it has any."""
    settings = replace(settings_from(arguments, FrameSettings), camera_roll='0', segmentation=MASK)
    topics = topics_of(arguments)
    return open_recording(arguments.recording, topics, settings=settings, need_mask=False)


def _check(arguments: argparse.Namespace) -> None:
    if arguments.output is None:
        msg = 'name the labelled recording with -o LABELLED.mcap'
        raise InputError(msg)
    inputs = [arguments.recording, *(arguments.source or [])]
    inputs += filter(None, [arguments.frames, arguments.extrinsic])
    check_outputs([Output(arguments.output, RECORDING), *_reports(arguments)], inputs)
    if arguments.output.name == '-':
        msg = 'the labelled recording is read again for its check; give -o a file'
        raise InputError(msg)


def _reports(arguments: argparse.Namespace) -> list[Output]:
    outputs = [Output(arguments.json, JSON)] if arguments.json else []
    if arguments.report and arguments.report.exists():
        outputs.append(Output(arguments.report / PAGE_NAME, HTML))
    return outputs


def _check_labels(counts: LabelCounts, warnings: list[str]) -> None:
    """Raise InputError, so that nothing is written, if no frame is labelled."""
    if counts.labelled:
        return
    reasons = '; '.join(warnings) or (
        f'{counts.unmatched} bodies are not on any mask'
        if counts.unmatched
        else 'no label has the time of a depth image (shift them with --time-offset)'
    )
    msg = f'none of the {counts.frames} frames got a label: {reasons}'
    raise InputError(msg)


def _print(output: Path, counts: LabelCounts) -> None:
    print(
        f'{output}: {counts.frames} frames, {counts.labelled} of them labelled, '
        f'{counts.bodies} bodies'
    )
    if counts.unmatched:
        print(f'{counts.unmatched} bodies were left out, because no mask shows them')
