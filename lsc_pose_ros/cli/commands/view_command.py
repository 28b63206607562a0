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

"""`lsc_pose view`: draw frames of a recording as PNG files."""

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path

from lsc_pose_ros.bags import FrameReader, RecordingReader, read_messages
from lsc_pose_ros.cli.input.recorded_skeletons import (
    find_skeletons_topic,
    read_skeletons_at,
    stamps_with_joints,
)
from lsc_pose_ros.cli.options.frame_selection import NumberedFrame, pick, spread
from lsc_pose_ros.cli.options.numbers import positive_int
from lsc_pose_ros.cli.options.setting_options import add_setting_options
from lsc_pose_ros.cli.options.topic_options import add_topic_arguments, open_frames
from lsc_pose_ros.cli.output.progress import progress, warn
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons, known_bodies
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import PNG
from lsc_pose_ros.files.output_check import Output, check_outputs, outputs_in
from lsc_pose_ros.files.output_place import is_written_through
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.resources.package_files import DEFAULT_MODEL, find_model, shipped_models
from lsc_pose_ros.settings.table import MASK
from lsc_pose_ros.viz.drawing.canvas import save_png
from lsc_pose_ros.viz.report.contact_sheet import contact_sheet
from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame, has_joints
from lsc_pose_ros.viz.stages.shown_body import ShownBody, show_body
from lsc_pose_ros.viz.stages.stage_sheet import stage_sheet, write_stages

HELP = """Draw frames of a recording on one sheet: depth, silhouette points, estimated and true
skeletons; or, with --stages, the results of each stage of the method for one frame."""

DEFAULT_FRAMES = 12
_MOST_FRAMES = 200  # a larger sheet takes long to draw, and its panels are too small
_SUFFIX = '.png'


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments to `parser`."""
    parser.add_argument(
        'recording',
        type=Path,
        metavar='RECORDING',
        help='an .mcap or .db3 file, or a bag folder',
    )
    parser.add_argument(
        '-o',
        '--output',
        type=Path,
        required=True,
        metavar='OUT',
        help='OUT.png; with --stages alternatively a folder, for one figure per stage',
    )
    which = parser.add_mutually_exclusive_group()
    which.add_argument(
        '--frames',
        type=positive_int,
        default=DEFAULT_FRAMES,
        metavar='N',
        help='draw N frames, spread evenly over the recording, or over its frames with skeletons '
        '(default: %(default)s)',
    )
    which.add_argument(
        '--at', type=_frame_number, nargs='+', metavar='FRAME', help='draw these, counted from 0'
    )
    which.add_argument(
        '--stages', type=_frame_number, metavar='FRAME', help='draw all stages of this frame'
    )
    parser.add_argument(
        '--body',
        type=int,
        metavar='NUMBER',
        help='with --stages: the body to draw (default: the one that covers the most pixels)',
    )
    _add_skeleton_arguments(parser.add_argument_group('what is estimated'))
    add_topic_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Draw the frames; return the exit status.

    Raises:
        InputError: the recording, the model or the output cannot be used.
    """
    _check(arguments)
    need_mask = bool(arguments.model) or arguments.stages is not None
    reader = open_frames(arguments.recording, arguments, need_mask=need_mask)
    estimator = None
    if arguments.model or (_has_default_model() and _needs_model(arguments, reader)):
        estimator = Estimator(load_model(find_model(arguments.model)), graph=arguments.graph)
    if arguments.stages is not None:
        _draw_stages(arguments, reader, estimator)
    else:
        _draw_sheet(arguments, reader, estimator)
    return 0


def _add_skeleton_arguments(group: argparse._ArgumentGroup) -> None:
    source = group.add_mutually_exclusive_group()
    add_setting_options(
        source,
        'model',
        note='used with --stages, or if the recording has no skeletons, not even ground truth',
    )
    source.add_argument(
        '--skeletons-topic',
        default='',
        metavar='TOPIC',
        help='draw the skeletons that the recording holds there (default: without --model, those '
        'of a topic called skeletons)',
    )
    add_setting_options(group, 'graph')


def _has_default_model() -> bool:
    return DEFAULT_MODEL in shipped_models()


def _needs_model(arguments: argparse.Namespace, reader: FrameReader) -> bool:
    """Return whether the figures need estimates that the recording does not contain."""
    if arguments.stages is not None:
        return True
    shows_bodies = reader.topics.mask or arguments.segmentation != MASK
    if arguments.skeletons_topic or reader.topics.ground_truth or not shows_bodies:
        return False
    return not find_skeletons_topic(read_messages(arguments.recording), '', '')


def _frame_number(word: str) -> int:
    try:
        number = int(word)
    except ValueError:
        number = -1
    if number < 0:
        msg = f'{word!r} is not a frame number; frames are counted from 0'
        raise argparse.ArgumentTypeError(msg)
    return number


