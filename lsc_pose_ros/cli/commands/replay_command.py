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

"""`lsc_pose replay`: estimates the joints in a recording, or publishes the recording."""

import argparse
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lsc_pose_ros.bags import FrameReader, RecordingWriter, read_messages
from lsc_pose_ros.bags.estimated_copy import write_estimated_copy
from lsc_pose_ros.bags.storage.writer import RECORDING
from lsc_pose_ros.cli.options.estimation_options import (
    add_estimation_options,
    temporal_estimator_from,
)
from lsc_pose_ros.cli.options.numbers import positive_float
from lsc_pose_ros.cli.options.setting_options import settings_from
from lsc_pose_ros.cli.options.topic_options import add_topic_arguments, open_frames
from lsc_pose_ros.cli.output.progress import progress, warn
from lsc_pose_ros.cli.output.terminal_text import line_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.output_check import Output, check_outputs
from lsc_pose_ros.resources.package_files import find_model
from lsc_pose_ros.ros.requirements import load_with_ros
from lsc_pose_ros.settings.setting import settings_of
from lsc_pose_ros.settings.table import (
    AUTO,
    BACKGROUND,
    PEOPLE,
    DrawingSettings,
    ModelSettings,
    TemporalSettings,
)

if TYPE_CHECKING:
    from lsc_pose_ros.ros.playback.player import Player  # needs rclpy, which only --publish loads

HELP = """Estimate the joints in each frame of a recording, as fast as possible, and write them
to a new recording together with the messages of the frames; or, with --publish, publish the
messages of the recording over ROS 2, unchanged, for a live node."""

TERMINATED = 143  # 128 + SIGTERM, as shells report it

# Without --wait-for: the longest time to wait for subscribers before it starts, seconds.
_PATIENCE = 3.0


