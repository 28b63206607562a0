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

"""`lsc_pose experiments`: measures the paper's tables and figures on recordings."""

import argparse
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path

from lsc_pose_experiments.defaults import ExperimentDefaults, full_defaults, quick_defaults
from lsc_pose_experiments.page import PAGE_NAME, Page
from lsc_pose_experiments.paper import EXPERIMENTS
from lsc_pose_experiments.protocol import PROTOCOLS, DataSelection, folds_of
from lsc_pose_experiments.publishing import Publisher
from lsc_pose_experiments.running import TrialContext, run_trials
from lsc_pose_experiments.trial import ResultStore
from lsc_pose_ros import __version__
from lsc_pose_ros.bags import FrameReader
from lsc_pose_ros.cli.input.labelled_frames import open_recordings, read_frames
from lsc_pose_ros.cli.options.numbers import positive_float, positive_int
from lsc_pose_ros.cli.options.topic_options import add_topic_arguments, topics_of
from lsc_pose_ros.cli.output.json_file import write_json
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import HTML, JSON
from lsc_pose_ros.files.output_check import Output, check_outputs, outputs_in
from lsc_pose_ros.training.train import GIBIBYTE
from lsc_pose_ros.viz.drawing.canvas import make_directory
from lsc_pose_ros.viz.report.page_parts import origin_of

HELP = "measure the paper's tables and figures on recordings"

