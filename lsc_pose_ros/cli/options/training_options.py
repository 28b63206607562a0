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

"""The options of `lsc_pose train` that set the training settings, in one table."""

import argparse
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from lsc_pose_ros.cli.options.numbers import (
    float_from_zero,
    number_between,
    positive_float,
    positive_int,
)
from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.model_io.model_check import MOST_SPLITS, MOST_TREES
from lsc_pose_ros.pose.settings import FEATURES, LARGEST, SAMPLES
from lsc_pose_ros.training.body_yaw_labels import BODY_YAWS
from lsc_pose_ros.training.criterion import CRITERIA
from lsc_pose_ros.training.train import GIBIBYTE, TrainingSettings

_DEFAULTS = TrainingSettings(numbers_of(DEFAULT_JOINTS))

# The number of pixels around a pixel.
_NEIGHBOURS = 8

# If more people than this fraction are held out, too few are left to train on.
_LARGEST_HOLD_OUT = 0.5


# The largest values of the fields of each group that a model file bounds.
_BOUNDS: dict[str, dict[str, float]] = {
    'settings': LARGEST,
    '': {'trees': MOST_TREES},
    'growth': {'depth': MOST_SPLITS},
}


class TrainingOption(NamedTuple):
    """An option that sets one field of the training settings, which also has its default.

    Attributes:
        name: the option, without its dashes.
        group: the field of TrainingSettings that holds `field`; empty for TrainingSettings itself.
        field: the field that the option sets.
        help: what the field means.
        convert: what converts a word to the value.
        metavar: the unit of the value.
        choices: the possible values of a text.
    """

    name: str
    group: str
    field: str
    help: str
    convert: Callable[[str], object] = positive_int
    metavar: str = 'N'
    choices: tuple[str, ...] = ()

    @property
    def default(self) -> object:
        """The default of the field."""
        owner = getattr(_DEFAULTS, self.group) if self.group else _DEFAULTS
        return getattr(owner, self.field)

    @property
    def largest(self) -> float | None:
        """The largest value that a model file may have, None if the file does not bound it."""
        bounds = _BOUNDS.get(self.group)
        return bounds.get(self.field) if bounds else None


def _choice(name: str, group: str, choices: Iterable[str], text: str) -> TrainingOption:
    """Return an option for a field of the same name that has one of some texts."""
    return TrainingOption(name, group, name, text, str, choices=tuple(choices))


FOREST_OPTIONS = (
    TrainingOption('points', 'settings', 'points', 'silhouette points of a body'),
    TrainingOption(
        'query-points',
        'settings',
        'query_points',
        'how many of these points vote; the training uses all of them',
    ),
    TrainingOption('trees', '', 'trees', 'trees of the forest'),
    TrainingOption('depth', 'growth', 'depth', 'largest depth of a tree'),
    TrainingOption('leaf-samples', 'growth', 'leaf_samples', 'fewest samples in a leaf'),
    TrainingOption(
        'split-features', 'growth', 'features', 'random features that a split is chosen from'
    ),
    TrainingOption(
        'candidates',
        'settings',
        'candidates',
        'candidate positions of each joint that the graph chooses from',
    ),
    _choice(
        'feature',
        'settings',
        FEATURES,
        "descriptor of a point: the paper's 3-D local shape context (3dlsc), the shape context in "
        'the image (2dsc), depth comparisons (dcf), or 3dlsc and dcf together (mixed), which is '
        'the most accurate',
    ),
    _choice(
        'sample',
        'settings',
        SAMPLES,
        'where the points are; dcf on the body, evaluated with --no-graph, is the method of '
        'Girshick et al. 2011',
    ),
    _choice(
        'criterion',
        '',
        CRITERIA,
        "what a split minimises: the spread of the offsets to the joints, or the paper's entropy "
        'of the contributions of the joints',
    ),
)

LEAF_OPTIONS = (
    TrainingOption(
        'joint-reach',
        'leaves',
        'joint_reach',
        'largest distance from which a point votes for a joint, in units of rho_bar; 0.5 if '
        'joints are often hidden, such as arms behind a back',
        positive_float,
        'RHO',
    ),
    TrainingOption(
        'vote-bandwidth',
        'leaves',
        'bandwidth',
        'bandwidth of the mean-shift that clusters the offsets of a leaf into votes, in units of '
        'rho_bar',
        positive_float,
        'RHO',
    ),
    TrainingOption(
        'joint-fraction',
        'leaves',
        'joint_fraction',
        'leave out votes that stand for a smaller fraction of the samples of their leaf, which '
        'makes the model smaller',
        float_from_zero,
        'FRACTION',
    ),
)

