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

"""Frames that follow one another: numbers that last, smoothing, beginning anew."""

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS, numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.estimation.temporal import HIDDEN_CONFIDENCE, REWIND_NS, TemporalEstimator
from lsc_pose_ros.settings.table import AUTO, MASK, NO_POSITION, TRACKED, TemporalSettings
from lsc_pose_ros.tracking.one_euro import OneEuroBodies, OneEuroSettings
from lsc_pose_ros.tracking.tracker import Tracker

FRAME = 33_000_000
START = 1_700_000_000 * 10**9
EVERYBODY = TemporalSettings(minimum_body_confidence=0.0, minimum_stature=0.0, temporal=False)
SMOOTHED = replace(EVERYBODY, smoothing=True, smoothing_cutoff=1.0, smoothing_beta=2.0)
IMAGES = np.ones((6, 8), np.float32), np.full((6, 8), NO_BODY, np.int32), Intrinsics(8, 8, 4, 3)
BOTH = replace(SMOOTHED, body_ids=TRACKED)


class Script:
    """An estimator that answers what is written down."""

    def __init__(self, answers):
        self.answers = iter(answers)

    maximum_bodies = None

    def estimate_largest(self, _depth, _labels, _camera, _observer, _memory=None):
        return next(self.answers), 0


@pytest.fixture
def answers():
    """Two people whom the mask renumbers now and then; noisy joints, some unknown."""
    random = np.random.default_rng(6)
    made = []
    for frame in range(30):
        positions = random.normal(0, 0.01, (2, 3, 3)).astype(np.float32)
        positions[1, :, 0] += 2
        positions[random.random((2, 3)) < 0.1] = np.nan
        if frame % 7 > 3:
            positions = positions[::-1]
        made.append(
            Skeletons(
                np.array([1, 2], np.uint16),
                np.arange(3, dtype=np.uint16),
                np.ascontiguousarray(positions),
                random.random((2, 3)).astype(np.float32),
            )
        )
    return made


def run(temporal_estimator, count, start=START):
    return [temporal_estimator.estimate(start + n * FRAME, *IMAGES) for n in range(count)]


def assert_same(found, expected):
    assert len(found) == len(expected)
    for one, other in zip(found, expected, strict=True):
        for name in Skeletons._fields:
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name), name)


def test_bodies_beyond_the_maximum_are_counted(answers):
    class Crowd(Script):
        def estimate_largest(self, *images):
            return super().estimate_largest(*images)[0], 5

    temporal_estimator = TemporalEstimator(Crowd(answers), EVERYBODY)
    assert temporal_estimator.beyond_maximum == 0
    run(temporal_estimator, 3)
    assert temporal_estimator.beyond_maximum == 15


def test_nothing_is_done_unasked(answers):
    assert_same(run(TemporalEstimator(Script(answers), EVERYBODY), 30), answers)


def test_numbers_first_then_smoothing(answers):
    tracker, smoothing = Tracker(), OneEuroBodies()
    expected = [
        smoothing.filter(
            START + n * FRAME,
            tracker.follow(START + n * FRAME, each),
            OneEuroSettings(1.0, 2.0),
        )
        for n, each in enumerate(answers)
    ]
    found = run(TemporalEstimator(Script(answers), BOTH), 30)
    assert_same(found, expected)
    known = np.array([each.positions[:, :, 0] for each in found])
    assert np.nanmax(np.abs(known - [[[0], [2]]])) < 0.2


@pytest.mark.parametrize('settings', [SMOOTHED, BOTH])
def test_stamps_that_go_back_begin_anew(answers, settings):
    once = run(TemporalEstimator(Script(answers), settings), 30)
    twice = TemporalEstimator(Script([*answers, *answers]), settings)
    assert_same([*run(twice, 30), *run(twice, 30)], [*once, *once])
    late = TemporalEstimator(Script([*answers, answers[0]]), settings)
    run(late, 30)
    newest = START + 29 * FRAME
    found = late.estimate(newest - REWIND_NS, *IMAGES)
    assert late._newest == newest
    assert found.bodies.tolist() == [1, 2]


