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
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from card import (
    DISTANCES,
    YAWS,
    People,
    binned,
    by_recording,
    join,
    joint_scores,
    measure,
    real_scores,
    score,
    write_card,
    write_tables,
)
from people import RECIPES, Mocap, Part, find_mocap, generate

from lsc_pose_ros.bags import open_recording
from lsc_pose_ros.cli import main as command_line
from lsc_pose_ros.cli.input.labelled_frames import read_frames
from lsc_pose_ros.cli.output.json_file import write_json
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator

HERE = Path(__file__).resolve().parent

TRAINING_WORDS = (
    '--feature', 'mixed', '--split-features', '48', '--candidates', '3', '--seed', '0',
    '--joint-reach', '0.5', '--joint-fraction', '0.2333', '--vote-bandwidth', '0.15',
    '--fewest-neighbours', '3', '--fill-holes', '5', '--noise-factor', '4',
    '--joints', *JOINT_NAMES,
)  # fmt: skip
"""Options of `lsc_pose train` for all models."""


LARGEST = 20_000_000
"""The largest size of a model of the package, bytes."""


class Made(NamedTuple):
    """The files that a model was made from, and its own."""

    training: list[Path]
    calibration: list[Path]
    model: Path


def main(words: Sequence[str] | None = None) -> int:
    """Make the model that `words` name and return the exit status."""
    arguments = _parser().parse_args(words)
    try:
        arguments.directory.mkdir(parents=True, exist_ok=True)
        mocap = Mocap()
        if arguments.mocap:
            mocap = find_mocap(arguments.mocap, arguments.mapping)
        made = make(arguments, mocap)
        results = measure_model(arguments, made.model, mocap)
        publish(arguments, made, results)
    except InputError as error:
        sys.stderr.write(f'make: error: {error}\n')
        return command_line.BAD_INPUT
    except KeyboardInterrupt:
        return command_line.INTERRUPTED
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog='models/make.py', description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument('name', nargs='?', choices=list(RECIPES), default='default')
    parser.add_argument(
        '--directory',
        type=Path,
        default=HERE.parent / 'build' / 'model',
        metavar='DIR',
        help='folder of the recordings and intermediate models (default: %(default)s)',
    )
    parser.add_argument(
        '--target',
        type=Path,
        default=HERE,
        metavar='DIR',
        help='folder of the finished model and its figures (default: %(default)s)',
    )
    parser.add_argument(
        '--mocap',
        type=Path,
        metavar='DIR',
        help='folder of motion capture (BVH) for half of the people',
    )
    parser.add_argument(
        '--mapping', type=Path, metavar='FILE', help='mapping of the joints of the motion capture'
    )
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


def make(arguments: argparse.Namespace, mocap: Mocap) -> Made:
    """Generate the recordings and train the model.

    Raises:
        InputError: a recording cannot be generated.
        SystemExit: the training failed.
    """
    recipe, folder = RECIPES[arguments.name], arguments.directory
    training = generate(_scaled(recipe.training, arguments), mocap, folder, test=False)
    others = generate(_scaled(recipe.calibration, arguments), mocap, folder, test=False)
    words = _words(arguments)
    digest = hashlib.sha256(
        repr([words, [path.name for path in [*training, *others]]]).encode()
    ).hexdigest()[:8]
    model = folder / f'{arguments.name}_{digest}.npz'
    if not model.exists():
        paths = [str(path) for path in training]
        calibration = ['--calibrate', *map(str, others)]
        status = command_line.main(['train', *paths, '-o', str(model), *words, *calibration])
        if status:
            raise SystemExit(status)
    return Made(training, others, model)


def _words(arguments: argparse.Namespace) -> list[str]:
    recipe = RECIPES[arguments.name]
    return [*TRAINING_WORDS, *recipe.words, '--memory', str(arguments.memory or recipe.memory)]


def measure_model(arguments: argparse.Namespace, model: Path, mocap: Mocap) -> dict[str, Any]:
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
        'real': real_scores(join(real), join(fitted) if fitted else None) if real else {},
        'joints': joint_scores(all_views.evaluation),
    }


def _measure(
    estimator: Estimator, parts: Sequence[Part], mocap: Mocap, folder: Path
) -> list[People]:
    paths = generate(parts, mocap, folder, test=True)
    return [_read(estimator, part.name, path) for part, path in zip(parts, paths, strict=True)]


def _read(estimator: Estimator, name: str, path: Path) -> People:
    return measure(estimator, name, read_frames([open_recording(path)], name))


def publish(arguments: argparse.Namespace, made: Made, results: dict[str, Any]) -> None:
    """Write the model, its figures and its card.

    Raises:
        InputError: the model is too large for the package.
    """
    if made.model.stat().st_size > LARGEST:
        msg = (
            f'{made.model} is larger than {LARGEST / 1e6:g} MB; '
            'give its recipe more --leaf-samples'
        )
        raise InputError(msg)
    target = arguments.target / f'{arguments.name}.npz'
    beside = target.with_suffix('.part')
    shutil.copyfile(made.model, beside)
    beside.replace(target)
    facts: dict[str, Any] = {
        'model': target.name,
        'date': dt.datetime.now(dt.timezone.utc).date().isoformat(),
        'bytes': target.stat().st_size,
        'sha256': hashlib.sha256(target.read_bytes()).hexdigest(),
        'training': [path.name for path in made.training],
        'calibration': [path.name for path in made.calibration],
        'words': _words(arguments),
        'mocap': bool(arguments.mocap),
    }
    write_json(target.with_suffix('.json'), facts | results)
    page = arguments.target / 'README.md'
    if page.exists():
        write_card(results, arguments.name, page)
    print(write_tables(results))
    print(json.dumps(facts, indent=1))


def _scaled(parts: Sequence[Part], arguments: argparse.Namespace) -> list[Part]:
    return [
        part._replace(
            settings=part.settings._replace(
                frames=max(1, round(arguments.scale * part.settings.frames))
            )
        )
        for part in parts
    ]


if __name__ == '__main__':
    sys.exit(main())