DEPTH_OPTIONS = (
    TrainingOption(
        'least-cut-scale',
        'settings',
        'least_cut_scale',
        'unit of length of a body that is cut off, or hidden by something nearer: at least this '
        'instead of the rho_bar of its visible part; 0.62 if people are often cut off',
        float_from_zero,
        'METRES',
    ),
    TrainingOption(
        'fewest-neighbours',
        'settings',
        'fewest_neighbours',
        'leave out flying pixels: pixels with fewer than N of their eight neighbours at their '
        f'depth, within {100 * _DEFAULTS.settings.neighbour_distance:g} cm; 3 for a '
        'time-of-flight camera, 0 for none',
        number_between(int, 0, _NEIGHBOURS),
    ),
    TrainingOption(
        'fill-holes',
        'settings',
        'fill_holes',
        'give a pixel without depth the median of its neighbours if N or more of the eight are on '
        'the body; 5 for a camera that misses single pixels, 0 for none',
        number_between(int, 0, _NEIGHBOURS),
    ),
    TrainingOption(
        'noise-factor',
        'settings',
        'noise_factor',
        'raise the next two options to at least this multiple of the noise in the depth of a '
        'body; 4 if cameras or distances differ, 0 for no change',
        float_from_zero,
        'FACTOR',
    ),
    TrainingOption(
        'smoothing-sigma',
        'settings',
        'smoothing_sigma',
        'sigma of the depth smoothing (eq. 1); larger for a camera with more noise',
        float_from_zero,
        'METRES',
    ),
    TrainingOption(
        'edge-threshold',
        'settings',
        'edge_threshold',
        'depth step that makes an edge (eq. 2); well above the noise after smoothing',
        positive_float,
        'METRES',
    ),
)

HOLD_OUT_OPTION = TrainingOption(
    'hold-out',
    '',
    'hold_out',
    'fraction of the people, in ten stretches, that the forest does not learn from; confidence is '
    'calibrated on them. With 0, confidence is the fraction of the votes',
    number_between(float, 0, _LARGEST_HOLD_OUT),
    'FRACTION',
)

_OPTIONS = (*FOREST_OPTIONS, *LEAF_OPTIONS, *DEPTH_OPTIONS, HOLD_OUT_OPTION)


def add_training_options(
    container: argparse._ActionsContainer, options: Iterable[TrainingOption]
) -> None:
    """Add `options` to a parser or a group of options."""
    for option in options:
        values: dict[str, Any] = (
            {'choices': option.choices}
            if option.choices
            else {'type': _bounded(option), 'metavar': option.metavar}
        )
        container.add_argument(
            f'--{option.name}',
            default=option.default,
            help=f'{option.help} (default: %(default)s)',
            **values,
        )


def _bounded(option: TrainingOption) -> Callable[[str], Any]:
    """Return what converts a word to a value that a model file may have."""
    largest = option.largest

    def convert(word: str) -> object:
        value = option.convert(word)
        if largest is not None and isinstance(value, int | float) and value > largest:
            msg = f'{word} is too large; the limit is {largest:g}'
            raise argparse.ArgumentTypeError(msg)
        return value

    return convert


def add_memory_option(parser: argparse.ArgumentParser) -> None:
    """Add --memory."""
    parser.add_argument(
        '--memory',
        type=positive_float,
        default=_DEFAULTS.memory / GIBIBYTE,
        metavar='GIB',
        help='largest use of memory, in GiB; with longer recordings, the training uses fewer '
        'points of each person (default: %(default)s)',
    )


def training_settings(arguments: argparse.Namespace) -> TrainingSettings:
    """Return the settings that `arguments` ask for.

    Raises:
        InputError: a joint is not known, or the seed is negative or too large.
    """
    if arguments.seed < 0:
        msg = f'--seed {arguments.seed} must not be negative'
        raise InputError(msg)
    if arguments.seed > LARGEST['offset_seed']:
        msg = f'--seed is too large; the limit is {LARGEST["offset_seed"]:g}'
        raise InputError(msg)
    training = _DEFAULTS._replace(
        joints=numbers_of(arguments.joints),
        seed=arguments.seed,
        memory=arguments.memory * GIBIBYTE,
        mirror=arguments.mirror,
        settings=_DEFAULTS.settings._replace(
            body_yaws=BODY_YAWS if arguments.body_yaw else 0, offset_seed=arguments.seed
        ),
    )
    for option in _OPTIONS:
        value = getattr(arguments, option.name.replace('-', '_'))
        training = _with_field(training, option, value)
    return training._replace(hold_out=0.0) if arguments.calibrate else training


def all_settings(arguments: argparse.Namespace) -> str:
    """Return the options of the training with their values, as words that repeat it.

    The values are stored, because the defaults of the program may change.
    """
    values = vars(arguments)
    words = [f'--{option.name} {values[_field(option.name)]}' for option in _OPTIONS]
    if arguments.calibrate:  # excludes --hold-out
        words.remove(f'--{HOLD_OUT_OPTION.name} {arguments.hold_out}')
        words.append(f'--calibrate {" ".join(path.name for path in arguments.calibrate)}')
    words += [f'--memory {arguments.memory:g}', f'--seed {arguments.seed}']
    words += [f'--{name}' for name in ('mirror', 'body-yaw') if values[_field(name)]]
    return ' '.join([*words, '--joints', *arguments.joints])


def _field(option: str) -> str:
    return option.replace('-', '_')


def _with_field(
    training: TrainingSettings, option: TrainingOption, value: object
) -> TrainingSettings:
    if not option.group:
        return training._replace(**{option.field: value})  # type: ignore[arg-type]
    group = getattr(training, option.group)._replace(**{option.field: value})
    return training._replace(**{option.group: group})
