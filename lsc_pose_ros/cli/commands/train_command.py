"""`lsc_pose train`: labelled recordings become a model."""

import argparse
import itertools
import sys
import time
from pathlib import Path

from lsc_pose_ros import __version__
from lsc_pose_ros.bags import FrameReader
from lsc_pose_ros.cli.input.labelled_frames import (
    add_recording_arguments,
    open_recordings,
    read_frames,
)
from lsc_pose_ros.cli.options.numbers import (
    finite_float,
    float_from_zero,
    positive_float,
    positive_int,
)
from lsc_pose_ros.cli.output.json_file import write_json
from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.model_io.model_file import save_model
from lsc_pose_ros.pose.settings import FEATURES, SAMPLES, Settings
from lsc_pose_ros.training.body_yaw_training import BODY_YAWS
from lsc_pose_ros.training.calibration import calibrate
from lsc_pose_ros.training.criterion import CRITERIA, SPREAD
from lsc_pose_ros.training.leaves import LeafSettings
from lsc_pose_ros.training.samples import labelled_people
from lsc_pose_ros.training.train import GIBIBYTE, TrainingSettings, train
from lsc_pose_ros.training.tree_growth import GrowthSettings

HELP = 'learn a model from labelled recordings'

# How many pixels are around one.
_NEIGHBOURS = 8

# More than this is no longer a training.
_LARGEST_SHARE = 0.5


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments to `parser`."""
    add_recording_arguments(parser)
    parser.add_argument(
        '-o', '--output', type=Path, required=True, metavar='MODEL', help='the model, e.g. me.npz'
    )
    _add_forest_arguments(parser)
    _add_leaf_arguments(parser)
    _add_surface_arguments(parser)
    parser.add_argument(
        '--mirror',
        action='store_true',
        help='learn from every frame a second time, mirrored, left and right exchanged; takes '
        'twice the time and memory',
    )
    parser.add_argument(
        '--body-yaw',
        action='store_true',
        help='tell the forest where people face, and find it out by trying: for people who may '
        'turn their backs to the camera',
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
    _add_teacher_arguments(parser.add_mutually_exclusive_group())
    parser.add_argument('--seed', type=int, default=0, help='of all that is drawn (default: 0)')
    parser.add_argument('--json', type=Path, metavar='FILE', help='write sizes and times there')


def _add_forest_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what decides how the points are described and the trees grown."""
    defaults, growth = Settings(), GrowthSettings()
    untrained = TrainingSettings(numbers_of(DEFAULT_JOINTS))
    for name, default, what in (
        ('points', defaults.points, 'points a body'),
        ('query-points', defaults.query_points, 'of these, how many vote (all of them teach)'),
        ('trees', untrained.trees, 'trees of the forest'),
        ('depth', growth.depth, 'depth of a tree at most'),
        ('leaf-samples', growth.leaf_samples, 'samples of a leaf at least'),
        ('split-features', growth.features, 'random features that a split is chosen from'),
        ('candidates', defaults.candidates, 'places of each joint that the graph chooses from'),
    ):
        parser.add_argument(
            f'--{name}',
            type=positive_int,
            default=default,
            metavar='N',
            help=f'{what} (default: %(default)s)',
        )
    parser.add_argument(
        '--feature',
        choices=FEATURES,
        default=defaults.feature,
        help="what the forest sees of a point: the paper's 3-D local shape context, or one of its "
        'rivals, the shape context in the image or depth comparisons, or the first and the last '
        'together, which is the most exact (default: %(default)s)',
    )
    parser.add_argument(
        '--sample',
        choices=SAMPLES,
        default=defaults.sample,
        help='where the points lie; dcf on the body, evaluated with --no-graph, is the method of '
        'Girshick et al. 2011 (default: %(default)s)',
    )
    parser.add_argument(
        '--criterion',
        choices=CRITERIA,
        default=SPREAD,
        help="what the splits make small: the spread of the joints' offsets, or the paper's "
        "entropy of the joints' contributions (default: %(default)s)",
    )


def _add_leaf_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what decides for which joints a leaf votes."""
    leaves = LeafSettings()
    parser.add_argument(
        '--joint-reach',
        type=positive_float,
        default=leaves.joint_reach,
        metavar='RHO',
        help='from how far points vote for a joint, in units of rho_bar; 0.5 where joints are '
        'often hidden, such as arms behind a back (default: %(default)s)',
    )
    parser.add_argument(
        '--vote-bandwidth',
        type=positive_float,
        default=leaves.bandwidth,
        metavar='RHO',
        help='how near the offsets in a leaf are that become one vote, in units of rho_bar '
        '(default: %(default)s)',
    )
    parser.add_argument(
        '--joint-share',
        type=float_from_zero,
        default=leaves.joint_share,
        metavar='SHARE',
        help='leave out votes that stand for less than this share of their leaf, which makes the '
        'model smaller (default: %(default)s)',
    )


def _add_surface_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what decides how the silhouette is found in what kind of depth."""
    defaults = Settings()
    parser.add_argument(
        '--fewest-neighbours',
        type=int,
        choices=range(_NEIGHBOURS + 1),
        default=defaults.fewest_neighbours,
        metavar='N',
        help='leave out flying pixels: those of which fewer than N of the eight neighbours are at '
        f'their depth, to {100 * defaults.neighbour_distance:g} cm; for a time-of-flight camera 3 '
        '(default: %(default)s, none are)',
    )
    parser.add_argument(
        '--fill-holes',
        type=int,
        choices=range(_NEIGHBOURS + 1),
        default=defaults.fill_holes,
        metavar='N',
        help='give a pixel without depth the median of its neighbours on the body, where N of the '
        'eight are; 5 for a camera that misses single pixels (default: %(default)s, none)',
    )
    parser.add_argument(
        '--noise-factor',
        type=float_from_zero,
        default=defaults.noise_factor,
        metavar='TIMES',
        help="raise the next two to so many times the noise that is found in a body's depth; 4 "
        'where cameras or distances differ (default: %(default)g, they stay)',
    )
    parser.add_argument(
        '--smoothing-sigma',
        type=float_from_zero,
        default=defaults.smoothing_sigma,
        metavar='METRES',
        help='how far neighbouring pixels are smoothed (eq. 1); more for a camera with more noise '
        '(default: %(default)s)',
    )
    parser.add_argument(
        '--edge-threshold',
        type=positive_float,
        default=defaults.edge_threshold,
        metavar='METRES',
        help='the step in depth that makes an edge (eq. 2); well above the noise that is left '
        '(default: %(default)s)',
    )