# The options that only estimate, and those that only publish with their defaults.
_ESTIMATION_GROUPS = (ModelSettings, TemporalSettings, DrawingSettings)
_PUBLISHING: dict[str, object] = {
    'rate': 1.0,
    'clock': False,
    'loop': False,
    'wait_for': None,
    'remap': [],
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments to `parser`."""
    parser.add_argument(
        'recording',
        type=Path,
        metavar='RECORDING',
        help='an .mcap or .db3 file, or a bag folder',
    )
    purpose = parser.add_mutually_exclusive_group(required=True)
    purpose.add_argument(
        '-o', '--output', type=Path, metavar='OUT', help='estimate, and write to OUT.mcap'
    )
    purpose.add_argument('--publish', action='store_true', help='publish over ROS 2')
    add_estimation_options(
        parser.add_argument_group('with -o', 'The parameters of pose_node have the same names.')
    )
    _add_publish_arguments(parser.add_argument_group('with --publish'))
    add_topic_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Do what `arguments` ask for; return the exit status.

    Raises:
        InputError: the recording, the model or the output cannot be used, or ROS 2 is missing.
    """
    _refuse_useless_options(arguments)
    if arguments.output:
        inputs = [arguments.recording, arguments.model and find_model(arguments.model)]
        check_outputs([Output(arguments.output, RECORDING)], filter(None, inputs))
    reader = open_frames(arguments.recording, arguments, need_mask=not arguments.publish)
    if arguments.publish:
        return _publish(arguments, reader)
    return _answer(arguments, reader)


def _refuse_useless_options(arguments: argparse.Namespace) -> None:
    """Check that no option is given that has no effect.

    Raises:
        InputError: there is one.
    """
    estimating = {
        name: setting.default
        for group in _ESTIMATION_GROUPS
        for name, setting in settings_of(group).items()
    }
    useless = estimating if arguments.publish else _PUBLISHING
    values = vars(arguments)
    for name, default in useless.items():
        if name in values and values[name] != default:
            option = f'--{name.replace("_", "-")}'
            purpose = '-o' if arguments.publish else '--publish'
            msg = f'{option} has no effect without {purpose}; omit it'
            raise InputError(msg)


def _add_publish_arguments(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        '--rate',
        type=positive_float,
        default=1.0,
        metavar='FACTOR',
        help='speed relative to the recorded speed (default: %(default)s)',
    )
    group.add_argument('--clock', action='store_true', help='publish the recorded time on /clock')
    group.add_argument('--loop', action='store_true', help='start again at the end, until stopped')
    group.add_argument(
        '--wait-for',
        type=positive_float,
        metavar='SECONDS',
        help='wait at most SECONDS for subscribers to depth images, camera infos and masks, and '
        f'fail if there are none (default: wait at most {_PATIENCE:g} s, then start anyway)',
    )
    group.add_argument(
        '--remap',
        nargs='+',
        type=_renaming,
        default=[],
        metavar='FROM:=TO',
        help='publish the topic FROM under the name TO',
    )


def _renaming(word: str) -> tuple[str, str]:
    before, mark, after = word.partition(':=')
    if not (before and mark and after):
        msg = f'{word!r} is not FROM:=TO'
        raise argparse.ArgumentTypeError(msg)
    return before, after


def _answer(arguments: argparse.Namespace, reader: FrameReader) -> int:
    output: Path = arguments.output
    writer = RecordingWriter(output)
    temporal_estimator = temporal_estimator_from(arguments)
    frames = bodies = 0
    with writer:
        drawing = settings_from(arguments, DrawingSettings)
        answers = write_estimated_copy(reader, temporal_estimator, writer, drawing)
        for skeletons in progress(answers, reader.count, 'estimating'):
            frames += 1
            bodies += len(skeletons.bodies)
        _warn(reader.warnings)
        if temporal_estimator.beyond_maximum:
            _warn([_too_many(temporal_estimator.beyond_maximum, arguments.maximum_bodies)])
        if not bodies:
            text = _nobody(arguments, reader, frames)
            if not _can_be_empty(arguments, reader):
                raise InputError(text)
            _warn([text])
    print(f'{output}: {frames} frames, {bodies} bodies')
    print(line_of(f'camera: {reader.camera}; {reader.roll}'))
    print(line_of(reader.bodies))
    return 0


def _can_be_empty(arguments: argparse.Namespace, reader: FrameReader) -> bool:
    """Return whether a recording that shows nobody is no sign of a wrong option."""
    return not reader.topics.mask and arguments.segmentation in (AUTO, PEOPLE)


def _too_many(beyond: int, most: int) -> str:
    return (
        f'{beyond} bodies are not estimated, because their frames show more than {most}, and '
        'larger ones; --maximum-bodies allows more'
    )


def _nobody(arguments: argparse.Namespace, reader: FrameReader, frames: int) -> str:
    """Say that a recording shows nobody."""
    if reader.topics.mask:
        return (
            f'{arguments.recording}: the masks of all {frames} frames are empty; '
            'is --mask-background right?'
        )
    question = 'are --range-min and --range-max right?'
    if arguments.segmentation == BACKGROUND:
        question = (
            f'were the first {arguments.background_seconds:g} s (--background-seconds) without '
            f'people, and {question}'
        )
    return (
        f'{arguments.recording}: nobody is found in {frames} frames ({reader.bodies}); {question}'
    )


def _publish(arguments: argparse.Namespace, reader: FrameReader) -> int:
    ros: Any = load_with_ros('lsc_pose_ros.ros.playback.player')
    recording = read_messages(arguments.recording)
    playback = ros.Playback(arguments.rate, arguments.clock, dict(arguments.remap))
    counts = [topic.count for topic in recording.topics.values()]
    total = None if None in counts else sum(filter(None, counts))
    with ros.open_player(recording, playback) as publishing:
        _warn(publishing.left_out)
        _wait(arguments, reader, publishing)
        reached_end = True
        while reached_end:
            reached_end = publishing.play(progress(recording, total, 'publishing'))
            if not arguments.loop:
                break
        if reached_end:
            publishing.finish()
    _warn(recording.warnings)
    print(f'{arguments.recording}: {publishing.published} messages published')
    return 0 if reached_end else TERMINATED


def _wait(arguments: argparse.Namespace, reader: FrameReader, publishing: 'Player') -> None:
    """Wait for the node.

    Raises:
        InputError: --wait-for is given, and the node is not there in time.
    """
    topics = [topic for topic in reader.topics[:3] if topic]
    seconds = arguments.wait_for
    found = publishing.wait_for_subscribers(topics, seconds or _PATIENCE)
    if not found and seconds is not None:
        renamed = dict(arguments.remap)
        names = ', '.join(renamed.get(topic, topic) for topic in topics)
        hint = f'; if it uses no mask, add --segmentation {PEOPLE}' if reader.topics.mask else ''
        msg = (
            f'no subscriber to {names} within {seconds:g} s; '
            f'start pose_node first, remapped to them{hint}'
        )
        raise InputError(msg)


def _warn(warnings: Iterable[str]) -> None:
    for warning in warnings:
        warn(warning)
