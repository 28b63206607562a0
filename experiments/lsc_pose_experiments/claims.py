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

"""Checks whether the conclusions of the paper hold on other recordings.

Two variants are tested on the same people, so their difference is computed for each person: it is
significant if its mean is larger than two standard errors. Frames of one motion are similar, so
the number of independent frames is lower than the number of frames, and the standard error is
rather too small.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from lsc_pose_experiments.experiment import (
    Claim,
    TrialResults,
    Verdict,
    fractions_within,
    part_scores,
)
from lsc_pose_experiments.trial import TrialResult
from lsc_pose_ros.data_types.joints import names_of

_STANDARD_ERRORS = 2.0
# Largest differences of variants that count as equal, in points of mAP and in centimetres.
EQUAL_POINTS = 0.5
EQUAL_CM = 0.2

_LIMB_ENDS = ('elbow', 'wrist', 'hand')


class Difference(NamedTuple):
    """The difference of two variants in points of mAP, and its standard error."""

    points: float
    standard_error: float

    @property
    def clear(self) -> bool:
        """Whether the difference is significant."""
        return abs(self.points) > _STANDARD_ERRORS * self.standard_error

    @property
    def words(self) -> str:
        """The difference as text."""
        return f'{self.points:+.1f} ± {self.standard_error:.1f} points'


def difference(first: TrialResult, second: TrialResult, tolerance: float) -> Difference:
    """Return the difference of `first` and `second`, which were tested on the same people."""
    each = fractions_within(first, tolerance) - fractions_within(second, tolerance)
    known = each[~np.isnan(each)]
    spread = float(known.std(ddof=1)) if len(known) > 1 else 0.0
    points = _fraction(first, tolerance) - _fraction(second, tolerance)
    return Difference(points, 100 * spread / max(len(known), 1) ** 0.5)


def better(first: str, second: str, words: str, tolerance: float = 0.1) -> Claim:
    """Claim that the variant `first` has more joints within the tolerance than `second`."""

    def judge(results: TrialResults) -> Verdict:
        return _judge_better(results[first], results[second], tolerance)

    return Claim(words, judge)


def _judge_better(first: TrialResult, second: TrialResult, tolerance: float) -> Verdict:
    found = difference(first, second, tolerance)
    words = (
        f'{_percent(first, tolerance)} against {_percent(second, tolerance)} ({found.words}), '
        f'{_error(first)} against {_error(second)}'
    )
    return Verdict(found.points > 0 if found.clear else None, words)


def best(first: str, others: Sequence[str], words: str) -> Claim:
    """Claim that the variant `first` is better than each of `others`."""

    def judge(results: TrialResults) -> Verdict:
        each = [_judge_better(results[first], results[other], 0.1) for other in others]
        answers = [verdict.holds for verdict in each]
        holds = False if False in answers else None if None in answers else True
        text = [
            f'against {other}: {difference(results[first], results[other], 0.1).words}'
            for other in others
        ]
        return Verdict(holds, f'{_percent(results[first], 0.1)}; {"; ".join(text)}')

    return Claim(words, judge)


def reaches(label: str, fraction: float, error: float, words: str) -> Claim:
    """Claim that a variant has at least this mAP and at most this mean error, in metres."""

    def judge(results: TrialResults) -> Verdict:
        found = results[label]
        points, centimetres = _fraction(found, 0.1) - 100 * fraction, 100 * (_mean(found) - error)
        return Verdict(
            points >= 0 and centimetres <= 0,
            f'{_percent(found, 0.1)} ({points:+.1f} points), '
            f'{_error(found)} ({centimetres:+.1f} cm)',
        )

    return Claim(words, judge)


def more_at_limb_ends(first: str, second: str, words: str) -> Claim:
    """Claim that `first` gains more over `second` at elbows, wrists and hands than elsewhere.

    It is undecided if the recordings label no limb ends, or no other joints.
    """

    def judge(results: TrialResults) -> Verdict:
        ends, others = (
            difference(_only(results[first], ends=ends), _only(results[second], ends=ends), 0.1)
            if _has(results[first], ends=ends)
            else None
            for ends in (True, False)
        )
        if ends is None or others is None:
            return Verdict(None, 'the recordings label no limb ends, or no other joints')
        text = f'{ends.words} at elbows, wrists and hands, {others.words} elsewhere'
        more = ends.points - others.points
        clear = abs(more) > _STANDARD_ERRORS * np.hypot(ends.standard_error, others.standard_error)
        return Verdict((more > 0 and ends.points > 0) if clear else None, text)

    return Claim(words, judge)


def larger_drop(whole: str, first: str, second: str, words: str) -> Claim:
    """Claim that the loss from `whole` to `first` is larger than the loss to `second`."""

    def judge(results: TrialResults) -> Verdict:
        lost = [difference(results[whole], results[label], 0.1) for label in (first, second)]
        between = difference(results[second], results[first], 0.1)
        text = f'{first} loses {lost[0].words}, {second} {lost[1].words}'
        return Verdict(between.points > 0 if between.clear else None, text)

    return Claim(words, judge)


def equal(labels: Sequence[str], words: str) -> Claim:
    """Claim that all variants of `labels` are equal."""

    def judge(results: TrialResults) -> Verdict:
        fractions = [_fraction(results[label], 0.1) for label in labels]
        errors = [100 * _mean(results[label]) for label in labels]
        points, centimetres = max(fractions) - min(fractions), max(errors) - min(errors)
        return Verdict(
            points <= EQUAL_POINTS and centimetres <= EQUAL_CM,
            f'{min(fractions):.1f} to {max(fractions):.1f} %, '
            f'{min(errors):.1f} to {max(errors):.1f} cm '
            f'(equal: within {EQUAL_POINTS:g} points and {EQUAL_CM:g} cm)',
        )

    return Claim(words, judge)


def improves_with_frames(labels: Sequence[str], reference: str, words: str) -> Claim:
    """Claim that the largest training set is better than `reference`.

    If the recordings have no more frames than `reference`, it is compared with the smallest one.
    """

    def judge(results: TrialResults) -> Verdict:
        frames = {label: results[label].frames for label in labels}
        largest = max(labels, key=lambda label: frames[label])
        other = reference if frames[reference] < frames[largest] else labels[0]
        if frames[other] == frames[largest]:
            return Verdict(None, f'the recordings have only {frames[largest]} frames')
        verdict = _judge_better(results[largest], results[other], 0.1)
        sizes = f'{frames[largest]} frames against {frames[other]}: '
        return verdict._replace(words=sizes + verdict.words)

    return Claim(words, judge)


def part_reaches(label: str, parts: dict[str, float], tolerance: float, words: str) -> Claim:
    """Claim that parts of a variant have at least these fractions within the tolerance."""

    def judge(results: TrialResults) -> Verdict:
        found = part_scores(results[label], tolerance)
        fractions = {part: found[part][1].fraction for part in parts if part in found}
        text = [
            f'{part} {100 * (fraction or 0):.1f} % against {100 * parts[part]:.1f} %'
            for part, fraction in fractions.items()
        ]
        text += [f'{part} not labelled' for part in parts if part not in fractions]
        reached = [(fraction or 0) >= parts[part] for part, fraction in fractions.items()]
        holds = None if all(reached) and len(fractions) < len(parts) else all(reached)
        return Verdict(holds, ', '.join(text))

    return Claim(words, judge)


def _fraction(result: TrialResult, tolerance: float) -> float:
    return 100 * (part_scores(result, tolerance)['mean'][1].fraction or 0.0)


def _percent(result: TrialResult, tolerance: float) -> str:
    return f'{_fraction(result, tolerance):.1f} %'


def _mean(result: TrialResult) -> float:
    error = part_scores(result, 0.1)['mean'][1].error
    return float('nan') if error is None else error


def _error(result: TrialResult) -> str:
    return f'{100 * _mean(result):.1f} cm'


def _only(result: TrialResult, *, ends: bool) -> TrialResult:
    chosen = _chosen(result, ends=ends)
    return result._replace(joints=result.joints[chosen], errors=result.errors[:, chosen])


def _has(result: TrialResult, *, ends: bool) -> bool:
    errors = result.errors[:, _chosen(result, ends=ends)]
    return bool((~np.isnan(errors)).any())


def _chosen(result: TrialResult, *, ends: bool) -> list[int]:
    return [
        number
        for number, name in enumerate(names_of(result.joints))
        if any(end in name for end in _LIMB_ENDS) == ends
    ]