def test_reset_forgets(answers):
    temporal_estimator = TemporalEstimator(Script([*answers[:10], *answers]), BOTH)
    run(temporal_estimator, 10)
    temporal_estimator.reset()
    assert_same(
        run(temporal_estimator, 30, START + 10 * FRAME),
        run(TemporalEstimator(Script(answers), BOTH), 30, START + 10 * FRAME),
    )


def test_settings_and_estimator_change_while_it_runs(answers):
    temporal_estimator = TemporalEstimator(Script(answers), EVERYBODY)
    assert_same(run(temporal_estimator, 5), answers[:5])
    temporal_estimator.settings = SMOOTHED
    first, second = run(temporal_estimator, 2, START + 5 * FRAME)
    assert_same([first], [answers[5]])  # the filter knows nothing yet
    assert not np.array_equal(second.positions, answers[6].positions, equal_nan=True)
    temporal_estimator.estimator = cast('Any', Script(answers))
    temporal_estimator.settings = TemporalSettings(temporal=False)
    assert_same(run(temporal_estimator, 3, START + 7 * FRAME), answers[:3])


def test_bodies_of_low_confidence_are_left_out_and_counted(answers):
    estimator = TemporalEstimator(Script(answers), replace(EVERYBODY, minimum_body_confidence=0.6))
    found = run(estimator, 30)
    left_out = 0
    for one, given in zip(found, answers, strict=True):
        # The mean of the better half: two of three joints.
        best = np.sort(given.confidence, axis=1)[:, 1:].mean(axis=1)
        kept = best >= 0.6
        left_out += (~kept).sum()
        np.testing.assert_array_equal(one.bodies, given.bodies[kept])
        np.testing.assert_array_equal(one.positions, given.positions[kept])
        np.testing.assert_array_equal(one.confidence, given.confidence[kept])
    assert estimator.left_out == left_out > 0


def test_the_minimum_can_change_between_two_frames(answers):
    estimator = TemporalEstimator(Script(answers), EVERYBODY)
    assert len(run(estimator, 1)[0].bodies) == 2
    estimator.settings = replace(EVERYBODY, minimum_body_confidence=1.0)
    assert len(run(estimator, 1)[0].bodies) == 0
    assert estimator.left_out == 2


def test_a_body_without_any_estimate_is_kept(answers):
    nobody = answers[0]._replace(
        positions=np.full((2, 3, 3), np.nan, np.float32), confidence=np.zeros((2, 3), np.float32)
    )
    estimator = TemporalEstimator(
        Script([nobody]), TemporalSettings(minimum_body_confidence=0.5, temporal=False)
    )
    assert_same(run(estimator, 1), [nobody])


@pytest.mark.parametrize('body_ids', [AUTO, MASK, TRACKED])
@pytest.mark.parametrize('from_mask', [True, False])
def test_bodies_without_a_mask_are_tracked(answers, body_ids, from_mask):
    """In the answers, the bodies exchange their numbers now and then."""
    estimator = TemporalEstimator(Script(answers), replace(EVERYBODY, body_ids=body_ids))
    found = [
        estimator.estimate(START + n * FRAME, *IMAGES, from_mask=from_mask) for n in range(30)
    ]
    left = [np.nanmean(each.positions[each.bodies == 1][..., 0]) < 1 for each in found]
    tracked = body_ids == TRACKED or (body_ids == AUTO and not from_mask)
    assert all(left) == tracked


def giant_and_dwarf():
    """Return two bodies: 1.8 m and 0.7 m tall."""
    heights = {'head': 1.6, 'neck': 1.4, 'torso': 1.2, 'pelvis': 0.95, 'hip': 0.95, 'knee': 0.5}
    names = [name.split('_')[-1] for name in JOINT_NAMES]
    tall = np.zeros((20, 3), np.float32)
    tall[:, 1] = [-heights.get(name, 0.0) for name in names]
    return Skeletons(
        np.array([1, 2], np.uint16),
        np.arange(20, dtype=np.uint16),
        np.stack([tall, 0.4 * tall + 2]).astype(np.float32),
        np.linspace(0, 1, 40, dtype=np.float32).reshape(2, 20),
    )


