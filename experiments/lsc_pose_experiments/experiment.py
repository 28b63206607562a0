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

"""A table or figure of the paper as data: variants, claims, and results as rows."""

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.trial import Accuracy, Trial, TrialResult, accuracy_of
from lsc_pose_ros.data_types.joints import names_of

MEAN = 'mean'
SIZES = ('smallest third', 'middle third', 'largest third')
LIMB_ENDS = ('elbows', 'wrists', 'hands')

# Kinds of joints, and the word that their names contain.
_KINDS = {
    'shoulders': 'shoulder', 'elbows': 'elbow', 'wrists': 'wrist',
    'hands': 'hand', 'hips': 'hip', 'knees': 'knee', 'ankles': 'ankle', 'feet': 'foot',
}  # fmt: skip


class Variant(NamedTuple):
    """One line of a table, one curve or one point of a curve.

    Attributes:
        label: its name.
        trial: the trial that measures it; None if only the paper's numbers are shown.
        paper: scores of the paper by part, as far as its text gives them.
        x: its position on the axis of a curve.
    """

    label: str
    trial: Trial | None
    paper: Mapping[str, Accuracy] = {}
    x: float = 0.0


TrialResults = Mapping[str, TrialResult]
"""The results of the variants of an experiment, by label."""


class Verdict(NamedTuple):
    """Whether a claim holds on these recordings, None if undecided, and the reason."""

    holds: bool | None
    words: str


class Claim(NamedTuple):
    """A statement of the paper, and the function that checks it."""

    words: str
    judge: Callable[[TrialResults], Verdict]


class Axis(NamedTuple):
    """The axis of a figure that is a curve.

    Attributes:
        name: the quantity.
        logarithmic: whether the axis is logarithmic.
        frames: whether it is the number of training frames, which may be lower than requested.
    """

    name: str
    logarithmic: bool = False
    frames: bool = False


class Experiment(NamedTuple):
    """One table or figure of the paper.

    Attributes:
        name: its name on the command line.
        title: its title on the page.
        what: description of what varies, for the page.
        variants: the lines of the table.
        claims: conclusions of the paper.
        parts: scores that the table on the page shows in addition to the mean of all joints.
        axis: axis of the curve; None for a figure with all joints.
        tolerance: largest error of a found joint, metres.
    """

    name: str
    title: str
    what: str
    variants: tuple[Variant, ...]
    claims: tuple[Claim, ...]
    parts: tuple[str, ...] = LIMB_ENDS
    axis: Axis | None = None
    tolerance: float = 0.1


class Row(NamedTuple):
    """One score of one variant, beside the paper's; the columns of the CSV file.

    Attributes:
        variant: label of the variant.
        x: position on the axis of a curve; for numbers of frames, the requested number.
        part: `mean` of all joints, a joint, a kind of joints, or the people of a size.
        people: number of tested people with the part labelled.
        training_frames: number of training frames.
        tolerance_m, mean_error_m, ap: as in `evaluate --json`.
        paper_mean_error_m, paper_ap: numbers of the paper, None if not in its text.
        frame_ms: median duration of the estimation of a frame, milliseconds.
    """

    variant: str
    x: float
    part: str
    people: int
    training_frames: int
    tolerance_m: float
    mean_error_m: float | None
    ap: float | None
    paper_mean_error_m: float | None
    paper_ap: float | None
    frame_ms: float | None


def rows_of(experiment: Experiment, results: TrialResults) -> list[Row]:
    """Return all scores of `experiment`, ordered by variant."""
    return [
        row
        for variant in experiment.variants
        if variant.trial is None or variant.label in results
        for row in _rows(variant, results.get(variant.label), experiment.tolerance)
    ]


def _rows(variant: Variant, result: TrialResult | None, tolerance: float) -> list[Row]:
    found = part_scores(result, tolerance) if result else {}
    frames = result.frames if result else 0
    parts = list(found) + [part for part in variant.paper if part not in found]
    return [
        Row(
            variant.label,
            variant.x,
            part,
            found[part][0] if part in found else 0,
            frames,
            tolerance,
            *(found[part][1] if part in found else Accuracy()),
            *variant.paper.get(part, Accuracy()),
            result.frame_ms if result else None,
        )
        for part in parts
    ]


def csv_of(rows: Sequence[Row]) -> str:
    """Return `rows` as CSV with a header line; unknown values are empty."""
    text = io.StringIO(newline='')
    writer = csv.writer(text, lineterminator='\n')
    writer.writerow(Row._fields)
    writer.writerows(rows)
    return text.getvalue()


def part_scores(result: TrialResult, tolerance: float) -> dict[str, tuple[int, Accuracy]]:
    """Return the number of people with each part labelled, and its score.

    The parts are the mean of all joints, each joint, each kind of joints, and the thirds of the
    people by size.
    """
    parts = {MEAN: _part(result, np.ones(len(result.joints), np.bool_), tolerance)}
    names = names_of(result.joints)
    for number, name in enumerate(names):
        parts[name] = _part(result, np.arange(len(names)) == number, tolerance)
    for kind, word in _KINDS.items():
        mine = np.array([word in name for name in names])
        if mine.any():
            parts[kind] = _part(result, mine, tolerance)
    thirds = np.array_split(np.argsort(result.sizes, kind='stable'), len(SIZES))
    for size, people in zip(SIZES, thirds, strict=True):
        some = result._replace(errors=result.errors[people])
        parts[size] = _part(some, np.ones(len(names), np.bool_), tolerance)
    return {part: scored for part, scored in parts.items() if scored is not None}


def _part(
    result: TrialResult, joints: NDArray[np.bool_], tolerance: float
) -> tuple[int, Accuracy] | None:
    errors = result.errors[:, joints]
    people = int((~np.isnan(errors)).any(axis=1).sum())
    if not people:
        return None
    some = result._replace(joints=result.joints[joints], errors=errors)
    return people, accuracy_of(some, tolerance)


def fractions_within(result: TrialResult, tolerance: float) -> NDArray[np.float64]:
    """Return the fraction of the joints of each person within `tolerance` metres, shape (P,)."""
    labelled = ~np.isnan(result.errors)
    within = (result.errors <= tolerance).sum(axis=1)
    fractions: NDArray[np.float64] = within / np.maximum(labelled.sum(axis=1), 1)
    return np.where(labelled.any(axis=1), fractions, np.nan)


def points_of(experiment: Experiment, rows: Sequence[Row]) -> list[Row]:
    """Return the scores that are points of a curve.

    If the recordings have too few frames, the largest training sets are equal, and only the first
    of them is drawn.
    """
    if experiment.axis is None or not experiment.axis.frames:
        return list(rows)
    first: dict[int, str] = {}
    for row in rows:
        first.setdefault(row.training_frames, row.variant)
    return [
        row._replace(x=row.training_frames)
        for row in rows
        if first[row.training_frames] == row.variant
    ]
