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

"""`lsc_pose train`: learns a model from labelled recordings."""

import argparse
import itertools
import time
from contextlib import nullcontext
from pathlib import Path

from lsc_pose_ros import __version__
from lsc_pose_ros.bags import FrameReader
from lsc_pose_ros.cli.input.labelled_frames import (
    add_recording_arguments,
    open_recordings,
    read_frames,
)
from lsc_pose_ros.cli.options.settings_file import add_settings_file_option
from lsc_pose_ros.cli.options.training_options import (
    DEPTH_OPTIONS,
    FOREST_OPTIONS,
    HOLD_OUT_OPTION,
    LEAF_OPTIONS,
    add_memory_option,
    add_training_options,
    all_settings,
    training_settings,
)
from lsc_pose_ros.cli.output.json_file import write_json
from lsc_pose_ros.cli.output.machine import utc_date, versions
from lsc_pose_ros.cli.output.progress import REPORTER, warn
from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import JSON
from lsc_pose_ros.files.output_check import Output, check_outputs
from lsc_pose_ros.files.output_place import is_written_through
from lsc_pose_ros.model_io.model_file import MODEL, save_model
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.training.calibration import calibrate
from lsc_pose_ros.training.checkpoint_file import CHECKPOINT, CheckpointFile, checkpoint_path
from lsc_pose_ros.training.samples import labelled_people
from lsc_pose_ros.training.train import TrainingSettings, train