@pytest.mark.parametrize(('minimum', 'kept'), [(0.0, [1, 2]), (0.8, [1]), (2.0, [])])
def test_bodies_of_small_stature_are_left_out(minimum, kept):
    estimator = TemporalEstimator(
        Script([giant_and_dwarf()]), replace(EVERYBODY, minimum_stature=minimum)
    )
    assert run(estimator, 1)[0].bodies.tolist() == kept
    assert estimator.left_out == 2 - len(kept)


def test_a_body_of_unknown_stature_is_kept():
    answer = giant_and_dwarf()
    answer.positions[1, JOINT_NUMBERS['neck']] = np.nan
    estimator = TemporalEstimator(Script([answer]), replace(EVERYBODY, minimum_stature=0.8))
    assert run(estimator, 1)[0].bodies.tolist() == [1, 2]


def test_hidden_joints_can_have_no_position():
    answer = giant_and_dwarf()
    estimator = TemporalEstimator(Script([answer]), replace(EVERYBODY, hidden_joints=NO_POSITION))
    (found,) = run(estimator, 1)
    hidden = answer.confidence < HIDDEN_CONFIDENCE
    assert 0 < hidden.sum() < 40
    np.testing.assert_array_equal(np.isnan(found.positions).all(axis=-1), hidden)
    np.testing.assert_array_equal(found.positions[~hidden], answer.positions[~hidden])
    np.testing.assert_array_equal(found.confidence, np.where(hidden, 0, answer.confidence))


class Looking:
    """An estimator whose bodies stand upright in the middle of what is visible of them."""

    def __init__(self):
        self.bodies = []

    maximum_bodies = None

    def estimate_largest(self, depth, labels, camera, _observer, _memory=None):
        bodies = np.unique(labels[labels >= 0]).astype(np.uint16)
        self.bodies.append(bodies.tolist())
        height = np.linspace(-0.8, 0.8, 3)
        positions = []
        for body in bodies:
            rows, columns = np.nonzero(labels == body)
            z = depth[rows, columns].mean()
            x = (columns.mean() - camera.cx) / camera.fx * z
            positions.append([[x, y, z] for y in height])
        joints = numbers_of(['head', 'torso', 'pelvis'])
        skeletons = Skeletons(
            bodies, joints, np.array(positions, np.float32), np.ones((len(bodies), 3), np.float32)
        )
        return skeletons, 0


def half_hidden(hidden, number=4):
    """Return the images of a body that stands 3 m away; a bar hides it in the middle."""
    depth, labels = np.zeros((120, 60), np.float32), np.full((120, 60), NO_BODY, np.int32)
    depth[20:101, 24:34], labels[20:101, 24:34] = 3, number
    if hidden:
        depth[60:72], labels[60:72] = 2, NO_BODY
        labels[72:101, 24:34] = 2
    return depth, labels, Intrinsics(120.0, 120.0, 30.0, 60.0)


@pytest.mark.parametrize('body_ids', [TRACKED, MASK])
def test_a_piece_of_a_body_is_no_new_person(body_ids):
    """The piece has a lower number than the rest of the body, so it comes first."""
    looking = Looking()
    settings = replace(EVERYBODY, body_ids=body_ids)
    sequence = TemporalEstimator(cast('Any', looking), settings)
    found = [
        sequence.estimate(START + n * FRAME, *half_hidden(4 <= n < 20)).bodies.tolist()
        for n in range(24)
    ]
    if body_ids == TRACKED:
        assert found == [[4]] * 24
        assert looking.bodies == [[4]] * 24
    else:
        assert found[4] == looking.bodies[4] == [2, 4]


def test_a_segmentation_that_restarts_its_numbers_changes_none():
    sequence = TemporalEstimator(cast('Any', Looking()), replace(EVERYBODY, body_ids=TRACKED))
    found = [
        sequence.estimate(START + n * FRAME, *half_hidden(hidden=False, number=1 + n % 5))
        for n in range(30)
    ]
    assert [each.bodies.tolist() for each in found] == [[1]] * 30
