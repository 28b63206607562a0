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

"""Whether the paper's claims hold, on made-up errors."""

import numpy as np
import pytest
from lsc_pose_experiments import claims
from lsc_pose_experiments.experiment import (
    MEAN,
    SIZES,
    Axis,
    Experiment,
    Variant,
    part_scores,
    points_of,
    rows_of,
    shares_within,
)
from lsc_pose_experiments.trial import Outcome, Score, Trial

from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, names_of, numbers_of
from lsc_pose_ros.training.train import TrainingSettings

JOINTS = numbers_of(DEFAULT_JOINTS)
ENDS = np.array([any(end in n for end in ('elbow', 'wrist', 'hand')) for n in names_of(JOINTS)])
TRIAL = Trial(TrainingSettings(JOINTS), 10)


def outcome(missed=0.0, ends=0.0, frames=100, people=400, seed=0):
    """Errors of 3 cm, but 30 cm in so large a share of all joints, and of the limb ends."""
    chances = np.random.default_rng(seed).random((people, len(JOINTS)))
    errors = np.where(chances < missed + ends * ENDS, 0.3, 0.03).astype(np.float32)
    return Outcome(JOINTS, errors, np.linspace(0.8, 1.2, people, dtype=np.float32), frames, 1.0)


def test_a_clear_difference_holds_or_does_not():
    outcomes = {'a': outcome(0.02), 'b': outcome(0.1)}
    assert claims.better('a', 'b', '').judge(outcomes).holds is True
    assert claims.better('b', 'a', '').judge(outcomes).holds is False
    assert 'points' in claims.better('a', 'b', '').judge(outcomes).words


def test_a_difference_by_chance_cannot_be_told():
    outcomes = {'a': outcome(0.05, people=40), 'b': outcome(0.055, people=40, seed=1)}
    assert claims.better('a', 'b', '').judge(outcomes).holds is None
    same = {'a': outcome(0.05), 'b': outcome(0.05)}
    assert claims.better('a', 'b', '').judge(same).holds is None


def test_people_are_compared_with_themselves():
    # Some people are hard for both; beside their spread the difference would be nothing.
    hard = outcome(0.1, people=300)
    for row in range(100):
        hard.errors[row] = 0.4
    errors = hard.errors.copy()
    errors[100:140, 0] = 0.5
    found = claims.difference(hard, hard._replace(errors=errors), 0.1)
    each = shares_within(hard, 0.1) - shares_within(hard._replace(errors=errors), 0.1)
    assert found.points == pytest.approx(100 * each.mean())
    assert found.standard_error == pytest.approx(100 * each.std(ddof=1) / np.sqrt(300))
    assert found.clear


def test_the_best_must_be_better_than_each():
    outcomes = {'a': outcome(0.05), 'b': outcome(0.1), 'c': outcome(0.2), 'd': outcome(0.01)}
    assert claims.best('a', ['b', 'c'], '').judge(outcomes).holds is True
    assert claims.best('a', ['b', 'd'], '').judge(outcomes).holds is False
    assert claims.best('a', ['b', 'a'], '').judge(outcomes).holds is None


def test_a_gain_may_be_larger_at_limb_ends():
    outcomes = {'graph': outcome(0.02), 'none': outcome(0.04, ends=0.1)}
    assert claims.more_at_limb_ends('graph', 'none', '').judge(outcomes).holds is True
    assert claims.more_at_limb_ends('none', 'graph', '').judge(outcomes).holds is False
    few = {name: claims._only(each, ends=False) for name, each in outcomes.items()}
    assert claims.more_at_limb_ends('graph', 'none', '').judge(few).holds is None


def test_the_papers_numbers_are_reached_in_both():
    outcomes = {'a': outcome(0.0)}
    assert claims.reaches('a', 0.95, 0.031, '').judge(outcomes).holds is True
    assert claims.reaches('a', 0.95, 0.029, '').judge(outcomes).holds is False
    assert claims.reaches('a', 1.01, 0.031, '').judge(outcomes).holds is False


def test_one_thing_may_matter_more_than_another():
    outcomes = {'all': outcome(0.01), 'much': outcome(0.2), 'little': outcome(0.05)}
    assert claims.larger_drop('all', 'much', 'little', '').judge(outcomes).holds is True
    assert claims.larger_drop('all', 'little', 'much', '').judge(outcomes).holds is False


