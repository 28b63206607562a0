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

"""How it is decided whether what the paper concludes is so on other recordings.

Two variants are tested on the same people, so their difference is judged person by person: it
counts where it is larger than two standard errors. Frames of one motion are alike, so that there
are fewer independent ones than there are frames, and the standard error is rather too small.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from lsc_pose_experiments.experiment import (
    Claim,
    Outcomes,
    Verdict,
    part_scores,
    shares_within,
)
from lsc_pose_experiments.trial import Outcome
from lsc_pose_ros.data_types.joints import names_of

_STANDARD_ERRORS = 2.0
# What still counts as the same, in points of mAP and in centimetres.
LEVEL_POINTS = 0.5
LEVEL_CM = 0.2

_LIMB_ENDS = ('elbow', 'wrist', 'hand')


class Difference(NamedTuple):
    """How many points of mAP one variant has more than another, and the standard error."""

    points: float
    standard_error: float

    @property
    def clear(self) -> bool:
        """Whether it is more than chance."""
        return abs(self.points) > _STANDARD_ERRORS * self.standard_error

    @property
    def words(self) -> str:
        """The difference for people to read."""
        return f'{self.points:+.1f} ± {self.standard_error:.1f} points'


def difference(first: Outcome, second: Outcome, tolerance: float) -> Difference:
    """Return how much better `first` is than `second`, which was tested on the same people."""
    each = shares_within(first, tolerance) - shares_within(second, tolerance)
    known = each[~np.isnan(each)]
    spread = float(known.std(ddof=1)) if len(known) > 1 else 0.0
    points = _share(first, tolerance) - _share(second, tolerance)
    return Difference(points, 100 * spread / max(len(known), 1) ** 0.5)


def better(first: str, second: str, words: str, tolerance: float = 0.1) -> Claim:
    """Claim that the variant `first` has more joints within the tolerance than `second`."""

    def judge(outcomes: Outcomes) -> Verdict:
        return _judge_better(outcomes[first], outcomes[second], tolerance)

    return Claim(words, judge)


def _judge_better(first: Outcome, second: Outcome, tolerance: float) -> Verdict:
    found = difference(first, second, tolerance)
    words = (
        f'{_percent(first, tolerance)} against {_percent(second, tolerance)} ({found.words}), '
        f'{_error(first)} against {_error(second)}'
    )
    return Verdict(found.points > 0 if found.clear else None, words)


def best(first: str, others: Sequence[str], words: str) -> Claim:
    """Claim that the variant `first` is better than each of `others`."""

    def judge(outcomes: Outcomes) -> Verdict:
        each = [_judge_better(outcomes[first], outcomes[other], 0.1) for other in others]
        answers = [verdict.holds for verdict in each]
        holds = False if False in answers else None if None in answers else True
        spoken = [
            f'beside {other}: {difference(outcomes[first], outcomes[other], 0.1).words}'
            for other in others
        ]
        return Verdict(holds, f'{_percent(outcomes[first], 0.1)}; {"; ".join(spoken)}')

    return Claim(words, judge)


def reaches(label: str, share: float, error: float, words: str) -> Claim:
    """Claim that a variant has at least this mAP and at most this mean error, metres."""

    def judge(outcomes: Outcomes) -> Verdict:
        found = outcomes[label]
        points, centimetres = _share(found, 0.1) - 100 * share, 100 * (_mean(found) - error)
        return Verdict(
            points >= 0 and centimetres <= 0,
            f'{_percent(found, 0.1)} ({points:+.1f} points), '
            f'{_error(found)} ({centimetres:+.1f} cm)',
        )

    return Claim(words, judge)


def more_at_limb_ends(first: str, second: str, words: str) -> Claim:
    """Claim that `first` is better than `second` by more at elbows, wrists, hands than elsewhere.

    It cannot be told where `first` is no better at the limb ends, or no other joints are labelled.
    """

    def judge(outcomes: Outcomes) -> Verdict:
        ends, others = (
            difference(_only(outcomes[first], ends=ends), _only(outcomes[second], ends=ends), 0.1)
            if _has(outcomes[first], ends=ends)
            else None
            for ends in (True, False)
        )
        if ends is None or others is None:
            return Verdict(None, 'the recordings label no limb ends, or nothing else')
        spoken = f'{ends.words} at elbows, wrists and hands, {others.words} elsewhere'
        more = ends.points - others.points
        clear = abs(more) > _STANDARD_ERRORS * np.hypot(ends.standard_error, others.standard_error)
        return Verdict((more > 0 and ends.points > 0) if clear else None, spoken)

    return Claim(words, judge)


def larger_drop(whole: str, first: str, second: str, words: str) -> Claim:
    """Claim that `first` loses more of what `whole` has than `second` does."""

    def judge(outcomes: Outcomes) -> Verdict:
        lost = [difference(outcomes[whole], outcomes[label], 0.1) for label in (first, second)]
        between = difference(outcomes[second], outcomes[first], 0.1)
        spoken = f'{first} loses {lost[0].words}, {second} {lost[1].words}'
        return Verdict(between.points > 0 if between.clear else None, spoken)

    return Claim(words, judge)


def level(labels: Sequence[str], words: str) -> Claim:
    """Claim that all variants of `labels` are as good as each other."""

    def judge(outcomes: Outcomes) -> Verdict:
        shares = [_share(outcomes[label], 0.1) for label in labels]
        errors = [100 * _mean(outcomes[label]) for label in labels]
        points, centimetres = max(shares) - min(shares), max(errors) - min(errors)
        return Verdict(
            points <= LEVEL_POINTS and centimetres <= LEVEL_CM,
            f'{min(shares):.1f} to {max(shares):.1f} %, {min(errors):.1f} to {max(errors):.1f} cm '
            f'(the same: within {LEVEL_POINTS:g} points and {LEVEL_CM:g} cm)',
        )

    return Claim(words, judge)


def grows(labels: Sequence[str], reference: str, words: str) -> Claim:
    """Claim that the largest training set is better than `reference`, or than the smallest one.

    The latter where the recordings have no more frames than `reference` asks for.
    """

    def judge(outcomes: Outcomes) -> Verdict:
        frames = {label: outcomes[label].frames for label in labels}
        largest = max(labels, key=lambda label: frames[label])
        other = reference if frames[reference] < frames[largest] else labels[0]
        if frames[other] == frames[largest]:
            return Verdict(None, f'the recordings have only {frames[largest]} frames')
        verdict = _judge_better(outcomes[largest], outcomes[other], 0.1)
        sizes = f'{frames[largest]} frames beside {frames[other]}: '
        return verdict._replace(words=sizes + verdict.words)

    return Claim(words, judge)


def part_reaches(label: str, parts: dict[str, float], tolerance: float, words: str) -> Claim:
    """Claim that these parts of a variant have at least these shares within the tolerance."""

    def judge(outcomes: Outcomes) -> Verdict:
        found = part_scores(outcomes[label], tolerance)
        shares = {part: found[part][1].share for part in parts if part in found}
        spoken = [
            f'{part} {100 * (share or 0):.1f} % beside {100 * parts[part]:.1f} %'
            for part, share in shares.items()
        ]
        spoken += [f'{part} not labelled' for part in parts if part not in shares]
        reached = [(share or 0) >= parts[part] for part, share in shares.items()]
        holds = None if all(reached) and len(shares) < len(parts) else all(reached)
        return Verdict(holds, ', '.join(spoken))

    return Claim(words, judge)


def _share(outcome: Outcome, tolerance: float) -> float:
    return 100 * (part_scores(outcome, tolerance)['mean'][1].share or 0.0)


def _percent(outcome: Outcome, tolerance: float) -> str:
    return f'{_share(outcome, tolerance):.1f} %'


def _mean(outcome: Outcome) -> float:
    error = part_scores(outcome, 0.1)['mean'][1].error
    return float('nan') if error is None else error


def _error(outcome: Outcome) -> str:
    return f'{100 * _mean(outcome):.1f} cm'


def _only(outcome: Outcome, *, ends: bool) -> Outcome:
    chosen = _chosen(outcome, ends=ends)
    return outcome._replace(joints=outcome.joints[chosen], errors=outcome.errors[:, chosen])


def _has(outcome: Outcome, *, ends: bool) -> bool:
    errors = outcome.errors[:, _chosen(outcome, ends=ends)]
    return bool((~np.isnan(errors)).any())


def _chosen(outcome: Outcome, *, ends: bool) -> list[int]:
    return [
        number
        for number, name in enumerate(names_of(outcome.joints))
        if any(end in name for end in _LIMB_ENDS) == ends
    ]
