"""`lsc_pose evaluate`: how good a model is on labelled recordings."""

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from lsc_pose_ros.cli.json_file import write_json
from lsc_pose_ros.cli.labelled_frames import (
    add_recording_arguments,
    open_recordings,
    read_frames,
)
from lsc_pose_ros.cli.numbers import positive_float, positive_int
from lsc_pose_ros.core.estimator import Estimator
from lsc_pose_ros.core.model import Model
from lsc_pose_ros.data.model_file import load_model
from lsc_pose_ros.learning.evaluate import Evaluation, Summary, evaluate, summarise
from lsc_pose_ros.learning.reliability import Reliability, measure_reliability

HELP = 'measure a model on labelled recordings'

PAPER_TOLERANCE = 0.1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments to `parser`."""
    parser.add_argument('model', type=Path, metavar='MODEL', help='a model that `train` wrote')
    add_recording_arguments(parser)
    parser.add_argument(
        '--no-graph',
        dest='graph',
        action='store_false',
        help='take each joint by itself, without the pictorial structure',
    )
    parser.add_argument(
        '--query-points',
        type=positive_int,
        metavar='N',
        help='how many silhouette points vote (default: as the model says)',
    )
    parser.add_argument(
        '--tolerance',
        type=positive_float,
        default=PAPER_TOLERANCE,
        metavar='METRES',
        help='how far a joint may be off to count as found (default: %(default)s)',
    )
    parser.add_argument('--json', type=Path, metavar='FILE', help='write the results there')
    parser.add_argument(
        '--report', type=Path, metavar='DIR', help='write a page with plots and pictures there'
    )


def run(arguments: argparse.Namespace) -> int:
    """Evaluate the model that `arguments` name and print the scores; return the exit status.

    Raises:
        InputError: the model or a recording cannot be used, or nothing is labelled.
    """
    model = load_model(arguments.model)
    if arguments.query_points:
        settings = model.settings._replace(query_points=arguments.query_points)
        model = model._replace(settings=settings)
    estimator = Estimator(model, graph=arguments.graph)
    readers = open_recordings(arguments)
    evaluation = evaluate(estimator, read_frames(readers, 'evaluating'))
    summary = summarise(evaluation, arguments.tolerance)
    results = _results(arguments, model, evaluation, summary)
    print(_table(results, summary))
    if arguments.json:
        write_json(arguments.json, results)
    if arguments.report:
        # Matplotlib takes half a second to import, which a plain evaluation need not wait for.
        from lsc_pose_ros.cli.evaluation_report import report_evaluation  # noqa: PLC0415

        page = report_evaluation(
            arguments.report,
            estimator,
            readers,
            (evaluation, summary, arguments.tolerance),
            _facts(results),
        )
        print(page)
    return 0


def _results(
    arguments: argparse.Namespace,
    model: Model,
    evaluation: Evaluation,
    summary: Summary,
) -> dict[str, Any]:
    milliseconds = 1000 * evaluation.seconds
    return {
        'frames': len(evaluation.seconds),
        'people': len(evaluation.errors),
        'mean_error_m': summary.mean_error_m,
        'map': summary.map,
        'tolerance_m': arguments.tolerance,
        'joints': {name: score._asdict() for name, score in summary.joints.items()},
        'ms_per_frame': {
            'p50': float(np.percentile(milliseconds, 50)),
            'p95': float(np.percentile(milliseconds, 95)),
        },
        'model': str(arguments.model),
        'recordings': [str(path) for path in arguments.recordings],
        'graph': arguments.graph,
        'query_points': model.settings.query_points,
        'feature': model.settings.feature,
        'sample': model.settings.sample,
        'confidence': _confidence(model, measure_reliability(evaluation)),
    }


def _confidence(model: Model, reliability: Reliability) -> dict[str, Any]:
    """Return how far confidence is to be believed, in words that JSON has."""
    return {
        'calibrated': len(model.calibration) > 0,
        **reliability._asdict(),
        'bins': [each._asdict() for each in reliability.bins],
    }


def _facts(results: dict[str, Any]) -> dict[str, str]:
    times = results['ms_per_frame']
    return {
        'model': Path(results['model']).name,
        'recordings': ', '.join(Path(name).name for name in results['recordings']),
        'graph': 'on' if results['graph'] else 'off',
        'confidence': _words_on(results['confidence']),
        'time a frame': f'{times["p50"]:.1f} ms (95 % within {times["p95"]:.1f} ms)',
    }


def _words_on(confidence: dict[str, Any]) -> str:
    words = f'off by {100 * confidence["ece"]:.1f} % (expected calibration error)'
    return words if confidence['calibrated'] else f'{words}, not calibrated'


def _table(results: dict[str, Any], summary: Summary) -> str:
    tolerance = 100 * results['tolerance_m']
    lines = [f'{"joint":<12}{"error cm":>9}{f"within {tolerance:g} cm":>16}{"n":>8}']
    lines += [
        f'{name:<12}{100 * score.mean_error_m:>9.1f}{100 * score.ap:>14.1f} %{score.n:>8}'
        for name, score in summary.joints.items()
    ]
    lines.append(f'{"mean":<12}{100 * summary.mean_error_m:>9.1f}{100 * summary.map:>14.1f} %')
    times = results['ms_per_frame']
    lines.append(
        f'{results["frames"]} frames, {times["p50"]:.1f} ms a frame '
        f'(95 % within {times["p95"]:.1f} ms)'
    )
    lines.append(f'confidence {_words_on(results["confidence"])}')
    return '\n'.join(lines)
