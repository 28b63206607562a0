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

"""Trials: what comes of them, what they share, and what is kept."""

import json

import numpy as np
import pytest
from lsc_pose_experiments import running
from lsc_pose_experiments.drawn_frames import restore
from lsc_pose_experiments.protocol import Draws, Study, fold_key, folds_of
from lsc_pose_experiments.running import Bench, outcome_of, people_sizes, run_trials
from lsc_pose_experiments.trial import Outcome, Store, Trial, join_outcomes, trial_key

from lsc_pose_ros.data_types.joints import names_of, numbers_of
from lsc_pose_ros.evaluation.evaluate import evaluate
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.training.train import TrainingSettings, train
from lsc_pose_ros.training.tree_growth import GrowthSettings

SMALL = TrainingSettings(
    numbers_of(['head', 'neck', 'l_shoulder', 'l_elbow', 'l_knee']),
    Settings(points=80, query_points=50),
    trees=2,
    growth=GrowthSettings(depth=8),
    seed=3,
    hold_out=0.0,
)


@pytest.fixture
def bench(tmp_path, people):
    """A bench with one recording of 100 frames."""
    path = tmp_path / 'people.mcap'
    path.write_bytes(b'')
    return Bench(
        Study((path,), test_frames=20), Store(tmp_path / 'trials'), lambda _: people[:100]
    )


def changed(**settings):
    return SMALL._replace(settings=SMALL.settings._replace(**settings))


@pytest.mark.parametrize(
    ('trial', 'frames'),
    [
        (Trial(SMALL, 60), 60),
        (Trial(SMALL, 25, graph=False), 25),
        (Trial(changed(feature='dcf', sample='body'), 1000, graph=False), 80),
        (Trial(changed(heaviest_votes=5, query_points=20), 60), 60),
    ],
)
def test_a_trial_is_a_training_and_an_evaluation(trial, frames, bench):
    # Another trial first, which shares what it can.
    assert len(list(run_trials(bench, [Trial(changed(heaviest_votes=3), 60), trial]))) == 2
    found = outcome_of(bench, trial)
    (fold,) = folds_of(bench.study)
    drawn = Draws(bench.study, 1000, bench.read).frames(fold)
    model = train(restore(drawn.train[: trial.frames]), trial.training, {})
    wanted = evaluate(Estimator(model, graph=trial.graph), restore(drawn.test))
    np.testing.assert_array_equal(found.errors, wanted.errors)
    np.testing.assert_array_equal(found.joints, wanted.joints)
    assert found.frames == frames
    assert len(found.errors) == 20


def test_what_trials_share_is_done_once(bench, monkeypatch):
    calls = {'people_in': 0, 'train_on': 0, 'evaluate': 0}
    for name in calls:
        original = getattr(running, name)

        def count(*arguments, _name=name, _original=original, **more):
            calls[_name] += 1
            return _original(*arguments, **more)

        monkeypatch.setattr(running, name, count)
    feet = SMALL._replace(joints=numbers_of(['head', 'l_foot']))
    trials = [
        Trial(SMALL, 30),
        Trial(SMALL, 30, graph=False),
        Trial(changed(heaviest_votes=1), 30),
        Trial(changed(query_points=10), 30),
        Trial(SMALL, 15),
        Trial(feet, 30),
        Trial(SMALL, 30),  # once more
    ]
    assert len(list(run_trials(bench, trials))) == 6
    assert calls == {'people_in': 30, 'train_on': 3, 'evaluate': 6}
    assert names_of(outcome_of(bench, trials[5]).joints) == ['head', 'l_foot']


def test_what_is_finished_is_not_done_again(bench):
    trials = [Trial(SMALL, 20), Trial(SMALL, 20, graph=False)]
    first = next(run_trials(bench, trials))  # interrupted after one
    assert outcome_of(bench, trials[1]) is None
    before = outcome_of(bench, first)
    again = bench._replace(store=Store(bench.store._folder))
    assert list(run_trials(again, trials)) == [trials[1]]
    np.testing.assert_array_equal(outcome_of(again, first).errors, before.errors)

    def refuse(path):
        raise AssertionError(path)

    third = again._replace(store=Store(bench.store._folder), read=refuse)
    assert list(run_trials(third, trials)) == []
    assert outcome_of(third, trials[1]) is not None


def test_each_recording_is_tested_by_what_the_others_teach(tmp_path, people):
    paths = tuple(tmp_path / f'{n}.mcap' for n in range(3))
    for path in paths:
        path.write_bytes(b'')
    frames = {path: people[60 * n : 60 * n + 30] for n, path in enumerate(paths)}
    study = Study(paths, protocol='leave-one-out', test_frames=10)
    bench = Bench(study, Store(tmp_path / 'trials'), frames.__getitem__)
    trial = Trial(SMALL, 50)
    assert len(list(run_trials(bench, [trial]))) == 3
    outcome = outcome_of(bench, trial)
    assert outcome.errors.shape == (30, 5)
    assert outcome.frames == 50
    next((tmp_path / 'trials').iterdir()).unlink()
    bench = bench._replace(store=Store(tmp_path / 'trials'))
    assert outcome_of(bench, trial) is None
    assert len(list(run_trials(bench, [trial]))) == 1
    np.testing.assert_array_equal(outcome_of(bench, trial).errors, outcome.errors)


