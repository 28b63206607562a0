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

import numpy as np
import pytest

from lsc_pose_ros.evaluation.confidence_reliability import measure_reliability
from lsc_pose_ros.evaluation.evaluate import evaluate
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.inference.confidence import KNOTS, vote_fractions
from lsc_pose_ros.synthetic.generator import synthetic_frames
from lsc_pose_ros.training.calibration import (
    CalibrationData,
    calibrate,
    fit_calibration,
    gather_calibration_data,
    pool_adjacent_violators,
)
from lsc_pose_ros.training.samples import held_out_mask, labelled_people, split_samples
from lsc_pose_ros.training.train import train


def plain_isotonic(values, weights):
    """The max-min formula: over all starts before k, of the least mean over all ends after it."""
    count = len(values)
    means = np.array(
        [
            [
                np.average(values[i : j + 1], weights=weights[i : j + 1]) if j >= i else np.nan
                for j in range(count)
            ]
            for i in range(count)
        ]
    )
    return [max(min(means[i, k:]) for i in range(k + 1)) for k in range(count)]


@pytest.mark.parametrize('seed', range(8))
def test_pooling_gives_the_non_decreasing_fit(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 30))
    values = np.round(rng.random(count) + 0.03 * np.arange(count) * (seed % 3), seed % 2 + 1)
    weights = rng.uniform(0.1, 5, count)
    found = pool_adjacent_violators(values, weights)
    np.testing.assert_allclose(found, plain_isotonic(values, weights), atol=1e-12)


def test_pooling_of_increasing_and_of_decreasing_values():
    ones = np.ones(4)
    rising = np.array([0.1, 0.1, 0.4, 0.9])
    np.testing.assert_allclose(pool_adjacent_violators(rising, ones), rising)
    np.testing.assert_allclose(pool_adjacent_violators(rising[::-1], ones), np.full(4, 0.375))
    assert len(pool_adjacent_violators(np.zeros(0), np.zeros(0))) == 0


def made_up(people, joints=3, seed=0):
    """Return data with a known probability: the square root of the vote fraction."""
    rng = np.random.default_rng(seed)
    fractions = rng.random((people, joints)).astype(np.float32)
    near = (rng.random(fractions.shape) < np.sqrt(fractions)).astype(np.float32)
    return CalibrationData(fractions, near)


def test_known_probability_is_found():
    found = fit_calibration(made_up(20_000))
    assert found.shape == (3, KNOTS)
    expected = np.sqrt(np.linspace(0, 1, KNOTS))
    np.testing.assert_allclose(found[:, 2:], np.tile(expected, (3, 1))[:, 2:], atol=0.06)


@pytest.mark.parametrize('people', [0, 1, 3, 300])
def test_confidence_does_not_decrease_and_is_never_certain(people):
    found = fit_calibration(made_up(people))
    assert (np.diff(found, axis=1) >= 0).all()
    assert found.min() > 0
    assert found.max() < 1


def test_few_people_do_not_outweigh_the_other_joints():
    """One joint has three misses, the others have three hundred hits."""
    fractions = np.full((300, 3), 0.6, np.float32)
    near = np.ones_like(fractions)
    near[:3, 0] = 0
    near[3:, 0] = np.nan
    found = fit_calibration(CalibrationData(fractions, near))
    knot = round(0.6 * (KNOTS - 1))
    assert found[1, knot] > 0.97
    assert 0.3 < found[0, knot] < found[1, knot]


def test_other_joints_count_as_five_people():
    """Of the other joints, 600 of 600 are near; of this one, 0 of 3.

    The prior is the fit over all joints. At their vote fraction and above (where it may not fall
    again) it is 600 of 603, with half a hit in 0.2 people added at each knot. With the weight 5
    and the three misses it becomes 5 / (5 + 3) of that.
    """
    fractions = np.full((300, 3), 0.6, np.float32)
    near = np.ones_like(fractions)
    near[:3, 0] = 0
    near[3:, 0] = np.nan
    knot = round(0.6 * (KNOTS - 1))
    knots = KNOTS - knot  # pooled
    prior = (600 + 0.1 * knots) / (603 + 0.2 * knots)
    found = fit_calibration(CalibrationData(fractions, near))
    assert found[0, knot] == pytest.approx(5 * prior / (5 + 3), abs=1e-3)


