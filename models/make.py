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

# ruff: noqa: INP001, T201 - a program, not a package
"""Train and evaluate a model of the package: `make model`.

The program generates the recordings of `people.py`, trains the model, and evaluates it on other
recordings with other bodies and other motions. Existing files are reused, so the program can be
interrupted and started again: the name of a recording depends on its settings, that of the model
on its recordings.

    python models/make.py default --mocap CLIPS --real test.mcap --offsets-from others.mcap
"""

import argparse
import datetime as dt
import hashlib
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from card import (
    DISTANCES,
    YAWS,
    EvaluatedPeople,
    binned,
    by_recording,
    by_visibility,
    join,
    joint_scores,
    measure,
    real_scores,
    score,
    write_card,
    write_tables,
)
from people import RECIPES, MocapSplit, RecordingSpec, find_mocap, generate

from lsc_pose_ros.bags import open_recording
from lsc_pose_ros.cli import main as command_line
from lsc_pose_ros.cli.input.labelled_frames import read_frames
from lsc_pose_ros.cli.output.json_file import write_json
from lsc_pose_ros.cli.program import INTERRUPTED
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.model_io.model_file import MODEL, load_model
from lsc_pose_ros.pose.estimator import Estimator

HERE = Path(__file__).resolve().parent

COMMON_TRAIN_OPTIONS = (
    '--feature', 'mixed', '--split-features', '48', '--candidates', '3', '--seed', '0',
    '--joint-reach', '0.5', '--joint-fraction', '0.2333', '--vote-bandwidth', '0.15',
    '--fewest-neighbours', '3', '--fill-holes', '5', '--noise-factor', '4',
    '--least-cut-scale', '0.62',
    '--joints', *JOINT_NAMES,
)  # fmt: skip
"""Options of `lsc_pose train` for all models."""


MAX_BYTES = 20_000_000
"""The largest size of a model of the package, bytes."""


class ModelFiles(NamedTuple):
    """The files that a model was made from, and its own."""

    training: list[Path]
    calibration: list[Path]
    model: Path


def main(words: Sequence[str] | None = None) -> int:
    """Make the model that `words` name and return the exit status."""
    arguments = _parser().parse_args(words)
    try:
        for folder in (arguments.directory, arguments.target):
            folder.mkdir(parents=True, exist_ok=True)
        mocap = MocapSplit()
        if arguments.mocap:
            mocap = find_mocap(arguments.mocap, arguments.mapping)
        files = make(arguments, mocap)
        results = measure_model(arguments, files.model, mocap)
        publish(arguments, files, results)
    except InputError as error:
        sys.stderr.write(f'make: error: {error}\n')
        return command_line.BAD_INPUT
    except KeyboardInterrupt:
        return INTERRUPTED
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog='models/make.py', description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument('name', nargs='?', choices=list(RECIPES), default='default')
    for option, default, what in (
        (
            '--directory',
            HERE.parent / 'build' / 'model',
            'folder of the recordings and intermediate models (default: %(default)s)',
        ),
        ('--target', HERE, 'folder of the finished model and its figures (default: %(default)s)'),
        ('--mocap', None, 'folder of motion capture (BVH) for half of the people'),
        ('--mapping', None, 'mapping file of the joints of the motion capture'),
    ):
        parser.add_argument(option, type=Path, default=default, metavar='PATH', help=what)
    parser.add_argument(
        '--scale',
        type=float,
        default=1.0,
        metavar='FRACTION',
        help='generate only this fraction of all frames, for a trial',
    )
    parser.add_argument(
        '--memory',
        type=float,
        metavar='GIB',
        help='memory of the training; with less, fewer points per person are used',
    )
    for option, what in (
        ('--real', 'also evaluate on these labelled recordings'),
        ('--offsets-from', 'fit constant offsets for --real on these recordings'),
    ):
        parser.add_argument(
            option, type=Path, nargs='+', default=[], metavar='RECORDING', help=what
        )
    return parser