def test_joints_that_nobody_labels_are_left_out(bench, people):
    kept = [number for number in range(20) if number != 5]

    def without_elbow(frame):
        ground_truth = frame.ground_truth
        return frame._replace(
            ground_truth=ground_truth._replace(
                joints=ground_truth.joints[kept],
                positions=ground_truth.positions[:, kept],
                confidence=ground_truth.confidence[:, kept],
            )
        )

    bench = bench._replace(read=lambda _: map(without_elbow, people[:40]))
    list(run_trials(bench, [Trial(SMALL, 30)]))
    found = names_of(outcome_of(bench, Trial(SMALL, 30)).joints)
    assert found == ['head', 'neck', 'l_shoulder', 'l_knee']


def test_sizes_are_those_of_the_limbs(people):
    frame = people[0]
    ground_truth = frame.ground_truth
    larger = frame._replace(
        ground_truth=ground_truth._replace(positions=1.5 * ground_truth.positions)
    )
    partly = ground_truth.positions.copy()
    partly[:, 6:] = np.nan
    frames = [frame, larger, frame._replace(ground_truth=ground_truth._replace(positions=partly))]
    sizes = people_sizes(frames)
    assert sizes[1] / sizes[0] == pytest.approx(1.5, rel=1e-3)
    assert sizes[2] == pytest.approx(sizes[0], rel=0.1)
    assert sizes[:2].mean() == pytest.approx(1, abs=0.1)


@pytest.fixture
def outcome():
    """Two people, three joints: known, not estimated, not labelled."""
    errors = np.array([[0.01, np.inf, np.nan], [0.123456, 0.2, 0.3]], np.float32)
    return Outcome(numbers_of(['head', 'neck', 'l_hand']), errors, np.ones(2, np.float32), 7, 1.5)


def test_an_outcome_is_kept_exactly(outcome, tmp_path):
    key = {'a': [1, 2.5], 'b': None}
    Store(tmp_path / 'trials').save(key, outcome)
    found = Store(tmp_path / 'trials').load(key)
    for name in Outcome._fields:
        np.testing.assert_array_equal(getattr(found, name), getattr(outcome, name))
    assert Store(tmp_path / 'trials').load(key | {'b': 1}) is None
    (path,) = (tmp_path / 'trials').iterdir()
    table = json.loads(path.read_text())
    assert table['key'] == key
    assert table['joints'] == ['head', 'neck', 'l_hand']


@pytest.mark.parametrize(
    'damage',
    [
        lambda text: text[: len(text) // 2],
        lambda _: '',
        lambda _: '[]',
        lambda text: text.replace('"frames": 7', '"frames": "many"'),
        lambda text: text.replace('"head"', '"nose"'),
        lambda text: text.replace('"errors": "', '"errors": "AAAA'),
        lambda text: text.replace('"sizes": "', '"sizes": "%'),
    ],
)
def test_a_damaged_file_is_as_none(damage, outcome, tmp_path):
    store = Store(tmp_path)
    store.save({'a': 1}, outcome)
    (path,) = tmp_path.iterdir()
    path.write_text(damage(path.read_text()))
    assert Store(tmp_path).load({'a': 1}) is None
    store.save({'a': 1}, outcome)
    assert Store(tmp_path).load({'a': 1}) is not None


def test_outcomes_of_different_joints_are_joined(outcome):
    other = outcome._replace(
        joints=numbers_of(['neck', 'r_hand']), errors=np.ones((2, 2), np.float32), frames=9
    )
    joined = join_outcomes([outcome, other])
    assert names_of(joined.joints) == ['head', 'neck', 'l_hand', 'r_hand']
    np.testing.assert_array_equal(joined.errors[:2, :3], outcome.errors)
    np.testing.assert_array_equal(joined.errors[2:, [1, 3]], 1)
    assert np.isnan(joined.errors).sum() == 1 + 2 + 4
    assert (joined.frames, joined.seconds) == (8, 3.0)


def test_a_key_changes_with_every_setting(bench):
    (fold,) = folds_of(bench.study)
    key = fold_key(bench.study, fold)
    trials = [
        Trial(SMALL, 60),
        Trial(SMALL, 61),
        Trial(SMALL, 60, graph=False),
        Trial(changed(binning='nearest'), 60),
        Trial(changed(fixed_scale=0.3), 60),
        Trial(SMALL._replace(growth=GrowthSettings(depth=7)), 60),
        Trial(SMALL._replace(leaves=SMALL.leaves._replace(clusters=1)), 60),
        Trial(SMALL._replace(seed=4), 60),
        Trial(SMALL._replace(joints=SMALL.joints[:-1]), 60),
    ]
    keys = [json.dumps(trial_key(key, trial)) for trial in trials]
    assert len(set(keys)) == len(trials)
    assert keys[0] == json.dumps(trial_key(key, Trial(SMALL, 60)))
