"""`lsc_pose train`: labelled recordings become a model."""

import argparse
import sys
import time
from pathlib import Path

from lsc_pose_ros import __version__
from lsc_pose_ros.cli.json_file import write_json
from lsc_pose_ros.cli.labelled_frames import (
    add_recording_arguments,
    open_recordings,
    read_frames,
)
from lsc_pose_ros.cli.numbers import positive_float, positive_int
from lsc_pose_ros.core.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.core.settings import Settings
from lsc_pose_ros.data.model_file import save_model
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.learning.growth import GrowthSettings
from lsc_pose_ros.learning.train import GIBIBYTE, TrainingSettings, train

HELP = 'learn a model from labelled recordings'


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments to `parser`."""
    add_recording_arguments(parser)
    parser.add_argument(
        '-o', '--output', type=Path, required=True, metavar='MODEL', help='the model, e.g. me.npz'
    )
    defaults, growth = Settings(), GrowthSettings()
    for name, default, what in (
        ('points', defaults.points, 'silhouette points a body'),
        ('query-points', defaults.query_points, 'of these, how many vote (all of them teach)'),
        ('trees', TrainingSettings(numbers_of(DEFAULT_JOINTS)).trees, 'trees of the forest'),
        ('depth', growth.depth, 'depth of a tree at most'),
        ('leaf-samples', growth.leaf_samples, 'samples of a leaf at least'),
    ):
        parser.add_argument(
            f'--{name}',
            type=positive_int,
            default=default,
            metavar='N',
            help=f'{what} (default: %(default)s)',
        )
    parser.add_argument(
        '--joints',
        nargs='+',
        default=list(DEFAULT_JOINTS),
        metavar='JOINT',
        help="the joints to learn (default: the paper's 17: all but pelvis and feet)",
    )
    parser.add_argument(
        '--memory',
        type=positive_float,
        default=8.0,
        metavar='GIB',
        help='take no more than so much, in GiB: of longer recordings, learn from fewer points a '
        'person (default: %(default)s)',
    )
    parser.add_argument('--seed', type=int, default=0, help='of all that is drawn (default: 0)')
    parser.add_argument('--json', type=Path, metavar='FILE', help='write sizes and times there')


def run(arguments: argparse.Namespace) -> int:
    """Train the model that `arguments` ask for; return the exit status.

    Raises:
        InputError: a recording, a joint or the output cannot be used.
    """
    training = _training_settings(arguments)
    _check_writable(arguments.output)
    readers = open_recordings(arguments)
    provenance = {
        'recordings': ', '.join(path.name for path in arguments.recordings),
        'program': f'lsc_pose_ros {__version__}',
        'seed': str(training.seed),
    }
    begin = time.perf_counter()
    model = train(read_frames(readers, 'describing'), training, provenance, _tell)
    save_model(arguments.output, model)
    seconds = time.perf_counter() - begin
    results: dict[str, object] = {
        'model': str(arguments.output),
        'recordings': [str(path) for path in arguments.recordings],
        'people': int(model.provenance['people']),
        'points': int(model.provenance['samples']),
        'leaves': len(model.forest.joint_votes.start) - 1,
        'bytes': arguments.output.stat().st_size,
        'seconds': seconds,
    }
    print(
        f'{arguments.output}: {results["people"]} people, {len(model.forest.roots)} trees, '
        f'{results["leaves"]} leaves, {arguments.output.stat().st_size / 1e6:.1f} MB, '
        f'{seconds:.0f} s'
    )
    if arguments.json:
        write_json(arguments.json, results)
    return 0


def _training_settings(arguments: argparse.Namespace) -> TrainingSettings:
    if arguments.seed < 0:
        msg = f'--seed {arguments.seed} must not be negative'
        raise InputError(msg)
    return TrainingSettings(
        numbers_of(arguments.joints),
        Settings(points=arguments.points, query_points=arguments.query_points),
        arguments.trees,
        GrowthSettings(depth=arguments.depth, leaf_samples=arguments.leaf_samples),
        seed=arguments.seed,
        memory=arguments.memory * GIBIBYTE,
    )


def _check_writable(output: Path) -> None:
    """Find out now, not after an hour of training, that the model has nowhere to go."""
    if output.is_dir() or not output.absolute().parent.is_dir():
        msg = f'cannot write the model {output}: its folder must exist, and it must not be one'
        raise InputError(msg)


def _tell(step: str) -> None:
    if sys.stderr.isatty():
        print(f'lsc_pose: {step}', file=sys.stderr)
