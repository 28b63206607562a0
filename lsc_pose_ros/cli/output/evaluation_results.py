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

"""Formats the results of `lsc_pose evaluate` as JSON, as a table, and for the report."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.evaluation.confidence_reliability import Reliability, measure_reliability
from lsc_pose_ros.evaluation.evaluate import Evaluation, Summary, summarise
from lsc_pose_ros.evaluation.offsets import apply_offsets
from lsc_pose_ros.evaluation.visibility_scores import score_by_visibility
from lsc_pose_ros.pose.estimator import Estimator


class EvaluationInputs(NamedTuple):
    """The inputs of an evaluation.

    Attributes:
        model: the model file.
        recordings: the test recordings.
        offsets_from: the recordings that the offsets were fitted on.
        tolerance: the largest error of a joint that counts as found, metres.
    """

    model: Path
    recordings: Sequence[Path]
    offsets_from: Sequence[Path]
    tolerance: float


class EvaluationOutput(NamedTuple):
    """The results of an evaluation.

    Attributes:
        evaluation: the errors of the estimates.
        summary: the summary of `evaluation`.
        offsets: added to the estimates, metres, shape (J, 3); None for no offsets.
    """

    evaluation: Evaluation
    summary: Summary
    offsets: NDArray[np.float32] | None


def evaluation_results(
    inputs: EvaluationInputs, estimator: Estimator, output: EvaluationOutput
) -> dict[str, Any]:
    """Return all results by name, for --json."""
    evaluation, summary, offsets = output
    settings, calibrated = estimator.model.settings, len(estimator.model.calibration) > 0
    milliseconds = 1000 * evaluation.seconds
    results = {
        'frames': len(evaluation.seconds),
        'people': len(evaluation.errors),
        'tolerance_m': inputs.tolerance,
        **_scores(evaluation, summary, inputs.tolerance, calibrated=calibrated),
        'ms_per_frame': {
            'p50': float(np.percentile(milliseconds, 50)),
            'p95': float(np.percentile(milliseconds, 95)),
        },
        'model': str(inputs.model),
        'recordings': [str(recording) for recording in inputs.recordings],
        'graph': estimator.graph,
        'query_points': settings.query_points,
        'feature': settings.feature,
        'sample': settings.sample,
    }
    if offsets is not None:
        moved = apply_offsets(evaluation, offsets)
        results['with_offsets'] = {
            **_scores(
                moved,
                summarise(moved, inputs.tolerance),
                inputs.tolerance,
                calibrated=calibrated,
            ),
            'offsets_m': dict(zip(names_of(moved.joints), offsets.tolist(), strict=True)),
            'offsets_from': [str(recording) for recording in inputs.offsets_from],
        }
    return results


def _scores(
    evaluation: Evaluation, summary: Summary, tolerance: float, *, calibrated: bool
) -> dict[str, Any]:
    """Return the results that offsets change."""
    return {
        'mean_error_m': summary.mean_error_m,
        'map': summary.map,
        'joints': {name: score._asdict() for name, score in summary.joints.items()},
        'confidence': _confidence(measure_reliability(evaluation), calibrated=calibrated),
        'visibility': {
            name: score._asdict()
            for name, score in score_by_visibility(evaluation, tolerance).items()
        },
    }


def _confidence(reliability: Reliability, *, calibrated: bool) -> dict[str, Any]:
    """Return the reliability of the confidence, for JSON."""
    return {
        'calibrated': calibrated,
        **reliability._asdict(),
        'bins': [each._asdict() for each in reliability.bins],
    }


def evaluation_facts(results: dict[str, Any]) -> dict[str, str]:
    """Return the lines of the report that are no scores, by name."""
    times = results['ms_per_frame']
    facts = {
        'model': Path(results['model']).name,
        'recordings': ', '.join(Path(name).name for name in results['recordings']),
        'graph': 'on' if results['graph'] else 'off',
        'confidence': _words_on(results['confidence']),
        'time a frame': f'{times["p50"]:.1f} ms (95 % within {times["p95"]:.1f} ms)',
    }
    if 'with_offsets' in results:
        moved = results['with_offsets']
        names = ', '.join(Path(name).name for name in moved['offsets_from'])
        facts['with constant offsets'] = (
            f'{100 * moved["map"]:.1f} % within {100 * results["tolerance_m"]:g} cm, mean error '
            f'{100 * moved["mean_error_m"]:.1f} cm (fitted on {names}; not in the plots)'
        )
    return facts


def _words_on(confidence: dict[str, Any]) -> str:
    words = f'off by {100 * confidence["ece"]:.1f} % (expected calibration error)'
    return words if confidence['calibrated'] else f'{words}, not calibrated'


def evaluation_table(results: dict[str, Any]) -> str:
    """Return a table of the scores of each joint, and with offsets if there are any."""
    within = f'within {100 * results["tolerance_m"]:g} cm'
    moved = results.get('with_offsets')
    head = f'{"joint":<12}{"error cm":>9}{within:>16}{"n":>8}'
    lines = [f'{head}{"with offsets: error cm":>25}{within:>16}' if moved else head]
    for name, score in results['joints'].items():
        line = f'{name:<12}{_cells(score["mean_error_m"], score["ap"])}{score["n"]:>8}'
        if moved:
            other = moved['joints'][name]
            line += f'{"":>16}{_cells(other["mean_error_m"], other["ap"])}'
        lines.append(line)
    mean = f'{"mean":<12}{_cells(results["mean_error_m"], results["map"])}'
    if moved:
        mean += f'{"":>24}{_cells(moved["mean_error_m"], moved["map"])}'
    lines.append(mean)
    lines += _visibility_lines(results['visibility'], within)
    times = results['ms_per_frame']
    lines.append(
        f'{results["frames"]} frames, {times["p50"]:.1f} ms a frame '
        f'(95 % within {times["p95"]:.1f} ms)'
    )
    lines.append(f'confidence {_words_on(results["confidence"])}')
    return '\n'.join(lines)


def _visibility_lines(scores: dict[str, Any], within: str) -> list[str]:
    """Return a table of the scores by visibility, without lines if it is not known."""
    if not scores:
        return []
    lines = [f'{"joints":<26}{"error cm":>9}{within:>16}{"confidence":>13}{"n":>8}']
    for name, score in scores.items():
        cells = _cells(score['mean_error_m'], score['ap'])
        confidence = f'{100 * score["mean_confidence"]:>11.1f} %'
        lines.append(f'{name:<26}{cells}{confidence}{score["n"]:>8}')
    return lines


def _cells(error: float, fraction: float) -> str:
    return f'{100 * error:>9.1f}{100 * fraction:>14.1f} %'
