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

"""What a table or a figure of the paper is made of, and its numbers as rows."""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.trial import Outcome, Score, Trial, score_of
from lsc_pose_ros.data_types.joints import names_of

MEAN = 'mean'
SIZES = ('smallest third', 'middle third', 'largest third')
LIMB_ENDS = ('elbows', 'wrists', 'hands')

# What is said of several joints at once, by a word that is in their names.
_KINDS = {
    'shoulders': 'shoulder', 'elbows': 'elbow', 'wrists': 'wrist',
    'hands': 'hand', 'hips': 'hip', 'knees': 'knee', 'ankles': 'ankle', 'feet': 'foot',
}  # fmt: skip


class Variant(NamedTuple):
    """One line of a table, one curve or one point of a curve.

    Attributes:
        label: its name.
        trial: what is measured; None where only the paper's numbers are known.
        paper: the paper's scores by part; what the text does not tell is left out.
        x: its place on the axis of a curve.
    """

    label: str
    trial: Trial | None
    paper: Mapping[str, Score] = {}
    x: float = 0.0


Outcomes = Mapping[str, Outcome]
"""What came of an experiment's variants, by label."""


class Verdict(NamedTuple):
    """Whether a claim holds on these recordings, None where that cannot be told, and why."""

    holds: bool | None
    words: str


class Claim(NamedTuple):
    """What the paper says, and what decides whether it is so."""

    words: str
    judge: Callable[[Outcomes], Verdict]


class Axis(NamedTuple):
    """The axis of a figure that is a curve.

    Attributes:
        name: what varies along it.
        logarithmic: whether it is.
        frames: whether it is the number of training frames; of these there may be fewer than a
            variant asks for.
    """

    name: str
    logarithmic: bool = False
    frames: bool = False


class Experiment(NamedTuple):
    """One table or figure of the paper.

    Attributes:
        name: as on the command line.
        title: as on the page.
        what: what varies, and what the paper says of it, for people to read.
        variants: what is measured.
        claims: what the paper concludes.
        parts: which scores the table on the page shows, besides the mean of all joints.
        axis: of a curve; None for a figure that is joint by joint.
        tolerance: how far a joint may be off to count as found, metres.
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
        variant: its label.
        x: its place on a curve's axis; of training sizes, how many frames were asked for.
        part: `mean` of all joints, a joint, several of a kind, or the people of a size.
        people: how many people were tested and have it labelled.
        training_frames: how many frames were learnt from.
        tolerance_m, mean_error_m, ap: as in `evaluate --json`.
        paper_mean_error_m, paper_ap: the paper's, None where its text does not tell.
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


def rows_of(experiment: Experiment, outcomes: Outcomes) -> list[Row]:
    """Return every score of `experiment`, variant by variant."""
    return [
        row
        for variant in experiment.variants
        if variant.trial is None or variant.label in outcomes
        for row in _rows(variant, outcomes.get(variant.label), experiment.tolerance)
    ]


def _rows(variant: Variant, outcome: Outcome | None, tolerance: float) -> list[Row]:
    found = part_scores(outcome, tolerance) if outcome else {}
    frames = outcome.frames if outcome else 0
    parts = list(found) + [part for part in variant.paper if part not in found]
    return [
        Row(
            variant.label,
            variant.x,
            part,
            found[part][0] if part in found else 0,
            frames,
            tolerance,
            *(found[part][1] if part in found else Score()),
            *variant.paper.get(part, Score()),
        )
        for part in parts
    ]


def part_scores(outcome: Outcome, tolerance: float) -> dict[str, tuple[int, Score]]:
    """Return how many people have each part labelled, and its score.

    The parts are the mean of all joints, each joint, those of a kind, and the thirds of the people
    by size.
    """
    parts = {MEAN: _part(outcome, np.ones(len(outcome.joints), np.bool_), tolerance)}
    names = names_of(outcome.joints)
    for number, name in enumerate(names):
        parts[name] = _part(outcome, np.arange(len(names)) == number, tolerance)
    for kind, word in _KINDS.items():
        mine = np.array([word in name for name in names])
        if mine.any():
            parts[kind] = _part(outcome, mine, tolerance)
    thirds = np.array_split(np.argsort(outcome.sizes, kind='stable'), len(SIZES))
    for size, people in zip(SIZES, thirds, strict=True):
        some = outcome._replace(errors=outcome.errors[people])
        parts[size] = _part(some, np.ones(len(names), np.bool_), tolerance)
    return {part: scored for part, scored in parts.items() if scored is not None}


def _part(
    outcome: Outcome, joints: NDArray[np.bool_], tolerance: float
) -> tuple[int, Score] | None:
    errors = outcome.errors[:, joints]
    people = int((~np.isnan(errors)).any(axis=1).sum())
    if not people:
        return None
    some = outcome._replace(joints=outcome.joints[joints], errors=errors)
    return people, score_of(some, tolerance)


def shares_within(outcome: Outcome, tolerance: float) -> NDArray[np.float64]:
    """Return which share of each person's joints lies within `tolerance` metres, shape (P,)."""
    labelled = ~np.isnan(outcome.errors)
    within = (outcome.errors <= tolerance).sum(axis=1)
    shares: NDArray[np.float64] = within / np.maximum(labelled.sum(axis=1), 1)
    return np.where(labelled.any(axis=1), shares, np.nan)


def points_of(experiment: Experiment, rows: Sequence[Row]) -> list[Row]:
    """Return the scores that a curve goes through.

    Where the recordings have too few frames, the largest training sets are all the same, and only
    the first of them counts.
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