HELP = 'learn a model from labelled recordings'


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command to `parser`."""
    add_recording_arguments(parser)
    parser.add_argument(
        '-o',
        '--output',
        type=Path,
        required=True,
        metavar='MODEL',
        help='the model file to write, such as me.npz',
    )
    add_training_options(parser, (*FOREST_OPTIONS, *LEAF_OPTIONS, *DEPTH_OPTIONS))
    parser.add_argument(
        '--mirror',
        action='store_true',
        help='use each frame a second time, mirrored, with left and right exchanged; takes twice '
        'the time and memory',
    )
    parser.add_argument(
        '--body-yaw',
        action='store_true',
        help='make the body yaw an input of the forest, and estimate it by trying several; for '
        'people who may turn their backs to the camera',
    )
    parser.add_argument(
        '--joints',
        nargs='+',
        default=list(DEFAULT_JOINTS),
        metavar='JOINT',
        help="the joints to learn (default: the paper's 17: all except pelvis and feet)",
    )
    add_settings_file_option(parser)
    add_memory_option(parser)
    calibration = parser.add_mutually_exclusive_group()
    add_training_options(calibration, [HOLD_OUT_OPTION])
    calibration.add_argument(
        '--calibrate',
        type=Path,
        nargs='+',
        metavar='RECORDING',
        help='train on all people, and calibrate confidence on other labelled recordings, '
        'preferably of people who are not in the training recordings',
    )
    parser.add_argument(
        '--seed', type=int, default=0, help='seed of all random numbers (default: %(default)s)'
    )
    parser.add_argument(
        '--resume',
        action='store_true',
        help='go on from the trees that an interrupted training of the same MODEL, recordings and '
        'settings has left in MODEL.checkpoint; the forest is the same as without interruption. '
        'Without --resume, such a file is an error, so that nothing is lost',
    )
    parser.add_argument('--json', type=Path, metavar='FILE', help='write sizes and times to FILE')


def run(arguments: argparse.Namespace) -> int:
    """Train the model that `arguments` ask for; return the exit status.

    Raises:
        InputError: a recording, a joint or the output cannot be used.
    """
    training = training_settings(arguments)
    _check_outputs(arguments)
    with _checkpoint(arguments) as checkpoint:
        readers = open_recordings(arguments)
        others = _open_calibration_recordings(arguments, training)
        begin = time.perf_counter()
        provenance = _provenance(arguments, training)
        frames = read_frames(readers, 'reading')
        model = train(frames, training, provenance, REPORTER.step, checkpoint)
        if others:
            frames = read_frames(others, 'calibrating')
            people = labelled_people(frames, training.joints, training.settings)
            model = calibrate(model, people)
        size = _save(arguments.output, model, checkpoint)
    results = _results(arguments, model, time.perf_counter() - begin) | {'bytes': size}
    print(
        f'{arguments.output}: {results["people"]} labelled bodies in all frames, '
        f'{len(model.forest.roots)} trees, {results["leaves"]} leaves, {size / 1e6:.1f} MB, '
        f'{results["seconds"]:.0f} s'
    )
    if arguments.json:
        write_json(arguments.json, results)
    return 0


def _save(output: Path, model: Model, checkpoint: CheckpointFile | None) -> int:
    """Write the model, remove the checkpoint, and return the size of the model, bytes."""
    try:
        size = save_model(output, model)
    except InputError as error:
        kept = checkpoint_path(output)
        if checkpoint is None or not kept.is_file():
            raise
        msg = f'{error}; the finished trees are in {kept}, with which --resume goes on'
        raise InputError(msg) from error
    if checkpoint:
        checkpoint.remove()
    return size


def _checkpoint(
    arguments: argparse.Namespace,
) -> CheckpointFile | nullcontext[None]:
    """Return the checkpoint beside the model; a context without one if the model is no file."""
    if is_written_through(arguments.output):
        return nullcontext()
    return CheckpointFile(
        checkpoint_path(arguments.output),
        _program(),
        resume=arguments.resume,
        tell=REPORTER.tell,
        warn=warn,
    )


def _program() -> str:
    return f'lsc_pose_ros {__version__}'


def _provenance(arguments: argparse.Namespace, training: TrainingSettings) -> dict[str, str]:
    return {
        'recordings': ', '.join(path.name for path in arguments.recordings),
        'program': _program(),
        'packages': ', '.join(f'{name} {version}' for name, version in versions().items()),
        'date': utc_date(),
        'seed': str(training.seed),
        'mirrored': 'yes' if training.mirror else 'no',
        'training settings': all_settings(arguments),
    }


def _results(arguments: argparse.Namespace, model: Model, seconds: float) -> dict[str, object]:
    return {
        'model': str(arguments.output),
        'recordings': [str(path) for path in arguments.recordings],
        'people': int(model.provenance['people']),
        'points': int(model.provenance['samples']),
        'calibrated': len(model.calibration) > 0,
        'leaves': len(model.forest.joint_votes.start) - 1,
        'seconds': seconds,
    }


def _open_calibration_recordings(
    arguments: argparse.Namespace, training: TrainingSettings
) -> list[FrameReader]:
    """Open the recordings of --calibrate, and check before the training that they can be used."""
    if not arguments.calibrate:
        return []
    readers = open_recordings(arguments, arguments.calibrate)
    frames = itertools.chain.from_iterable(readers)
    if not any(True for _ in labelled_people(frames, training.joints, training.settings)):
        names = ', '.join(str(path) for path in arguments.calibrate)
        msg = (
            f'--calibrate {names}: no labelled person was found; the body numbers of the ground '
            'truth must be those of the mask'
        )
        raise InputError(msg)
    return readers


def _check_outputs(arguments: argparse.Namespace) -> None:
    """Check before the training that the model and its figures can be written.

    Raises:
        InputError: one of them cannot.
    """
    outputs = [Output(arguments.output, MODEL)]
    if not is_written_through(arguments.output):
        outputs.append(Output(checkpoint_path(arguments.output), CHECKPOINT))
    elif arguments.resume:
        msg = f'--resume: {arguments.output} is no file, so nothing is kept beside it'
        raise InputError(msg)
    if arguments.json:
        outputs.append(Output(arguments.json, JSON))
    check_outputs(outputs, [*arguments.recordings, *(arguments.calibrate or [])])
