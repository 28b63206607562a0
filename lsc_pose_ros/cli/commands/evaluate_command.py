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

"""`lsc_pose evaluate`: how good a model is on labelled recordings."""

import argparse
from collections.abc import Callable
from itertools import takewhile
from pathlib import Path
from typing import Any, NamedTuple

from lsc_pose_ros import __version__
from lsc_pose_ros.bags import FrameReader
from lsc_pose_ros.cli.input.labelled_frames import open_recordings, read_frames
from lsc_pose_ros.cli.options.estimation_options import estimator_from
from lsc_pose_ros.cli.options.numbers import positive_float
from lsc_pose_ros.cli.options.setting_options import add_setting_options
from lsc_pose_ros.cli.options.topic_options import add_topic_arguments
from lsc_pose_ros.cli.output.evaluation_comparison import comparison_table, different_names
from lsc_pose_ros.cli.output.evaluation_results import (
    EvaluationInputs,
    EvaluationOutput,
    evaluation_facts,
    evaluation_results,
    evaluation_table,
)
from lsc_pose_ros.cli.output.json_file import write_json
from lsc_pose_ros.cli.output.video_results import (
    OVER_TIME,
    SINGLY,
    SingleFrames,
    estimate_over_time,
    video_results,
    video_table,
)
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation.evaluate import evaluate, select, summarise
from lsc_pose_ros.evaluation.offsets import fit_offsets
from lsc_pose_ros.evaluation.video_scores import VideoFrame
from lsc_pose_ros.files.kinds import HTML, JSON
from lsc_pose_ros.files.output_check import Output, check_outputs, outputs_in
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.resources.package_files import find_model, shipped_models
from lsc_pose_ros.viz.report import PAGE_NAME

HELP = """Measure a model on labelled recordings: the model that the first word or --model names,
or else the one that comes with the package. Several models before the recordings are measured
one after the other, and shown side by side."""

PAPER_TOLERANCE = 0.1

