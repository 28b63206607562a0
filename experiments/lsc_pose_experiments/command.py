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

"""`lsc_pose experiments`: the paper's tables and figures, measured on recordings."""

import argparse
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path

from lsc_pose_experiments.page import Page
from lsc_pose_experiments.paper import EXPERIMENTS, Scope, full_scope, quick_scope
from lsc_pose_experiments.protocol import PROTOCOLS, Study, folds_of
from lsc_pose_experiments.publishing import Publisher
from lsc_pose_experiments.running import Bench, run_trials
from lsc_pose_experiments.trial import Store
from lsc_pose_ros.bags import FrameReader
from lsc_pose_ros.cli.input.labelled_frames import open_recordings, read_frames
from lsc_pose_ros.cli.options.numbers import positive_float, positive_int
from lsc_pose_ros.cli.options.topic_options import add_topic_arguments, topics_of
from lsc_pose_ros.cli.output.json_file import write_json
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.training.train import GIBIBYTE
from lsc_pose_ros.viz.drawing.canvas import make_directory

HELP = "measure the paper's tables and figures on recordings"

_TEST_FRAMES = 900
_QUICK_TEST_FRAMES = 20
_ANSWERS = {True: 'holds', False: 'does not hold', None: 'cannot be told'}
_QUICK = (
    'A quick run: it shows that all of this works. Its numbers are of far too few frames to say '
    'anything about the method.'
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments to `parser`."""
    parser.add_argument(
        'output',
        type=Path,
        metavar='OUT',
        help='the folder for index.html, a CSV and a PNG file each, and what is finished: the '
        'same command again does only what is missing',
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
        help='with the protocol recordings: labelled recordings to test with',
    )
    parser.add_argument(
        '--protocol',
        choices=PROTOCOLS,
        help="random: the paper's, frames of all recordings divided at random; recordings: those "
        'of --test are tested; leave-one-out: each recording is tested once and all others are '
        'learnt from (default: random, or recordings where --test is given)',
    )
    parser.add_argument(
        '--only',
        nargs='+',
        choices=list(EXPERIMENTS),
        metavar='NAME',
        help=f'measure only these of {", ".join(EXPERIMENTS)}',
    )
    parser.add_argument(
        '--training-frames',
        type=positive_int,
        metavar='N',
        help="learn from at most so many frames (default: the paper's 3600); Fig. 15 goes from an "
        'eighth to 2.8 times as many',
    )
    parser.add_argument(
        '--test-frames',
        type=positive_int,
        metavar='N',
        help="test at most so many frames of each fold (default: the paper's 900)",
    )
    parser.add_argument(
        '--quick', action='store_true', help='measure next to nothing, to see that it works'
    )
    parser.add_argument(
        '--memory',
        type=positive_float,
        default=8.0,
        metavar='GIB',
        help='take about so much, in GiB: of many frames, learn from fewer points a person '
        '(default: %(default)s)',
    )
    parser.add_argument('--seed', type=int, default=0, help='of all that is drawn (default: 0)')
    parser.add_argument('--json', type=Path, metavar='FILE', help='write all numbers there')
    add_topic_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Measure what `arguments` ask for and is not finished; return the exit status.

    Raises:
        InputError: a recording cannot be used, or nothing can be written.
    """
    if arguments.seed < 0:
        msg = f'--seed {arguments.seed} must not be negative'
        raise InputError(msg)
    scope, study = _scope(arguments), _study(arguments)
    folds_of(study)
    readers = _open(arguments)
    experiments = {name: make(scope) for name, make in EXPERIMENTS.items()}
    make_directory(arguments.output)

    def read(path: Path) -> Iterator[Frame]:
        return read_frames([readers[path]], f'drawing from {path.name}')

    bench = Bench(study, Store(arguments.output / 'trials'), read, _tell)
    page = Page(_facts(arguments, scope, study), _QUICK if arguments.quick else '',
                _command(arguments), [])  # fmt: skip
    publisher = Publisher(arguments.output, page, list(experiments.values()))
    wanted = arguments.only or list(experiments)
    trials = [
        variant.trial for name in wanted for variant in experiments[name].variants if variant.trial
    ]
    for _ in run_trials(bench, trials):
        publisher.publish(bench)
    page = publisher.publish(bench)
    _print(page, wanted)
    if arguments.json:
        write_json(arguments.json, _results(page))
    print(arguments.output / 'index.html')
    return 0


def _scope(arguments: argparse.Namespace) -> Scope:
    scope = (quick_scope if arguments.quick else full_scope)(arguments.seed)
    training = scope.training._replace(memory=arguments.memory * GIBIBYTE)
    return scope._replace(training=training, frames=arguments.training_frames or scope.frames)


def _study(arguments: argparse.Namespace) -> Study:
    tested = _QUICK_TEST_FRAMES if arguments.quick else _TEST_FRAMES
    return Study(
        tuple(arguments.recordings),
        tuple(arguments.test),
        arguments.protocol or ('recordings' if arguments.test else 'random'),
        arguments.test_frames or tested,
        arguments.seed,
        (*topics_of(arguments), str(arguments.mask_background)),
    )


def _open(arguments: argparse.Namespace) -> dict[Path, FrameReader]:
    """Open all recordings now: a wrong name is found out before the first training."""
    paths = [*arguments.recordings, *arguments.test]
    twice = sorted({str(path) for path in paths if paths.count(path) > 1})
    if twice:
        msg = f'{", ".join(twice)}: named twice; what is tested must not be learnt from'
        raise InputError(msg)
    given = argparse.Namespace(**(vars(arguments) | {'recordings': paths}))
    return dict(zip(paths, open_recordings(given), strict=True))


def _facts(arguments: argparse.Namespace, scope: Scope, study: Study) -> dict[str, str]:
    facts = {
        'recordings': ', '.join(path.name for path in study.recordings),
        'tested with': ', '.join(path.name for path in study.tests),
        'protocol': {
            'random': "random: the paper's; frames of the same motions are on both sides where "
            'the recordings are videos, so that this says little about other people',
            'recordings': 'recordings: learnt from the first, tested with the others',
            'leave-one-out': 'leave-one-out: each recording tested by what the others teach',
        }[study.protocol],
        'frames': f'at most {scope.frames} to learn from, {study.test_frames} to test, where '
        'nothing else is said',
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
    """Say of each claim whether it holds."""
    for section in page.sections:
        if section.experiment.name in wanted:
            print(section.experiment.title)
            for claim, verdict in zip(section.experiment.claims, section.verdicts, strict=True):
                print(f'  {claim.words} Here it {_ANSWERS[verdict.holds]}: {verdict.words}')


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


def _tell(step: str) -> None:
    if sys.stderr.isatty():
        print(f'lsc_pose: {step}', file=sys.stderr)
