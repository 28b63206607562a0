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

"""Checks of claims on artificial errors."""

import numpy as np
import pytest
from lsc_pose_experiments import claims
from lsc_pose_experiments.experiment import (
    MEAN,
    SIZES,
    Axis,
    Experiment,
    Variant,
    fractions_within,
    part_scores,
    points_of,
    rows_of,
)
from lsc_pose_experiments.trial import Accuracy, Trial, TrialResult

from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, names_of, numbers_of
from lsc_pose_ros.training.train import TrainingSettings

JOINTS = numbers_of(DEFAULT_JOINTS)
ENDS = np.array([any(end in n for end in ('elbow', 'wrist', 'hand')) for n in names_of(JOINTS)])
TRIAL = Trial(TrainingSettings(JOINTS), 10)


def result(missed=0.0, ends=0.0, frames=100, people=400, seed=0):
    """Errors of 3 cm, but 30 cm in a fraction of all joints, and of the limb ends."""
    chances = np.random.default_rng(seed).random((people, len(JOINTS)))
    errors = np.where(chances < missed + ends * ENDS, 0.3, 0.03).astype(np.float32)
    return TrialResult(
        JOINTS, errors, np.linspace(0.8, 1.2, people, dtype=np.float32), frames, 1.0
    )


def test_significant_difference_decides_a_claim():
    results = {'a': result(0.02), 'b': result(0.1)}
    assert claims.better('a', 'b', '').judge(results).holds is True
    assert claims.better('b', 'a', '').judge(results).holds is False
    assert 'points' in claims.better('a', 'b', '').judge(results).words


def test_random_difference_leaves_a_claim_undecided():
    results = {'a': result(0.05, people=40), 'b': result(0.055, people=40, seed=1)}
    assert claims.better('a', 'b', '').judge(results).holds is None
    same = {'a': result(0.05), 'b': result(0.05)}
    assert claims.better('a', 'b', '').judge(same).holds is None


def test_differences_are_computed_for_each_person():
    # Some people are hard for both variants; compared with their spread the difference is small.
    hard = result(0.1, people=300)
    for row in range(100):
        hard.errors[row] = 0.4
    errors = hard.errors.copy()
    errors[100:140, 0] = 0.5
    found = claims.difference(hard, hard._replace(errors=errors), 0.1)
    each = fractions_within(hard, 0.1) - fractions_within(hard._replace(errors=errors), 0.1)
    assert found.points == pytest.approx(100 * each.mean())
    assert found.standard_error == pytest.approx(100 * each.std(ddof=1) / np.sqrt(300))
    assert found.clear


def test_best_must_be_better_than_each_other():
    results = {'a': result(0.05), 'b': result(0.1), 'c': result(0.2), 'd': result(0.01)}
    assert claims.best('a', ['b', 'c'], '').judge(results).holds is True
    assert claims.best('a', ['b', 'd'], '').judge(results).holds is False
    assert claims.best('a', ['b', 'a'], '').judge(results).holds is None


def test_gain_is_larger_at_limb_ends():
    results = {'graph': result(0.02), 'none': result(0.04, ends=0.1)}
    assert claims.more_at_limb_ends('graph', 'none', '').judge(results).holds is True
    assert claims.more_at_limb_ends('none', 'graph', '').judge(results).holds is False
    few = {name: claims._only(each, ends=False) for name, each in results.items()}
    assert claims.more_at_limb_ends('graph', 'none', '').judge(few).holds is None


def test_both_numbers_must_reach_the_paper():
    results = {'a': result(0.0)}
    assert claims.reaches('a', 0.95, 0.031, '').judge(results).holds is True
    assert claims.reaches('a', 0.95, 0.029, '').judge(results).holds is False
    assert claims.reaches('a', 1.01, 0.031, '').judge(results).holds is False


def test_one_drop_is_larger_than_another():
    results = {'all': result(0.01), 'much': result(0.2), 'little': result(0.05)}
    assert claims.larger_drop('all', 'much', 'little', '').judge(results).holds is True
    assert claims.larger_drop('all', 'little', 'much', '').judge(results).holds is False


def test_equal_is_within_half_a_point_and_two_millimetres():
    results = {'a': result(0.05), 'b': result(0.05, seed=0), 'c': result(0.07)}
    assert claims.equal(['a', 'b'], '').judge(results).holds is True
    assert claims.equal(['a', 'b', 'c'], '').judge(results).holds is False
    longer = results['a']._replace(errors=results['a'].errors + np.float32(0.003))
    assert claims.equal(['a', 'd'], '').judge(results | {'d': longer}).holds is False