# By these the first word is told from a model's.
_RECORDING_SUFFIXES = {'.mcap', '.db3', '.zstd'}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments to `parser`."""
    _add_what_is_measured(parser)
    add_setting_options(parser, 'graph', 'query_points')
    parser.add_argument(
        '--tolerance',
        type=positive_float,
        default=PAPER_TOLERANCE,
        metavar='METRES',
        help='how far a joint may be off to count as found (default: %(default)s)',
    )
    parser.add_argument(
        '--joints',
        nargs='+',
        metavar='JOINT',
        help='count these joints only (default: all that the model estimates)',
    )
    parser.add_argument(
        '--offsets-from',
        type=Path,
        nargs='+',
        metavar='RECORDING',
        help='also give the results with a constant offset added to each joint: what these other '
        'labelled recordings show it to be off by, in the camera frame, as the median; for labels '
        'whose joints lie elsewhere in the body',
    )
    parser.add_argument(
        '--video',
        action='store_true',
        help='also estimate the frames as successive ones, as replay and the node do, and tell '
        'how steady the joints are; for recordings of people who move, not for single frames',
    )
    parser.add_argument('--json', type=Path, metavar='FILE', help='write the results there')
    parser.add_argument(
        '--report', type=Path, metavar='DIR', help='write a page with plots and pictures there'
    )
    add_topic_arguments(parser)


def _add_what_is_measured(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        'first',
        metavar='[MODEL]',
        help='a model that `train` wrote, or the name of one that comes with the package; it may '
        'be left out before recordings whose names end in .mcap or .db3, and before bag folders',
    )
    recordings = parser.add_argument(
        'recordings',
        type=Path,
        nargs='+',
        default=[],
        metavar='RECORDING',
        help='a labelled recording: an .mcap or .db3 file, or a bag folder',
    )
    # The first word may be the only recording.
    recordings.required = False
    add_setting_options(parser, 'model')


def run(arguments: argparse.Namespace) -> int:
    """Evaluate the models that `arguments` name and print the scores; return the exit status.

    Raises:
        InputError: a model or a recording cannot be used, or nothing is labelled.
    """
    models, recordings = _models_and_recordings(arguments)
    _check_outputs(arguments, [*models, *recordings, *(arguments.offsets_from or [])])
    readers = open_recordings(arguments, recordings)
    others = open_recordings(arguments, arguments.offsets_from or [])
    if len(models) > 1:
        return _compare(arguments, models, readers, others)
    measured = _evaluate(arguments, models[0], readers, others)
    if arguments.video:
        over_time = estimate_over_time(measured.estimator, readers)
        video = {SINGLY: measured.frames, OVER_TIME: over_time}
        measured.results['video'] = video_results(video, arguments.tolerance)
    print(evaluation_table(measured.results))
    if arguments.video:
        print(video_table(measured.results['video'], arguments.tolerance))
    if arguments.json:
        write_json(arguments.json, measured.results)
    if arguments.report:
        # Matplotlib takes half a second to import, which a plain evaluation need not wait for.
        from lsc_pose_ros.cli.output.evaluation_report import (  # noqa: PLC0415
            EvaluatedVideo,
            report_evaluation,
        )

        output = measured.output
        page = report_evaluation(
            arguments.report,
            measured.estimator,
            readers,
            (output.evaluation, output.summary, arguments.tolerance),
            evaluation_facts(measured.results),
            EvaluatedVideo(video, measured.results['video']) if arguments.video else None,
        )
        print(page)
    return 0


def _check_outputs(arguments: argparse.Namespace, inputs: list[Path]) -> None:
    outputs = [Output(arguments.json, JSON)] if arguments.json else []
    if arguments.report:
        outputs += outputs_in(arguments.report, {PAGE_NAME: HTML})
    check_outputs(outputs, inputs)


class _Measured(NamedTuple):
    """A model, its evaluation, the results by name, and the frames of a video."""

    estimator: Estimator
    output: EvaluationOutput
    results: dict[str, Any]
    frames: list[VideoFrame]


def _evaluate(
    arguments: argparse.Namespace,
    model: Path,
    readers: list[FrameReader],
    others: list[FrameReader],
) -> _Measured:
    estimator = estimator_from(arguments, model)
    video = SingleFrames(estimator)
    observe = video.add if arguments.video else None
    output = _measure(arguments, estimator, readers, others, observe)
    recordings = [reader.path for reader in readers]
    offsets_from = arguments.offsets_from or []
    inputs = EvaluationInputs(model, recordings, offsets_from, arguments.tolerance)
    results = evaluation_results(inputs, estimator, output)
    return _Measured(estimator, output, results, video.frames)


def _compare(
    arguments: argparse.Namespace,
    models: list[Path],
    readers: list[FrameReader],
    others: list[FrameReader],
) -> int:
    """Evaluate several models on the same recordings, and print them side by side."""
    if arguments.video:
        msg = '--video measures one model; name only one'
        raise InputError(msg)
    names = different_names(models)
    measured = [_evaluate(arguments, model, readers, others) for model in models]
    results = [each.results for each in measured]
    print(comparison_table(names, results))
    if arguments.json:
        write_json(arguments.json, {'models': dict(zip(names, results, strict=True))})
    if arguments.report:
        from lsc_pose_ros.viz.report.comparison_page import (  # noqa: PLC0415
            ComparedModel,
            write_comparison,
        )
        from lsc_pose_ros.viz.report.page_parts import origin_of  # noqa: PLC0415

        compared = [
            ComparedModel(
                name,
                each.output.summary,
                each.output.evaluation,
                each.estimator.model.provenance,
            )
            for name, each in zip(names, measured, strict=True)
        ]
        facts = {'recordings': ', '.join(reader.path.name for reader in readers)}
        origin = origin_of(__version__)
        print(write_comparison(arguments.report, compared, arguments.tolerance, facts, origin))
    return 0


def _models_and_recordings(arguments: argparse.Namespace) -> tuple[list[Path], list[Path]]:
    """Return the paths of the models and the recordings that the words stand for."""
    words = [Path(arguments.first), *arguments.recordings]
    if _is_recording(words[0]):
        return [find_model(arguments.model)], words
    if arguments.model:
        msg = (
            f'{words[0]} and --model {arguments.model}: two models are named; leave one out '
            '(the names of recordings end in .mcap or .db3, or are those of folders)'
        )
        raise InputError(msg)
    models = [words[0], *takewhile(_is_model, words[1:])]
    if len(models) == len(words):
        msg = f'{words[-1]}: no recording is named; give `lsc_pose evaluate` one after the model'
        raise InputError(msg)
    return [find_model(model) for model in models], words[len(models) :]


def _is_recording(word: Path) -> bool:
    return word.is_dir() or word.suffix in _RECORDING_SUFFIXES


def _is_model(word: Path) -> bool:
    return not _is_recording(word) and (word.suffix == '.npz' or str(word) in shipped_models())


def _measure(
    arguments: argparse.Namespace,
    estimator: Estimator,
    readers: list[FrameReader],
    others: list[FrameReader],
    observe: Callable[[Frame, Skeletons], None] | None,
) -> EvaluationOutput:
    """Evaluate on `readers`, with offsets fitted on `others` if there are any."""
    wanted = numbers_of(arguments.joints) if arguments.joints else estimator.joints
    offsets = None
    if others:
        fitted = select(evaluate(estimator, read_frames(others, 'fitting offsets')), wanted)
        offsets = fit_offsets(fitted)
    evaluation = select(evaluate(estimator, read_frames(readers, 'evaluating'), observe), wanted)
    return EvaluationOutput(evaluation, summarise(evaluation, arguments.tolerance), offsets)
