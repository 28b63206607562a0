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

# ruff: noqa: INP001 - part of a program, not of a package
"""The figures of a model's card, as JSON and as tables: accuracy by view, distance and sensor."""

import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from hidden_people import hidden_people_scores, hip_angle_of
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.evaluation.confidence_reliability import measure_reliability
from lsc_pose_ros.evaluation.evaluate import Evaluation, evaluate, select, summarise
from lsc_pose_ros.evaluation.offsets import apply_offsets, fit_offsets
from lsc_pose_ros.files.kinds import TEXT
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.training.samples import select_joints

TOLERANCE = 0.1

COMMON_JOINTS = numbers_of(
    ['head', 'neck', 'torso']
    + [
        f'{side}_{joint}'
        for side in 'lr'
        for joint in ('shoulder', 'elbow', 'hand', 'hip', 'knee', 'foot')
    ]
)
"""The joints that most data sets have."""

YAWS = (0, 30, 60, 90, 120, 150, 180)
DISTANCES = (0, 1.5, 2, 2.5, 3, 3.5, 4, 5, 10)


class EvaluatedPeople(NamedTuple):
    """The evaluation of P people, with their view and distance.

    Attributes:
        evaluation: the errors of their joints.
        yaw: the angle from facing the camera, degrees from 0 to 180, shape (P,).
        distance: depth of the torso, metres, shape (P,).
        hip_angle: the angle between trunk and thighs, degrees, shape (P,).
        recording: the name of each person's recording, shape (P,).
    """

    evaluation: Evaluation
    yaw: NDArray[np.float64]
    distance: NDArray[np.float64]
    hip_angle: NDArray[np.float64]
    recording: NDArray[np.str_]


def measure(estimator: Estimator, recording: str, frames: Iterable[Frame]) -> EvaluatedPeople:
    """Evaluate `estimator` on the people of a labelled recording.

    Raises:
        InputError: nobody is labelled.
    """
    views: list[NDArray[np.float64]] = []
    evaluation = evaluate(estimator, _recording_views(frames, views))
    yaw, distance, hip_angle = np.concatenate(views).T
    return EvaluatedPeople(evaluation, yaw, distance, hip_angle, np.full(len(yaw), recording))


def _recording_views(frames: Iterable[Frame], views: list[NDArray[np.float64]]) -> Iterator[Frame]:
    """Yield `frames`; append the views of the people that `evaluate` counts to `views`."""
    for frame in frames:
        people = frame.ground_truth
        if people is not None and len(people.bodies):
            views.append(np.stack([yaw_of(people), distance_of(people), hip_angle_of(people)], 1))
        yield frame


def yaw_of(ground_truth: Skeletons) -> NDArray[np.float64]:
    """Return the angle of each body from facing the camera, degrees from 0 to 180, shape (B,).

    It is the angle, seen from above, between the line of sight and the normal of the lines from
    the right to the left shoulder and hip. NaN if these joints are not labelled.
    """
    names = ('l_shoulder', 'r_shoulder', 'l_hip', 'r_hip')
    positions = dict(zip(names, np.moveaxis(_positions(ground_truth, names), 1, 0), strict=True))
    left = (
        positions['l_shoulder'] - positions['r_shoulder'] + positions['l_hip'] - positions['r_hip']
    )
    # x to the right, z away from the camera: the left side of a person who faces the camera is at
    # larger x.
    forward = np.stack([left[:, 2], -left[:, 0]], axis=1)
    middle = np.mean(list(positions.values()), axis=0)[:, [0, 2]]
    cosine = -(forward * middle).sum(axis=1) / (
        np.linalg.norm(forward, axis=1) * np.linalg.norm(middle, axis=1)
    )
    yaw: NDArray[np.float64] = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    return yaw


def distance_of(ground_truth: Skeletons) -> NDArray[np.float64]:
    """Return the depth of each body's torso, metres, shape (B,)."""
    return _positions(ground_truth, ('torso',))[:, 0, 2]


def _positions(ground_truth: Skeletons, names: Sequence[str]) -> NDArray[np.float64]:
    """Return the positions of the joints `names`, in that order, shape (B, len(names), 3)."""
    numbers = np.array([numbers_of([name])[0] for name in names], np.uint16)
    return select_joints(ground_truth, numbers).astype(np.float64)


def join(people: Sequence[EvaluatedPeople]) -> EvaluatedPeople:
    """Concatenate several groups of people."""
    parts = [each.evaluation for each in people]
    joined = parts[0]._replace(
        **{
            name: np.concatenate([getattr(part, name) for part in parts])
            for name in Evaluation._fields
            if name != 'joints'
        }
    )
    return EvaluatedPeople(
        joined,
        *(
            np.concatenate([getattr(each, name) for each in people])
            for name in EvaluatedPeople._fields[1:]
        ),
    )


def score(evaluation: Evaluation, chosen: NDArray[np.bool_] | None = None) -> dict[str, Any]:
    """Return the figures of the `chosen` people, shape (P,), or of all: a row of a table."""
    if chosen is not None:
        evaluation = evaluation._replace(
            errors=evaluation.errors[chosen], confidence=evaluation.confidence[chosen]
        )
    summary = summarise(evaluation, TOLERANCE)
    common = [
        each.ap for name, each in summary.joints.items() if numbers_of([name])[0] in COMMON_JOINTS
    ]
    return {
        'people': len(evaluation.errors),
        'mean_error_m': summary.mean_error_m,
        'map': summary.map,
        'map_15': float(np.mean(common)) if common else None,
        **{
            part: _mean_of([s.ap for name, s in summary.joints.items() if name.endswith(part)])
            for part in ('elbow', 'hand', 'knee', 'foot')
        },
        'ece': measure_reliability(evaluation).ece,
    }


