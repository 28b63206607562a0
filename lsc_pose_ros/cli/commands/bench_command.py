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

"""`lsc_pose bench`: time each stage of the method."""

import argparse
import sys
from pathlib import Path

from lsc_pose_ros.cli.input.labelled_frames import read_frames
from lsc_pose_ros.cli.options.frame_selection import spread
from lsc_pose_ros.cli.options.image_size import image_size
from lsc_pose_ros.cli.options.numbers import positive_int
from lsc_pose_ros.cli.options.setting_options import add_setting_options
from lsc_pose_ros.cli.options.topic_options import add_topic_arguments, open_frames
from lsc_pose_ros.cli.output.bench_results import bench_results, bench_table
from lsc_pose_ros.cli.output.json_file import write_json
from lsc_pose_ros.cli.output.progress import progress
from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation.benchmark import time_frames, warm_up
from lsc_pose_ros.evaluation.encoded_frame import EncodedFrame, encode_frame
from lsc_pose_ros.files.kinds import JSON
from lsc_pose_ros.files.output_check import Output, check_outputs
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.resources.package_files import DEFAULT_MODEL, find_model, shipped_models
from lsc_pose_ros.synthetic.generator import synthetic_frames
from lsc_pose_ros.synthetic.settings import SyntheticSettings, sensor_of
from lsc_pose_ros.training.train import TrainingSettings, train

HELP = 'time each stage of the method'

TRAINING = SyntheticSettings(frames=300, seed=1, clip_length=3)
"""The frames that a small model is trained on if none is installed."""

TIMED = SyntheticSettings(frames=60, seed=2, clip_length=2)
"""The frames that are timed without a recording: other people, two frames each."""

_SENSOR = sensor_of(TIMED)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments to `parser`."""
    parser.add_argument(
        'recording',
        type=Path,
        nargs='?',
        metavar='RECORDING',
        help='frames to time: an .mcap or .db3 file, or a bag folder (default: synthetic people)',
    )
    add_setting_options(
        parser,
        'model',
        note='if the package has none, a small one is trained on synthetic people',
    )
    parser.add_argument(
        '--frames',
        type=positive_int,
        default=TIMED.frames,
        metavar='N',
        help='how many frames to time, spread evenly over a recording (default: %(default)s)',
    )
    parser.add_argument(
        '--size',
        type=image_size,
        metavar='WIDTHxHEIGHT',
        help=f'size of the synthetic images (default: {_SENSOR.width}x{_SENSOR.height})',
    )
    parser.add_argument(
        '--people',
        type=positive_int,
        metavar='N',
        help=f'people in each synthetic image (default: {TIMED.people})',
    )
    parser.add_argument(
        '--points',
        type=positive_int,
        metavar='N',
        help="silhouette points of a body (default: the model's)",
    )
    parser.add_argument(
        '--query-points',
        type=positive_int,
        metavar='Q',
        help="how many of them vote (default: the model's)",
    )
    parser.add_argument('--json', type=Path, metavar='FILE', help='write the results there')
    add_topic_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Time the frames and print a table; return the exit status.

    Raises:
        InputError: the recording or the model cannot be used, or the frames show nobody.
    """
    _check(arguments)
    if arguments.json:
        inputs = [arguments.recording, arguments.model and find_model(arguments.model)]
        check_outputs([Output(arguments.json, JSON)], filter(None, inputs))
    frames = _recorded(arguments) if arguments.recording else _synthetic(arguments)
    model, origin = _model(arguments)
    estimator = Estimator(model._replace(settings=_settings(model.settings, arguments)))
    valid = warm_up(estimator, frames)
    if len(valid) < len(frames):
        count = f'{len(frames) - len(valid)} of {len(frames)}'
        _print_note(f'{count} frames show too little of a person and are left out')
    times = list(progress(time_frames(estimator, valid), len(valid), 'timing'))
    results = bench_results(estimator.model, valid, times)
    results |= {'model': origin, 'recording': str(arguments.recording or 'synthetic')}
    print(bench_table(results))
    if arguments.json:
        write_json(arguments.json, results)
    return 0


def _check(arguments: argparse.Namespace) -> None:
    if arguments.recording and (arguments.size or arguments.people):
        msg = (
            f'--size and --people are for synthetic frames; '
            f'omit them, or omit {arguments.recording}'
        )
        raise InputError(msg)


def _recorded(arguments: argparse.Namespace) -> list[EncodedFrame]:
    reader = open_frames(arguments.recording, arguments)
    frames = spread(read_frames([reader], 'reading'), arguments.frames)
    return [encode_frame(numbered.frame) for numbered in frames]


def _synthetic(arguments: argparse.Namespace) -> list[EncodedFrame]:
    width, height = arguments.size or (_SENSOR.width, _SENSOR.height)
    settings = TIMED._replace(
        frames=arguments.frames,
        people=arguments.people or TIMED.people,
        width=width,
        height=height,
    )
    frames = progress(synthetic_frames(settings), settings.frames, 'generating')
    return [encode_frame(frame) for frame in frames]


def _model(arguments: argparse.Namespace) -> tuple[Model, str]:
    """Return the model and its origin."""
    if not arguments.model and DEFAULT_MODEL not in shipped_models():
        return _trained(arguments)
    path = find_model(arguments.model)
    return load_model(path), str(path)


def _trained(arguments: argparse.Namespace) -> tuple[Model, str]:
    origin = f'trained in this run on {TRAINING.frames} synthetic frames'
    _print_note(f'no --model is given and none is installed; a small model is {origin}')
    points = arguments.points or Settings().points
    training = TrainingSettings(numbers_of(DEFAULT_JOINTS), Settings(points=points))
    frames = progress(synthetic_frames(TRAINING), TRAINING.frames, 'describing')
    return train(frames, training, {'recordings': 'synthetic'}), origin


def _settings(settings: Settings, arguments: argparse.Namespace) -> Settings:
    """Return the settings of the model, overridden by those of the command line."""
    points = arguments.points or settings.points
    queries = arguments.query_points or min(settings.query_points, points)
    if queries > points:
        msg = f'--query-points {queries} of {points} points is too large; the limit is {points}'
        raise InputError(msg)
    return settings._replace(points=points, query_points=queries)


def _print_note(sentence: str) -> None:
    print(f'lsc_pose: {sentence}', file=sys.stderr)