def test_more_frames_must_improve_the_result():
    labels = ['few', 'usual', 'many']
    results = dict(zip(labels, (result(0.2, frames=10), result(0.1), result(0.05, frames=200)),
                        strict=True))  # fmt: skip
    verdict = claims.improves_with_frames(labels, 'usual', '').judge(results)
    assert verdict.holds is True
    assert verdict.words.startswith('200 frames against 100')
    # The recordings have no more frames than the reference, so it is compared with the smallest.
    results['many'] = results['usual']
    assert (
        claims.improves_with_frames(labels, 'usual', '')
        .judge(results)
        .words.startswith('100 frames against 10')
    )
    same = dict.fromkeys(labels, result())
    assert claims.improves_with_frames(labels, 'usual', '').judge(same).holds is None


def test_unlabelled_parts_leave_a_claim_undecided():
    results = {'a': result(0.0)}
    assert claims.part_reaches('a', {'hands': 0.99, 'head': 1.0}, 0.2, '').judge(results).holds
    verdict = claims.part_reaches('a', {'hands': 0.99, 'feet': 0.9}, 0.2, '').judge(results)
    assert verdict.holds is None
    assert 'feet not labelled' in verdict.words
    worse = {'a': result(0.5)}
    assert not claims.part_reaches('a', {'hands': 0.99, 'feet': 0.9}, 0.2, '').judge(worse).holds


def test_parts_are_joints_kinds_and_thirds():
    found = result()
    found.errors[:, 0] = np.linspace(0.01, 0.2, 400)  # the error of the head rises with the size
    found.errors[:, 2] = np.nan  # nobody's torso is labelled
    hands = [names_of(JOINTS).index(name) for name in ('l_hand', 'r_hand')]
    found.errors[:, hands[0]] = np.inf
    scores = part_scores(found, 0.1)
    assert 'torso' not in scores
    people, head = scores['head']
    assert people == 400
    assert head.error == pytest.approx(0.105)
    assert head.fraction == pytest.approx(np.mean(found.errors[:, 0] <= 0.1))
    assert scores['l_hand'][1] == Accuracy(None, 0.0)
    assert scores['hands'][1].fraction == pytest.approx(0.5)
    assert scores['hands'][1].error == pytest.approx(0.03)
    thirds = [scores[size][1].error or 0.0 for size in SIZES]
    assert thirds == sorted(thirds)
    assert [scores[size][0] for size in SIZES] == [134, 133, 133]
    mean = np.nanmean([np.mean(found.errors[:, j] <= 0.1) for j in range(17) if j != 2])
    assert scores[MEAN][1].fraction == pytest.approx(mean)


def test_rows_have_measured_numbers_and_those_of_the_paper():
    experiment = Experiment(
        'x', 'X', '', (
            Variant('theirs', None, {MEAN: Accuracy(0.05, 0.9)}),
            Variant('ours', TRIAL, {MEAN: Accuracy(None, 0.99), 'feet': Accuracy(None, 0.7)}),
        ), (),
    )  # fmt: skip
    rows = {(row.variant, row.part): row for row in rows_of(experiment, {'ours': result()})}
    theirs = rows['theirs', MEAN]
    assert (theirs.ap, theirs.paper_mean_error_m, theirs.paper_ap) == (None, 0.05, 0.9)
    ours = rows['ours', MEAN]
    assert (ours.people, ours.training_frames, ours.ap, ours.paper_ap) == (400, 100, 1.0, 0.99)
    assert rows['ours', 'feet'].paper_ap == 0.7
    assert rows['ours', 'feet'].ap is None


def test_curve_has_each_number_of_frames_once():
    sizes = {'10 frames': 10, '20 frames': 15, '40 frames': 15}
    variants = tuple(Variant(label, TRIAL, x=n) for n, label in enumerate(sizes))
    results = {label: result(frames=count) for label, count in sizes.items()}
    curve = Experiment('x', 'X', '', variants, (), axis=Axis('frames', frames=True))
    rows = rows_of(curve, results)
    means = [(row.x, row.variant) for row in points_of(curve, rows) if row.part == MEAN]
    assert means == [(10, '10 frames'), (15, '20 frames')]
    plain = curve._replace(axis=Axis('N'))
    assert len([row for row in points_of(plain, rows) if row.part == MEAN]) == 3
