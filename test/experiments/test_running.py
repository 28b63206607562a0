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

"""Trials: their results, the work that they share, and the stored results."""

import json

import numpy as np
import pytest
from lsc_pose_experiments import running
from lsc_pose_experiments.protocol import DataSelection, FrameSampler, fold_key, folds_of
from lsc_pose_experiments.running import TrialContext, relative_body_sizes, result_of, run_trials
from lsc_pose_experiments.sampled_frames import decode_frames
from lsc_pose_experiments.shotton.part_estimator import PartEstimator
from lsc_pose_experiments.shotton.part_model_training import PartModelSettings, train_part_model
from lsc_pose_experiments.shotton.part_tree_growth import PartGrowth
from lsc_pose_experiments.trial import ResultStore, Trial, TrialResult, join_results, trial_key
from lsc_pose_experiments.walks.direction_tree_growth import DirectionGrowth
from lsc_pose_experiments.walks.walk_estimator import WalkEstimator
from lsc_pose_experiments.walks.walk_training import WalkModelSettings, train_walk_model

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

BODY_PARTS = PartModelSettings(2, PartGrowth(10, features=20), 100, 50)
WALKS = WalkModelSettings(points=20, growth=DirectionGrowth(depth=10, features=20))


@pytest.fixture
def context(tmp_path, people):
    """A context with one recording of 100 frames."""
    path = tmp_path / 'people.mcap'
    path.write_bytes(b'')
    return TrialContext(
        DataSelection((path,), test_frames=20),
        ResultStore(tmp_path / 'trials'),
        lambda _: people[:100],
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
def test_trial_is_a_training_and_an_evaluation(trial, frames, context):
    # Another trial first, with which it shares work.
    assert len(list(run_trials(context, [Trial(changed(heaviest_votes=3), 60), trial]))) == 2
    found = result_of(context, trial)
    (fold,) = folds_of(context.selection)
    drawn = FrameSampler(context.selection, 1000, context.read).frames(fold)
    model = train(decode_frames(drawn.train[: trial.frames]), trial.training, {})
    wanted = evaluate(Estimator(model, graph=trial.graph), decode_frames(drawn.test))
    np.testing.assert_array_equal(found.errors, wanted.errors)
    np.testing.assert_array_equal(found.joints, wanted.joints)
    assert found.frames == frames
    assert len(found.errors) == 20


@pytest.mark.parametrize(
    ('settings', 'train_model', 'estimator'),
    [
        (BODY_PARTS, train_part_model, PartEstimator),
        (WALKS, train_walk_model, WalkEstimator),
    ],
)
def test_trial_of_a_rival_is_a_training_and_an_evaluation(
    settings, train_model, estimator, context
):
    rival = Trial(SMALL, 30, graph=False, rival=settings)
    assert list(run_trials(context, [rival, Trial(SMALL, 30)])) == [Trial(SMALL, 30), rival]
    found = result_of(context, rival)
    (fold,) = folds_of(context.selection)
    drawn = FrameSampler(context.selection, 1000, context.read).frames(fold)
    model = train_model(drawn.train[:30], SMALL.joints, settings, SMALL.seed)
    wanted = evaluate(estimator(model), decode_frames(drawn.test))
    np.testing.assert_array_equal(found.errors, wanted.errors)
    np.testing.assert_array_equal(found.joints, model.joints)
    assert found.frames == 30


def test_time_of_a_frame_is_measured(context):
    list(run_trials(context, [Trial(SMALL, 10)]))
    frame_ms = result_of(context, Trial(SMALL, 10)).frame_ms
    assert frame_ms is not None
    assert 0 < frame_ms < 1e4


def test_shared_work_is_done_once(context, monkeypatch):
    calls = {'labelled_people_in': 0, 'train_on': 0, 'evaluate': 0}
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
        Trial(SMALL, 30),  # again
    ]
    assert len(list(run_trials(context, trials))) == 6
    assert calls == {'labelled_people_in': 30, 'train_on': 3, 'evaluate': 6}
    assert names_of(result_of(context, trials[5]).joints) == ['head', 'l_foot']


def test_finished_trials_are_not_repeated(context):
    trials = [Trial(SMALL, 20), Trial(SMALL, 20, graph=False)]
    first = next(run_trials(context, trials))  # interrupted after one
    assert result_of(context, trials[1]) is None
    before = result_of(context, first)
    again = context._replace(store=ResultStore(context.store._folder))
    assert list(run_trials(again, trials)) == [trials[1]]
    np.testing.assert_array_equal(result_of(again, first).errors, before.errors)

    def refuse(path):
        raise AssertionError(path)

    third = again._replace(store=ResultStore(context.store._folder), read=refuse)
    assert list(run_trials(third, trials)) == []
    assert result_of(third, trials[1]) is not None