def _add_teacher_arguments(teachers: argparse._MutuallyExclusiveGroup) -> None:
    """Add what confidence is learnt from: a part of the recordings, or others."""
    untrained = TrainingSettings(numbers_of(DEFAULT_JOINTS))
    teachers.add_argument(
        '--hold-out',
        type=_share,
        default=untrained.hold_out,
        metavar='SHARE',
        help='this share of the people, in ten stretches, is not learned from but teaches which '
        'confidence is right; 0: confidence is the share of the votes (default: %(default)s)',
    )
    teachers.add_argument(
        '--calibrate',
        type=Path,
        nargs='+',
        metavar='RECORDING',
        help='learn from all people, and from those of other labelled recordings which '
        'confidence is right; best of people whom the model will not have seen',
    )


def run(arguments: argparse.Namespace) -> int:
    """Train the model that `arguments` ask for; return the exit status.

    Raises:
        InputError: a recording, a joint or the output cannot be used.
    """
    training = _training_settings(arguments)
    _check_writable(arguments.output)
    readers = open_recordings(arguments)
    others = _open_others(arguments, training)
    provenance = {
        'recordings': ', '.join(path.name for path in arguments.recordings),
        'program': f'lsc_pose_ros {__version__}',
        'seed': str(training.seed),
        'mirrored': 'yes' if training.mirror else 'no',
    }
    begin = time.perf_counter()
    model = train(read_frames(readers, 'describing'), training, provenance, _tell)
    if others:
        frames = read_frames(others, 'calibrating')
        model = calibrate(model, labelled_people(frames, training.joints, training.settings))
    save_model(arguments.output, model)
    seconds = time.perf_counter() - begin
    results: dict[str, object] = {
        'model': str(arguments.output),
        'recordings': [str(path) for path in arguments.recordings],
        'people': int(model.provenance['people']),
        'points': int(model.provenance['samples']),
        'calibrated': len(model.calibration) > 0,
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
        Settings(
            fewest_neighbours=arguments.fewest_neighbours,
            fill_holes=arguments.fill_holes,
            noise_factor=arguments.noise_factor,
            smoothing_sigma=arguments.smoothing_sigma,
            edge_threshold=arguments.edge_threshold,
            feature=arguments.feature,
            sample=arguments.sample,
            points=arguments.points,
            query_points=arguments.query_points,
            candidates=arguments.candidates,
            body_yaws=BODY_YAWS if arguments.body_yaw else 0,
            offset_seed=arguments.seed,
        ),
        trees=arguments.trees,
        growth=GrowthSettings(
            depth=arguments.depth,
            leaf_samples=arguments.leaf_samples,
            features=arguments.split_features,
        ),
        leaves=LeafSettings(
            joint_reach=arguments.joint_reach,
            joint_share=arguments.joint_share,
            bandwidth=arguments.vote_bandwidth,
        ),
        criterion=arguments.criterion,
        mirror=arguments.mirror,
        seed=arguments.seed,
        memory=arguments.memory * GIBIBYTE,
        hold_out=0.0 if arguments.calibrate else arguments.hold_out,
    )


def _share(word: str) -> float:
    """Return the number from 0 to 0.5 that `word` stands for."""
    value = finite_float(word)
    if not 0 <= value <= _LARGEST_SHARE:
        msg = f'{word!r} is not a number from 0 to {_LARGEST_SHARE:g}'
        raise argparse.ArgumentTypeError(msg)
    return value


def _open_others(arguments: argparse.Namespace, training: TrainingSettings) -> list[FrameReader]:
    """Open what --calibrate names, and find out now whether it is of use after the training."""
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


def _check_writable(output: Path) -> None:
    """Find out now, not after an hour of training, that the model has nowhere to go."""
    if output.is_dir() or not output.absolute().parent.is_dir():
        msg = f'cannot write the model {output}: its folder must exist, and it must not be one'
        raise InputError(msg)


def _tell(step: str) -> None:
    if sys.stderr.isatty():
        print(f'lsc_pose: {step}', file=sys.stderr)