_TEST_FRAMES = 900
_QUICK_TEST_FRAMES = 20
_VERDICTS = {True: 'holds', False: 'does not hold', None: 'is undecided'}
_QUICK = (
    'A quick run: it only shows that the command works. It uses too few frames to measure the '
    'method.'
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments to `parser`."""
    parser.add_argument(
        'output',
        type=Path,
        metavar='OUT',
        help='the folder for index.html, a CSV and a PNG file for each experiment, and stored '
        'results: the same command again measures only what is missing',
    )
    parser.add_argument(
        '--recordings',
        type=Path,
        nargs='+',
        required=True,
        metavar='RECORDING',
        help='labelled recordings',
    )
    parser.add_argument(
        '--test',
        type=Path,
        nargs='+',
        default=[],
        metavar='RECORDING',
        help='labelled test recordings, for the protocol `recordings`',
    )
    parser.add_argument(
        '--protocol',
        choices=PROTOCOLS,
        help='random: frames of all recordings are divided at random, as in the paper; '
        'recordings: the recordings of --test are tested; leave-one-out: each recording is tested '
        'with a model of all others (default: recordings if --test is given, else random)',
    )
    parser.add_argument(
        '--only',
        nargs='+',
        choices=list(EXPERIMENTS),
        metavar='NAME',
        help=f'measure only these experiments of {", ".join(EXPERIMENTS)}',
    )
    parser.add_argument(
        '--training-frames',
        type=positive_int,
        metavar='N',
        help='largest number of training frames (default: 3600, as in the paper); Fig. 15 uses '
        'from an eighth to 2.8 times as many',
    )
    parser.add_argument(
        '--test-frames',
        type=positive_int,
        metavar='N',
        help='largest number of test frames in each fold (default: 900, as in the paper)',
    )
    parser.add_argument(
        '--quick',
        action='store_true',
        help='measure very few frames, to check that the command works',
    )
    parser.add_argument(
        '--memory',
        type=positive_float,
        default=8.0,
        metavar='GIB',
        help='memory to use, in GiB; with many frames, each person has fewer samples '
        '(default: %(default)s)',
    )
    parser.add_argument(
        '--seed', type=int, default=0, help='seed of all random numbers (default: 0)'
    )
    parser.add_argument('--json', type=Path, metavar='FILE', help='write all numbers to this file')
    add_topic_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Measure the experiments of `arguments` that are not finished; return the exit status.

    Raises:
        InputError: a recording cannot be used, or the output cannot be written.
    """
    if arguments.seed < 0:
        msg = f'--seed {arguments.seed} must not be negative'
        raise InputError(msg)
    defaults, selection = _defaults(arguments), _selection(arguments)
    folds_of(selection)
    _check_outputs(arguments)
    readers = _open(arguments)
    experiments = {name: make(defaults) for name, make in EXPERIMENTS.items()}
    make_directory(arguments.output)

    def read(path: Path) -> Iterator[Frame]:
        return read_frames([readers[path]], f'sampling {path.name}')

    context = TrialContext(selection, ResultStore(arguments.output / 'trials'), read, _progress)
    page = Page(
        _facts(arguments, defaults, selection),
        origin_of(__version__),
        _QUICK if arguments.quick else '',
        _command(arguments),
        [],
    )
    wanted = arguments.only or list(experiments)
    publisher = Publisher(arguments.output, page, list(experiments.values()), wanted)
    trials = [
        variant.trial for name in wanted for variant in experiments[name].variants if variant.trial
    ]
    for _ in run_trials(context, trials):
        publisher.publish(context)
    page = publisher.publish(context)
    _print(page, wanted)
    if arguments.json:
        write_json(arguments.json, _results(page))
    print(arguments.output / 'index.html')
    return 0


def _check_outputs(arguments: argparse.Namespace) -> None:
    outputs = outputs_in(arguments.output, {PAGE_NAME: HTML})
    if arguments.json:
        outputs.append(Output(arguments.json, JSON))
    check_outputs(outputs, [*arguments.recordings, *arguments.test])


def _defaults(arguments: argparse.Namespace) -> ExperimentDefaults:
    defaults = (quick_defaults if arguments.quick else full_defaults)(arguments.seed)
    training = defaults.training._replace(memory=arguments.memory * GIBIBYTE)
    return defaults._replace(
        training=training, frames=arguments.training_frames or defaults.frames
    )


def _selection(arguments: argparse.Namespace) -> DataSelection:
    tested = _QUICK_TEST_FRAMES if arguments.quick else _TEST_FRAMES
    return DataSelection(
        tuple(arguments.recordings),
        tuple(arguments.test),
        arguments.protocol or ('recordings' if arguments.test else 'random'),
        arguments.test_frames or tested,
        arguments.seed,
        (*topics_of(arguments), str(arguments.mask_background)),
    )


def _open(arguments: argparse.Namespace) -> dict[Path, FrameReader]:
    """Open all recordings, so that a wrong name is found before the first training."""
    paths = [*arguments.recordings, *arguments.test]
    twice = sorted({str(path) for path in paths if paths.count(path) > 1})
    if twice:
        msg = f'{", ".join(twice)}: named twice; a test recording must not be in the training'
        raise InputError(msg)
    given = argparse.Namespace(**(vars(arguments) | {'recordings': paths}))
    return dict(zip(paths, open_recordings(given), strict=True))


def _facts(
    arguments: argparse.Namespace, defaults: ExperimentDefaults, selection: DataSelection
) -> dict[str, str]:
    facts = {
        'recordings': ', '.join(path.name for path in selection.recordings),
        'tested with': ', '.join(path.name for path in selection.tests),
        'protocol': {
            'random': 'random, as in the paper; with videos, frames of the same motion are in '
            'training and test, so this does not measure other people',
            'recordings': 'recordings: trained on the first, tested on the others',
            'leave-one-out': 'leave-one-out: each recording is tested with a model of the others',
        }[selection.protocol],
        'frames': f'at most {defaults.frames} for training and {selection.test_frames} for test, '
        'unless a variant says otherwise',
        'seed': str(arguments.seed),
    }
    return {name: value for name, value in facts.items() if value}


def _command(arguments: argparse.Namespace) -> str:
    words = ['lsc_pose', 'experiments', str(arguments.output), '--recordings']
    words += map(str, arguments.recordings)
    for name, value in vars(arguments).items():
        if name in {'output', 'recordings', 'only', 'json', 'command'} or not value:
            continue
        words.append(f'--{name.replace("_", "-")}')
        if isinstance(value, list):
            words += map(str, value)
        elif value is not True:
            words.append(str(value))
    return shlex.join(words)


def _print(page: Page, wanted: list[str]) -> None:
    """Print whether each claim holds."""
    for section in page.sections:
        if section.experiment.name in wanted:
            print(section.experiment.title)
            for claim, verdict in zip(section.experiment.claims, section.verdicts, strict=True):
                print(f'  {claim.words} Here it {_VERDICTS[verdict.holds]}: {verdict.words}')


def _results(page: Page) -> dict[str, object]:
    return {
        **page.facts,
        'experiments': {
            section.experiment.name: {
                'title': section.experiment.title,
                'rows': [row._asdict() for row in section.rows],
                'claims': [
                    {'claim': claim.words, **verdict._asdict()}
                    for claim, verdict in zip(
                        section.experiment.claims, section.verdicts, strict=True
                    )
                ],
            }
            for section in page.sections
            if section.rows
        },
    }


def _progress(step: str) -> None:
    if sys.stderr.isatty():
        print(f'lsc_pose: {step}', file=sys.stderr)