def test_level_is_within_half_a_point_and_two_millimetres():
    outcomes = {'a': outcome(0.05), 'b': outcome(0.05, seed=0), 'c': outcome(0.07)}
    assert claims.level(['a', 'b'], '').judge(outcomes).holds is True
    assert claims.level(['a', 'b', 'c'], '').judge(outcomes).holds is False
    longer = outcomes['a']._replace(errors=outcomes['a'].errors + np.float32(0.003))
    assert claims.level(['a', 'd'], '').judge(outcomes | {'d': longer}).holds is False


def test_more_frames_must_help():
    labels = ['few', 'usual', 'many']
    outcomes = dict(zip(labels, (outcome(0.2, frames=10), outcome(0.1), outcome(0.05, frames=200)),
                        strict=True))  # fmt: skip
    verdict = claims.grows(labels, 'usual', '').judge(outcomes)
    assert verdict.holds is True
    assert verdict.words.startswith('200 frames beside 100')
    # The recordings have no more than the usual number: the smallest set is the other.
    outcomes['many'] = outcomes['usual']
    assert (
        claims.grows(labels, 'usual', '').judge(outcomes).words.startswith('100 frames beside 10')
    )
    same = dict.fromkeys(labels, outcome())
    assert claims.grows(labels, 'usual', '').judge(same).holds is None


def test_parts_that_are_not_labelled_leave_a_claim_open():
    outcomes = {'a': outcome(0.0)}
    assert claims.part_reaches('a', {'hands': 0.99, 'head': 1.0}, 0.2, '').judge(outcomes).holds
    verdict = claims.part_reaches('a', {'hands': 0.99, 'feet': 0.9}, 0.2, '').judge(outcomes)
    assert verdict.holds is None
    assert 'feet not labelled' in verdict.words
    worse = {'a': outcome(0.5)}
    assert not claims.part_reaches('a', {'hands': 0.99, 'feet': 0.9}, 0.2, '').judge(worse).holds


def test_parts_are_joints_kinds_and_thirds():
    found = outcome()
    found.errors[:, 0] = np.linspace(0.01, 0.2, 400)  # the head of larger people is farther off
    found.errors[:, 2] = np.nan  # nobody's torso is labelled
    hands = [names_of(JOINTS).index(name) for name in ('l_hand', 'r_hand')]
    found.errors[:, hands[0]] = np.inf
    scores = part_scores(found, 0.1)
    assert 'torso' not in scores
    people, head = scores['head']
    assert people == 400
    assert head.error == pytest.approx(0.105)
    assert head.share == pytest.approx(np.mean(found.errors[:, 0] <= 0.1))
    assert scores['l_hand'][1] == Score(None, 0.0)
    assert scores['hands'][1].share == pytest.approx(0.5)
    assert scores['hands'][1].error == pytest.approx(0.03)
    thirds = [scores[size][1].error or 0.0 for size in SIZES]
    assert thirds == sorted(thirds)
    assert [scores[size][0] for size in SIZES] == [134, 133, 133]
    mean = np.nanmean([np.mean(found.errors[:, j] <= 0.1) for j in range(17) if j != 2])
    assert scores[MEAN][1].share == pytest.approx(mean)


def test_rows_have_the_papers_numbers_beside_ours():
    experiment = Experiment(
        'x', 'X', '', (
            Variant('theirs', None, {MEAN: Score(0.05, 0.9)}),
            Variant('ours', TRIAL, {MEAN: Score(None, 0.99), 'feet': Score(None, 0.7)}),
        ), (),
    )  # fmt: skip
    rows = {(row.variant, row.part): row for row in rows_of(experiment, {'ours': outcome()})}
    theirs = rows['theirs', MEAN]
    assert (theirs.ap, theirs.paper_mean_error_m, theirs.paper_ap) == (None, 0.05, 0.9)
    ours = rows['ours', MEAN]
    assert (ours.people, ours.training_frames, ours.ap, ours.paper_ap) == (400, 100, 1.0, 0.99)
    assert rows['ours', 'feet'].paper_ap == 0.7
    assert rows['ours', 'feet'].ap is None


def test_a_curve_of_training_sizes_has_each_size_once():
    sizes = {'10 frames': 10, '20 frames': 15, '40 frames': 15}
    variants = tuple(Variant(label, TRIAL, x=n) for n, label in enumerate(sizes))
    outcomes = {label: outcome(frames=count) for label, count in sizes.items()}
    curve = Experiment('x', 'X', '', variants, (), axis=Axis('frames', frames=True))
    rows = rows_of(curve, outcomes)
    means = [(row.x, row.variant) for row in points_of(curve, rows) if row.part == MEAN]
    assert means == [(10, '10 frames'), (15, '20 frames')]
    plain = curve._replace(axis=Axis('N'))
    assert len([row for row in points_of(plain, rows) if row.part == MEAN]) == 3