def _mean_of(fractions: list[float]) -> float | None:
    return float(np.mean(fractions)) if fractions else None


def joint_scores(evaluation: Evaluation) -> dict[str, Any]:
    """Return the figures of each joint by its name."""
    summary = summarise(evaluation, TOLERANCE)
    return {name: each._asdict() for name, each in summary.joints.items()}


def binned(
    people: EvaluatedPeople, values: NDArray[np.float64], edges: Sequence[float]
) -> dict[str, Any]:
    """Return the figures of the people in each bin of `values`; empty bins are left out."""
    rows = {}
    for low, high in itertools.pairwise(edges):
        chosen = (values >= low) & ((values < high) | (high == edges[-1]))
        if chosen.any():
            rows[f'{low:g} to {high:g}'] = score(people.evaluation, chosen)
    return rows


def by_recording(people: EvaluatedPeople) -> dict[str, Any]:
    """Return the figures of each recording, in their order in `people`."""
    names = list(dict.fromkeys(people.recording.tolist()))
    return {name: score(people.evaluation, people.recording == name) for name in names}


def by_visibility(people: EvaluatedPeople) -> dict[str, Any]:
    """Return the figures of people who are whole, hidden, cut off or seated."""
    return hidden_people_scores(people.evaluation, people.hip_angle, TOLERANCE)


def real_scores(people: EvaluatedPeople, fitted: EvaluatedPeople | None) -> dict[str, Any]:
    """Return the figures of the fifteen joints on real people, with and without offsets.

    Args:
        people: the people to evaluate.
        fitted: the people on whom the offsets are fitted; None for no offsets.
    """
    evaluation = select(people.evaluation, _common(people.evaluation))
    rows = {'without offsets': score(evaluation)}
    if fitted is not None:
        offsets = fit_offsets(select(fitted.evaluation, evaluation.joints))
        rows['with constant offsets'] = score(apply_offsets(evaluation, offsets))
    return rows


def _common(evaluation: Evaluation) -> NDArray[np.uint16]:
    return COMMON_JOINTS[np.isin(COMMON_JOINTS, evaluation.joints)]


def write_card(results: dict[str, Any], name: str, page: Path) -> None:
    """Replace the tables of the model `name` in `page` by those of `results`.

    Raises:
        InputError: the page cannot be written.
    """
    text = page.read_text(encoding='utf-8')
    pattern = rf'(<!-- figures of {re.escape(name)} -->\n).*?(<!-- end -->)'
    tables = write_tables(results)
    text = re.sub(
        pattern, lambda found: f'{found[1]}\n{tables}\n\n{found[2]}', text, flags=re.DOTALL
    )
    write_output(page, TEXT, text.encode())


_COLUMNS = {
    'map': 'mAP, all joints',
    'map_15': 'mAP, 15 joints',
    'elbow': 'elbows',
    'hand': 'hands',
    'knee': 'knees',
    'foot': 'feet',
}

_TITLES = {
    'all': '',
    'views': 'angle from facing the camera, degrees',
    'distances': 'distance from the camera, metres',
    'recordings': 'recording',
    'real': 'real people, 15 joints',
}


def write_tables(results: dict[str, Any]) -> str:
    """Return the tables of the card in Markdown."""
    tables = [
        _table(
            [title, 'people', 'mean error', *_COLUMNS.values(), 'calibration error'],
            [[name, *_cells(row)] for name, row in results[part].items()],
        )
        for part, title in _TITLES.items()
        if results.get(part)
    ]
    if results.get('hidden'):
        tables.append(_hidden_table(results['hidden']))
    joints = [
        [name, f'{100 * each["mean_error_m"]:.1f} cm', f'{100 * each["ap"]:.1f} %']
        for name, each in results['joints'].items()
    ]
    return '\n\n'.join([*tables, _table(['joint', 'mean error', 'within 10 cm'], joints)])


def _hidden_table(rows: dict[str, Any]) -> str:
    columns = {
        'all': 'all joints',
        'seen': 'seen joints',
        'seen_confidence': 'their confidence',
        'unseen': 'hidden and outside joints',
        'unseen_confidence': 'their confidence',
    }
    return _table(
        ['people in rooms, and cut off', 'people', *columns.values()],
        [
            [name, str(row['people']), *(_percent(row[column]) for column in columns)]
            for name, row in rows.items()
        ],
    )


def _cells(row: dict[str, Any]) -> list[str]:
    return [
        str(row['people']),
        f'{100 * row["mean_error_m"]:.1f} cm',
        *(_percent(row[column]) for column in _COLUMNS),
        _percent(row['ece']),
    ]


def _percent(fraction: float | None) -> str:
    return '-' if fraction is None else f'{100 * fraction:.1f} %'


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ['---', *('---:' for _ in head[1:])], *rows]
    return '\n'.join(f'| {" | ".join(line)} |' for line in lines)
