# ruff: noqa: INP001 - part of a program, not of a package
"""The figures of a model's card: how good the model is at what, as JSON and as tables."""

import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.evaluation.confidence_reliability import measure_reliability
from lsc_pose_ros.evaluation.evaluate import Evaluation, evaluate, select, summarise
from lsc_pose_ros.evaluation.offsets import apply_offsets, fit_offsets
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.training.samples import select_joints
from lsc_pose_ros.viz.drawing.canvas import write_beside

TOLERANCE = 0.1

FIFTEEN = numbers_of(
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


class People(NamedTuple):
    """P people who were measured, with what is known of them.

    Attributes:
        evaluation: the errors of their joints.
        yaw: how far they face aside of the camera, degrees from 0 to 180, shape (P,).
        distance: of the torso along the camera's axis, metres, shape (P,).
        recording: in which recording they are, shape (P,).
    """

    evaluation: Evaluation
    yaw: NDArray[np.float64]
    distance: NDArray[np.float64]
    recording: NDArray[np.str_]


def measure(estimator: Estimator, recording: str, frames: Iterable[Frame]) -> People:
    """Return how good `estimator` is at the people of a labelled recording.

    Raises:
        InputError: nobody is labelled.
    """
    views: list[NDArray[np.float64]] = []
    evaluation = evaluate(estimator, _watched(frames, views))
    yaw, distance = np.concatenate(views).T
    return People(evaluation, yaw, distance, np.full(len(yaw), recording))


def _watched(frames: Iterable[Frame], views: list[NDArray[np.float64]]) -> Iterator[Frame]:
    """Yield `frames`; keep the yaw and the distance of the people whom `evaluate` counts."""
    for frame in frames:
        if frame.ground_truth is not None and len(frame.ground_truth.bodies):
            views.append(
                np.stack([yaw_of(frame.ground_truth), distance_of(frame.ground_truth)], axis=1)
            )
        yield frame


def yaw_of(ground_truth: Skeletons) -> NDArray[np.float64]:
    """Return how far each body faces aside of the camera, degrees from 0 to 180, shape (B,).

    By the line from the right to the left shoulder and hip, as seen from above, against the line
    of sight. NaN where these are not labelled.
    """
    names = ('l_shoulder', 'r_shoulder', 'l_hip', 'r_hip')
    places = dict(zip(names, np.moveaxis(_places(ground_truth, names), 1, 0), strict=True))
    left = places['l_shoulder'] - places['r_shoulder'] + places['l_hip'] - places['r_hip']
    # x to the right, z away from the camera: whoever faces it has the left side at its right.
    forward = np.stack([left[:, 2], -left[:, 0]], axis=1)
    middle = np.mean(list(places.values()), axis=0)[:, [0, 2]]
    cosine = -(forward * middle).sum(axis=1) / (
        np.linalg.norm(forward, axis=1) * np.linalg.norm(middle, axis=1)
    )
    yaw: NDArray[np.float64] = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    return yaw


def distance_of(ground_truth: Skeletons) -> NDArray[np.float64]:
    """Return how far each body's torso is along the camera's axis, metres, shape (B,)."""
    return _places(ground_truth, ('torso',))[:, 0, 2]


def _places(ground_truth: Skeletons, names: Sequence[str]) -> NDArray[np.float64]:
    """Return the places of the joints `names`, in that order, shape (B, len(names), 3)."""
    numbers = np.array([numbers_of([name])[0] for name in names], np.uint16)
    return select_joints(ground_truth, numbers).astype(np.float64)


def join(people: Sequence[People]) -> People:
    """Return all of them as one."""
    parts = [each.evaluation for each in people]
    together = parts[0]._replace(
        **{
            name: np.concatenate([getattr(part, name) for part in parts])
            for name in Evaluation._fields
            if name != 'joints'
        }
    )
    return People(
        together,
        *(np.concatenate([getattr(each, name) for each in people]) for name in People._fields[1:]),
    )


def score(evaluation: Evaluation, chosen: NDArray[np.bool_] | None = None) -> dict[str, Any]:
    """Return the figures of those who are `chosen`, shape (P,), or of all: a row of a table."""
    if chosen is not None:
        evaluation = evaluation._replace(
            errors=evaluation.errors[chosen], confidence=evaluation.confidence[chosen]
        )
    summary = summarise(evaluation, TOLERANCE)
    fifteen = [
        each.ap for name, each in summary.joints.items() if numbers_of([name])[0] in FIFTEEN
    ]
    return {
        'people': len(evaluation.errors),
        'mean_error_m': summary.mean_error_m,
        'map': summary.map,
        'map_15': float(np.mean(fifteen)) if fifteen else None,
        **{
            part: _mean_of([s.ap for name, s in summary.joints.items() if name.endswith(part)])
            for part in ('elbow', 'hand', 'knee', 'foot')
        },
        'ece': measure_reliability(evaluation).ece,
    }


def _mean_of(shares: list[float]) -> float | None:
    return float(np.mean(shares)) if shares else None


def joint_scores(evaluation: Evaluation) -> dict[str, Any]:
    """Return the figures of each joint by its name."""
    summary = summarise(evaluation, TOLERANCE)
    return {name: each._asdict() for name, each in summary.joints.items()}


def binned(people: People, values: NDArray[np.float64], edges: Sequence[float]) -> dict[str, Any]:
    """Return the figures of the people in each bin of `values`; bins of nobody are left out."""
    rows = {}
    for low, high in itertools.pairwise(edges):
        chosen = (values >= low) & ((values < high) | (high == edges[-1]))
        if chosen.any():
            rows[f'{low:g} to {high:g}'] = score(people.evaluation, chosen)
    return rows


def by_recording(people: People) -> dict[str, Any]:
    """Return the figures of the people of each recording, in the order of their coming."""
    names = list(dict.fromkeys(people.recording.tolist()))
    return {name: score(people.evaluation, people.recording == name) for name in names}


def real_scores(people: People, fitted: People | None) -> dict[str, Any]:
    """Return the figures of the fifteen joints on real people, with and without offsets.

    Args:
        people: who are measured.
        fitted: those whom the offsets are fitted on; None for no offsets.
    """
    evaluation = select(people.evaluation, _common(people.evaluation))
    rows = {'as they are': score(evaluation)}
    if fitted is not None:
        offsets = fit_offsets(select(fitted.evaluation, evaluation.joints))
        rows['with constant offsets'] = score(apply_offsets(evaluation, offsets))
    return rows


def _common(evaluation: Evaluation) -> NDArray[np.uint16]:
    return FIFTEEN[np.isin(FIFTEEN, evaluation.joints)]


def write_card(results: dict[str, Any], name: str, page: Path) -> None:
    """Put the tables of `results` where `page` has those of the last time: after `name`'s mark.

    Raises:
        InputError: the page cannot be written.
    """
    text = page.read_text(encoding='utf-8')
    pattern = rf'(<!-- figures of {re.escape(name)} -->\n).*?(<!-- end -->)'
    tables = write_tables(results)
    text = re.sub(
        pattern, lambda found: f'{found[1]}\n{tables}\n\n{found[2]}', text, flags=re.DOTALL
    )
    write_beside(page, text.encode())


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
    'views': 'how far aside people face, degrees',
    'distances': 'metres from the camera',
    'recordings': 'recording',
    'real': 'real people, 15 joints',
}


def write_tables(results: dict[str, Any]) -> str:
    """Return the tables of the card in Markdown."""
    tables = [
        _table(
            [title, 'people', 'mean error', *_COLUMNS.values(), 'confidence off by'],
            [[name, *_cells(row)] for name, row in results[part].items()],
        )
        for part, title in _TITLES.items()
        if results.get(part)
    ]
    joints = [
        [name, f'{100 * each["mean_error_m"]:.1f} cm', f'{100 * each["ap"]:.1f} %']
        for name, each in results['joints'].items()
    ]
    return '\n\n'.join([*tables, _table(['joint', 'mean error', 'within 10 cm'], joints)])


def _cells(row: dict[str, Any]) -> list[str]:
    return [
        str(row['people']),
        f'{100 * row["mean_error_m"]:.1f} cm',
        *(_percent(row[column]) for column in _COLUMNS),
        _percent(row['ece']),
    ]


def _percent(share: float | None) -> str:
    return '-' if share is None else f'{100 * share:.1f} %'


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ['---', *('---:' for _ in head[1:])], *rows]
    return '\n'.join(f'| {" | ".join(line)} |' for line in lines)