def test_unlabelled_joints_do_not_count():
    data = made_up(500)
    more = CalibrationData(
        np.concatenate([data.fractions, np.full((50, 3), 0.9, np.float32)]),
        np.concatenate([data.near, np.full((50, 3), np.nan, np.float32)]),
    )
    np.testing.assert_allclose(fit_calibration(more), fit_calibration(data))


def test_calibration_data_are_those_of_the_estimator(small_model, people):
    frame = people[40]
    settings = small_model.settings._replace(query_points=70)
    model = small_model._replace(settings=settings)
    data = gather_calibration_data(model, labelled_people([frame], model.joints, settings))
    stages = Estimator(model).estimate_body(frame.depth, frame.labels, frame.camera, 1)
    expected = vote_fractions(stages.joint_votes, stages.joints, settings.joint_bandwidth)
    np.testing.assert_allclose(data.fractions[0], expected, atol=1e-4)
    errors = np.linalg.norm(
        stages.joints - frame.ground_truth.positions[0, small_model.joints], axis=-1
    )
    np.testing.assert_array_equal(data.near[0], errors <= 0.1)


def test_without_people_the_model_is_unchanged(small_model):
    bare = small_model._replace(calibration=small_model.calibration[:0])
    assert calibrate(bare, []) is bare


def test_calibrated_confidence_is_reliable_on_other_people(small_model, easy):
    def strangers(seed, frames):
        return list(synthetic_frames(easy._replace(frames=frames, seed=seed, clip_length=5)))

    bare = small_model._replace(calibration=small_model.calibration[:0])
    teachers = labelled_people(strangers(31, 150), bare.joints, bare.settings)
    test = strangers(32, 150)
    raw, calibrated = (
        measure_reliability(evaluate(Estimator(model), test))
        for model in (bare, calibrate(bare, teachers))
    )
    assert raw.ece > 0.15
    assert calibrated.ece < 0.06
    assert calibrated.brier < raw.brier


@pytest.mark.parametrize('fraction', [0.0, 0.05, 0.1, 0.5])
@pytest.mark.parametrize('count', [0, 1, 9, 240, 3600, 3605])
def test_stretches_are_held_out(count, fraction):
    held = held_out_mask(count, fraction)
    assert held.shape == (count,)
    assert abs(held.sum() - fraction * count) <= 10
    begins = np.flatnonzero(np.diff(np.concatenate([[False], held]).astype(int)) == 1)
    if fraction * count >= 20:
        assert len(begins) == 10
        assert np.diff(begins).min() >= count // 10 - 1
    if fraction == 0:
        assert not held.any()


def test_held_out_people_are_not_in_the_training(people, training):
    def everybody():
        return labelled_people(people[:60], training.joints, training.settings)

    samples, test = split_samples(everybody(), None, 0.25)
    held = held_out_mask(60, 0.25)
    assert len(test) == held.sum() > 0
    assert len(samples.scale) == (~held).sum()
    scales = np.array([person.scale for person in everybody()], np.float32)
    np.testing.assert_array_equal(samples.scale, scales[~held])
    np.testing.assert_array_equal([np.float32(person.scale) for person in test], scales[held])


def test_training_calibrates_if_people_are_held_out(people, training, small_model):
    assert small_model.calibration.shape == (len(training.joints), KNOTS)
    assert small_model.provenance['confidence learnt from'] == '10 people'
    model = train(people[:60], training._replace(hold_out=0.0), {})
    assert model.calibration.shape == (0, KNOTS)
    assert model.provenance['people'] == '60'
