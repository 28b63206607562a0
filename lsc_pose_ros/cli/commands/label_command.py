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
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from lsc_pose_ros.bags import FrameReader, RecordingWriter, open_recording
from lsc_pose_ros.bags.storage.writer import RECORDING
from lsc_pose_ros.cli.input.label_sources import SOURCES, open_label_source
from lsc_pose_ros.cli.input.labelled_frames import open_recordings
from lsc_pose_ros.cli.options.label_options import add_check_options, add_source_options
from lsc_pose_ros.cli.options.setting_options import settings_from
from lsc_pose_ros.cli.options.topic_options import add_topic_arguments, topics_of
from lsc_pose_ros.cli.output.label_check import (
    check_labels,
    limits_from,
    tell_report,
)
from lsc_pose_ros.cli.output.progress import progress, warn
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import HTML, JSON
from lsc_pose_ros.files.output_check import Output, check_outputs, outputs_in
from lsc_pose_ros.files.output_place import is_written_through
from lsc_pose_ros.labels.body_matching import numbered_as_mask
from lsc_pose_ros.labels.checks.problems import (
    LENGTH,
    find_problems,
    without_problems,
)
from lsc_pose_ros.labels.checks.study import LabelReport, UsualLengths
from lsc_pose_ros.labels.labelled_copy import LabelCounts, write_labelled_copy
from lsc_pose_ros.labels.mirrored import MirroredLabels
from lsc_pose_ros.labels.tracks import LabelSource
from lsc_pose_ros.settings.table import MASK, FrameSettings
from lsc_pose_ros.viz.report import PAGE_NAME

HELP = """Add labels (ground_truth/skeletons) to a recording, from what another program knows about
the joints. docs/labels.md is a tutorial."""

# What only --from uses: without it, they would be ignored.
_NEED_SOURCE = (
    'source', 'topic', 'frames', 'joints', 'extrinsic', 'scale', 'time_offset', 'min_confidence',
    'correct_lag', 'mirror', 'drop',
)  # fmt: skip

# So begin the reasons that a time offset may remedy.
_AT_OTHER_TIMES = ('before the', 'after the', 'in a gap')


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
    add_source_options(parser)
    add_check_options(parser)
    add_topic_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Write the labelled recording, check it, and return the exit status.

    Raises:
        InputError: the recording, the source or the output cannot be used.
    """
    if arguments.source_kind is None:
        return _check_only(arguments)
    _check(arguments)
    if arguments.correct_lag:
        _correct_lag(arguments)
    counts = _label(arguments, arguments.drop)
    report = _report(arguments, arguments.output) if _is_checked(arguments) else None
    _print(arguments.output, counts)
    if report is not None:
        tell_report(arguments.output, report, arguments.report, arguments.json)
    return 0


def _correct_lag(arguments: argparse.Namespace) -> None:
    """Add the lag that is found to the time offset.

    It is that of all joints: at another time, others are outside of the mask.
    """
    _label(arguments, [])
    report = _report(arguments, arguments.output)
    if report.lag is None or not report.lag_found:
        return
    seconds = report.lag.seconds
    print(f'{arguments.output}: shifted by {seconds:+.3f} s, the lag that was found')
    arguments.time_offset += seconds


def _report(arguments: argparse.Namespace, recording: Path) -> LabelReport:
    reader = open_recordings(arguments, [recording])[0]
    return check_labels(reader, arguments.model, limits_from(arguments))


def _is_checked(arguments: argparse.Namespace) -> bool:
    wanted = (arguments.check, arguments.correct_lag, arguments.report, arguments.json)
    return any(wanted)


def _check_only(arguments: argparse.Namespace) -> int:
    own = '--from skeletons takes the labels that the recording has'
    unused = [name for name in _NEED_SOURCE if getattr(arguments, name)]
    if unused and arguments.output is None:
        msg = f'--{unused[0].replace("_", "-")} needs -o and --from; {own}'
        raise InputError(msg)
    if arguments.output is not None or not _is_checked(arguments):
        msg = f'name the source of the labels with --from: {", ".join(SOURCES)}; {own}'
        raise InputError(msg)
    check_outputs(_reports(arguments), [arguments.recording])
    report = _report(arguments, arguments.recording)
    tell_report(arguments.recording, report, arguments.report, arguments.json)
    return 0


def _label(arguments: argparse.Namespace, drop: Sequence[str]) -> LabelCounts:
    """Write the labelled recording without the problems in `drop`; return what it contains."""
    reader = open_unturned(arguments)
    source = _source(arguments, reader)
    limits, lengths = limits_from(arguments), UsualLengths([])
    if LENGTH in drop:
        labelled = (
            frame._replace(ground_truth=_numbered(source.at(number, frame), frame, reader))
            for number, frame in enumerate(reader)
        )
        lengths = UsualLengths(progress(labelled, reader.count, 'measuring limbs'))
        source = _source(arguments, reader)

    def clean(frame: Frame, skeletons: Skeletons) -> Skeletons:
        problems = find_problems(frame, skeletons, limits, lengths.at(frame.stamp))
        return without_problems(skeletons, problems, drop)

    counts = LabelCounts()
    with RecordingWriter(arguments.output) as writer:
        frames = write_labelled_copy(reader, source, writer, counts, clean)
        for _ in progress(frames, reader.count, 'labelling'):
            pass
        _check_labels(counts, [*source.warnings, *reader.warnings])
    for warning in [*source.warnings, *reader.warnings]:
        warn(warning)
    if counts.behind:
        warn(
            f'joints behind the camera were left out: {counts.behind}; check the extrinsic and '
            'the axes of the labels'
        )
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
    if is_written_through(arguments.output):
        msg = 'the labelled recording is read again for its check; give -o a file'
        raise InputError(msg)


def _reports(arguments: argparse.Namespace) -> list[Output]:
    outputs = [Output(arguments.json, JSON)] if arguments.json else []
    if arguments.report:
        outputs += outputs_in(arguments.report, {PAGE_NAME: HTML})
    return outputs


def _check_labels(counts: LabelCounts, warnings: list[str]) -> None:
    """Raise InputError, so that nothing is written, if no frame is labelled."""
    if counts.labelled:
        return
    remedy = ''
    if counts.unmatched:
        remedy = '; check the place of the joints: --extrinsic or /tf, and the unit: --scale'
    elif any(reason.startswith(_AT_OTHER_TIMES) for reason in counts.missing):
        remedy = '; shift the labels with --time-offset'
    reasons = '; '.join([f'{_missing(counts)}{remedy}', *warnings])
    msg = f'none of the {counts.frames} frames got a label: {reasons}'
    raise InputError(msg)


def _missing(counts: LabelCounts) -> str:
    """Return how many frames have no label for each reason, in words."""
    return ', '.join(f'{count} {reason}' for reason, count in counts.missing.most_common())


def _print(output: Path, counts: LabelCounts) -> None:
    print(
        f'{output}: {counts.frames} frames, {counts.labelled} of them labelled, '
        f'{counts.bodies} bodies'
    )
    if counts.missing:
        noun = 'frame' if counts.missing.total() == 1 else 'frames'
        print(f'{counts.missing.total()} {noun} got no label: {_missing(counts)}')
    if counts.unmatched:
        print(f'{counts.unmatched} bodies were left out, because no mask shows them')