def make(arguments: argparse.Namespace, mocap: MocapSplit) -> ModelFiles:
    """Generate the recordings and train the model.

    Raises:
        InputError: a recording cannot be generated.
        SystemExit: the training failed.
    """
    recipe, folder = RECIPES[arguments.name], arguments.directory
    training = generate(_scaled(recipe.training, arguments), mocap, folder, test=False)
    others = generate(_scaled(recipe.calibration, arguments), mocap, folder, test=False)
    train_options = _train_options(arguments)
    digest = hashlib.sha256(
        repr([train_options, [path.name for path in [*training, *others]]]).encode()
    ).hexdigest()[:8]
    model = folder / f'{arguments.name}_{digest}.npz'
    if not model.exists():
        paths = [str(path) for path in training]
        calibration = ['--calibrate', *map(str, others)]
        status = command_line.main(
            ['train', *paths, '-o', str(model), *train_options, *calibration]
        )
        if status:
            raise SystemExit(status)
    return ModelFiles(training, others, model)


def _train_options(arguments: argparse.Namespace) -> list[str]:
    recipe = RECIPES[arguments.name]
    return [
        *COMMON_TRAIN_OPTIONS,
        *recipe.train_options,
        '--memory',
        str(arguments.memory or recipe.memory),
    ]


def measure_model(arguments: argparse.Namespace, model: Path, mocap: MocapSplit) -> dict[str, Any]:
    """Return all figures of the model's card.

    Raises:
        InputError: a recording cannot be generated or read.
    """
    recipe, folder = RECIPES[arguments.name], arguments.directory
    estimator = Estimator(load_model(model))
    own = _measure(estimator, _scaled(recipe.tests, arguments), mocap, folder)
    others = _measure(estimator, _scaled(recipe.others, arguments), mocap, folder)
    everybody = join([*own, *others])
    all_views = join(own)
    real = [_read(estimator, path.stem, path) for path in arguments.real]
    fitted = [_read(estimator, path.stem, path) for path in arguments.offsets_from]
    return {
        'all': {'all views and sensors': score(all_views.evaluation)},
        'views': binned(all_views, all_views.yaw, YAWS),
        'distances': binned(all_views, all_views.distance, DISTANCES),
        'recordings': by_recording(everybody),
        'hidden': by_visibility(join(others)) if others else {},
        'real': real_scores(join(real), join(fitted) if fitted else None) if real else {},
        'joints': joint_scores(all_views.evaluation),
    }


def _measure(
    estimator: Estimator, specs: Sequence[RecordingSpec], mocap: MocapSplit, folder: Path
) -> list[EvaluatedPeople]:
    paths = generate(specs, mocap, folder, test=True)
    return [_read(estimator, spec.name, path) for spec, path in zip(specs, paths, strict=True)]


def _read(estimator: Estimator, name: str, path: Path) -> EvaluatedPeople:
    return measure(estimator, name, read_frames([open_recording(path)], name))


def publish(arguments: argparse.Namespace, files: ModelFiles, results: dict[str, Any]) -> None:
    """Write the model, its figures and its card.

    Raises:
        InputError: the model is too large for the package.
    """
    if files.model.stat().st_size > MAX_BYTES:
        msg = (
            f'{files.model} is larger than {MAX_BYTES / 1e6:g} MB; '
            'give its recipe more --leaf-samples'
        )
        raise InputError(msg)
    target = arguments.target / f'{arguments.name}.npz'
    write_output(target, MODEL, files.model.read_bytes())
    metadata: dict[str, Any] = {
        'model': target.name,
        'date': dt.datetime.now(dt.timezone.utc).date().isoformat(),
        'bytes': target.stat().st_size,
        'sha256': hashlib.sha256(target.read_bytes()).hexdigest(),
        'training': [path.name for path in files.training],
        'calibration': [path.name for path in files.calibration],
        'train_options': _train_options(arguments),
        'mocap': bool(arguments.mocap),
    }
    write_json(target.with_suffix('.json'), metadata | results)
    page = arguments.target / 'README.md'
    if page.exists():
        write_card(results, arguments.name, page)
    print(write_tables(results))
    print(json.dumps(metadata, indent=1))


def _scaled(specs: Sequence[RecordingSpec], arguments: argparse.Namespace) -> list[RecordingSpec]:
    return [
        spec._replace(
            settings=spec.settings._replace(
                frames=max(1, round(arguments.scale * spec.settings.frames))
            )
        )
        for spec in specs
    ]


if __name__ == '__main__':
    sys.exit(main())