def _check(arguments: argparse.Namespace) -> None:
    """Check the arguments before the frames are read."""
    output: Path = arguments.output
    if arguments.stages is None and not _is_picture(output):
        msg = f'{output}: the sheet is a PNG file; its name must end in {_SUFFIX}'
        raise InputError(msg)
    if _is_picture(output):
        check_outputs([Output(output, PNG)], [arguments.recording])
    else:
        outputs_in(output)
    count = len(arguments.at or ()) or arguments.frames
    if count > _MOST_FRAMES:
        msg = f'{count} frames are too many for one sheet; the limit is {_MOST_FRAMES}'
        raise InputError(msg)
    if arguments.body is not None and arguments.stages is None:
        msg = '--body needs --stages; a sheet of frames shows all bodies'
        raise InputError(msg)


def _is_picture(output: Path) -> bool:
    return output.suffix == _SUFFIX or is_written_through(output)


def _draw_sheet(
    arguments: argparse.Namespace, reader: FrameReader, estimator: Estimator | None
) -> None:
    if estimator is None:
        recording, topic = _recorded_topic(arguments, reader)
        chosen = _choose(arguments, reader, _shows_joints(recording, topic, reader))
        stamps = {frame.stamp for _, frame in chosen}
        recorded = read_skeletons_at(recording, topic, stamps) if topic else {}
        skeletons = {
            number: recorded[frame.stamp] for number, frame in chosen if frame.stamp in recorded
        }
        settings = Settings()
    else:
        chosen = _choose(arguments, reader, None)
        skeletons = _estimated(estimator, chosen)
        settings = estimator.model.settings
    drawn = [
        DrawnFrame(f'frame {number}', frame, skeletons.get(number), settings)
        for number, frame in chosen
    ]
    save_png(contact_sheet(drawn, arguments.recording.name), arguments.output)
    count = sum(has_joints(each) for each in drawn)
    print(f'{arguments.output}: {len(drawn)} frames, {count} of them with joints')


def _estimated(estimator: Estimator, chosen: Sequence[NumberedFrame]) -> dict[int, Skeletons]:
    """Return the skeletons of each chosen frame, by its number."""
    return {
        number: estimator.estimate(frame.depth, frame.labels, frame.camera)
        for number, frame in chosen
    }


def _recorded_topic(
    arguments: argparse.Namespace, reader: FrameReader
) -> tuple[RecordingReader, str]:
    """Return the messages of the recording, and the topic of its skeletons, '' for none."""
    recording = read_messages(arguments.recording)
    truth = reader.topics.ground_truth
    return recording, find_skeletons_topic(recording, arguments.skeletons_topic, truth)


def _shows_joints(
    recording: RecordingReader, topic: str, reader: FrameReader
) -> Callable[[Frame], bool] | None:
    """Return what tells whether a frame has skeletons; None if no frame has any."""
    if not topic and not reader.topics.ground_truth:
        return None
    stamps = stamps_with_joints(recording, topic) if topic else set()

    def shows_joints(frame: Frame) -> bool:
        truth = frame.ground_truth
        return frame.stamp in stamps or (truth is not None and known_bodies(truth) > 0)

    return shows_joints


def _choose(
    arguments: argparse.Namespace, reader: FrameReader, suitable: Callable[[Frame], bool] | None
) -> list[NumberedFrame]:
    """Return the frames to draw: if any is suitable, only those are, except for --at."""
    chosen: list[NumberedFrame] = []
    if arguments.at:
        total = max(arguments.at) + 1
        frames = progress(reader, total, 'reading')
        chosen = pick(frames, arguments.at, str(arguments.recording))
    elif suitable is not None:
        chosen = spread(progress(reader, reader.count, 'reading'), arguments.frames, suitable)
    if not chosen:
        chosen = spread(progress(reader, reader.count, 'reading'), arguments.frames)
    _warn(reader)
    return chosen


def _draw_stages(
    arguments: argparse.Namespace, reader: FrameReader, estimator: Estimator | None
) -> None:
    number = arguments.stages
    frames = progress(reader, number + 1, 'reading')
    frame = pick(frames, [number], str(arguments.recording))[0].frame
    _warn(reader)
    model = estimator.model if estimator is not None else None
    shown = show_body(f'frame {number}', frame, arguments.body, model)
    _save_stages(arguments.output, shown)


def _save_stages(output: Path, shown: ShownBody) -> None:
    if _is_picture(output):
        save_png(stage_sheet(shown), output)
        print(output)
        return
    for path in write_stages(output, shown):
        print(path)


def _warn(reader: FrameReader) -> None:
    for warning in reader.warnings:
        warn(warning)