def test_each_recording_is_tested_with_a_model_of_the_others(tmp_path, people):
    paths = tuple(tmp_path / f'{n}.mcap' for n in range(3))
    for path in paths:
        path.write_bytes(b'')
    frames = {path: people[60 * n : 60 * n + 30] for n, path in enumerate(paths)}
    selection = DataSelection(paths, protocol='leave-one-out', test_frames=10)
    context = TrialContext(selection, ResultStore(tmp_path / 'trials'), frames.__getitem__)
    trial = Trial(SMALL, 50)
    assert len(list(run_trials(context, [trial]))) == 3
    result = result_of(context, trial)
    assert result.errors.shape == (30, 5)
    assert result.frames == 50
    next((tmp_path / 'trials').iterdir()).unlink()
    context = context._replace(store=ResultStore(tmp_path / 'trials'))
    assert result_of(context, trial) is None
    assert len(list(run_trials(context, [trial]))) == 1
    np.testing.assert_array_equal(result_of(context, trial).errors, result.errors)


def test_joints_that_are_never_labelled_are_left_out(context, people):
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

    context = context._replace(read=lambda _: map(without_elbow, people[:40]))
    list(run_trials(context, [Trial(SMALL, 30)]))
    found = names_of(result_of(context, Trial(SMALL, 30)).joints)
    assert found == ['head', 'neck', 'l_shoulder', 'l_knee']


def test_sizes_are_relative_lengths_of_limbs(people):
    frame = people[0]
    ground_truth = frame.ground_truth
    larger = frame._replace(
        ground_truth=ground_truth._replace(positions=1.5 * ground_truth.positions)
    )
    partly = ground_truth.positions.copy()
    partly[:, 6:] = np.nan
    frames = [frame, larger, frame._replace(ground_truth=ground_truth._replace(positions=partly))]
    sizes = relative_body_sizes(frames)
    assert sizes[1] / sizes[0] == pytest.approx(1.5, rel=1e-3)
    assert sizes[2] == pytest.approx(sizes[0], rel=0.1)
    assert sizes[:2].mean() == pytest.approx(1, abs=0.1)


@pytest.fixture
def result():
    """Two people, three joints: known, not estimated, not labelled."""
    errors = np.array([[0.01, np.inf, np.nan], [0.123456, 0.2, 0.3]], np.float32)
    return TrialResult(
        numbers_of(['head', 'neck', 'l_hand']), errors, np.ones(2, np.float32), 7, 1.5, 12.5
    )


def test_stored_result_is_exact(result, tmp_path):
    key = {'a': [1, 2.5], 'b': None}
    ResultStore(tmp_path / 'trials').save(key, result)
    found = ResultStore(tmp_path / 'trials').load(key)
    for name in TrialResult._fields:
        np.testing.assert_array_equal(getattr(found, name), getattr(result, name))
    assert ResultStore(tmp_path / 'trials').load(key | {'b': 1}) is None
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
def test_damaged_file_is_ignored(damage, result, tmp_path):
    store = ResultStore(tmp_path)
    store.save({'a': 1}, result)
    (path,) = tmp_path.iterdir()
    path.write_text(damage(path.read_text()))
    assert ResultStore(tmp_path).load({'a': 1}) is None
    store.save({'a': 1}, result)
    assert ResultStore(tmp_path).load({'a': 1}) is not None


def test_results_of_different_joints_are_joined(result):
    other = result._replace(
        joints=numbers_of(['neck', 'r_hand']),
        errors=np.ones((2, 2), np.float32),
        frames=9,
        frame_ms=13.5,
    )
    joined = join_results([result, other])
    assert names_of(joined.joints) == ['head', 'neck', 'l_hand', 'r_hand']
    np.testing.assert_array_equal(joined.errors[:2, :3], result.errors)
    np.testing.assert_array_equal(joined.errors[2:, [1, 3]], 1)
    assert np.isnan(joined.errors).sum() == 1 + 2 + 4
    assert (joined.frames, joined.seconds, joined.frame_ms) == (8, 3.0, 13.0)
    assert join_results([result, other._replace(frame_ms=None)]).frame_ms is None


def test_key_changes_with_each_setting(context):
    (fold,) = folds_of(context.selection)
    key = fold_key(context.selection, fold)
    trials = [
        Trial(SMALL, 60),
        Trial(SMALL, 61),
        Trial(SMALL, 60, graph=False),
        Trial(changed(binning='nearest'), 60),
        Trial(changed(fixed_scale=0.3), 60),
        Trial(SMALL._replace(growth=GrowthSettings(depth=7)), 60),
        Trial(SMALL._replace(leaves=SMALL.leaves._replace(clusters=1)), 60),
        Trial(SMALL._replace(seed=4), 60),
        Trial(SMALL, 60, rival=BODY_PARTS),
        Trial(SMALL, 60, rival=BODY_PARTS._replace(pixels=99)),
        Trial(SMALL, 60, rival=WALKS),
        Trial(SMALL, 60, rival=WALKS._replace(points=21)),
        Trial(SMALL._replace(joints=SMALL.joints[:-1]), 60),
    ]
    keys = [json.dumps(trial_key(key, trial)) for trial in trials]
    assert len(set(keys)) == len(trials)
    assert keys[0] == json.dumps(trial_key(key, Trial(SMALL, 60)))
