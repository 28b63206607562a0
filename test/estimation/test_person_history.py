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


"""What is expected of a person: the prior, the body yaw over time, and who a body is."""

import itertools

import numpy as np
import pytest

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.estimation import person_history
from lsc_pose_ros.estimation.joint_filter import (
    DOUBTFUL_ERROR,
    GATE,
    SPEED_ERROR,
    SURE_ERROR,
    FilteredJoints,
    filter_joints,
    measured_joints,
)
from lsc_pose_ros.estimation.person_history import (
    Person,
    PersonHistory,
    people_of,
)
from lsc_pose_ros.pose.body_estimate import BodyEstimate
from lsc_pose_ros.pose.forest.body_yaw_tracking import LARGEST_DOUBT, TURN_PENALTY, carry_over
from lsc_pose_ros.pose.inference.candidates import Candidates
from lsc_pose_ros.pose.inference.past import (
    MOST_REACHES,
    NEW_PERSON,
    Past,
    contradicts,
    log_pasts,
)
from lsc_pose_ros.tracking.movement import at_rest
from lsc_pose_ros.tracking.surfaces import Surface

CAMERA = Intrinsics(60.0, 62.0, 30.0, 22.0)
NO_IMAGES = np.zeros((9, 9), np.float32), np.full((9, 9), NO_BODY, np.int32)
FRAME_NS = 33_333_333


def past_of(joints: np.ndarray, reach: float = 0.1) -> Past:
    weight = np.linspace(0.2, 1, len(joints)).astype(np.float32)
    return Past(joints.astype(np.float32), weight, reach, None, all_round=False)


@pytest.mark.parametrize('seed', range(3))
def test_candidates_are_rated_by_their_distance_from_the_past(seed: int) -> None:
    rng = np.random.default_rng(seed)
    past = past_of(rng.normal(0, 0.2, (6, 3)), 0.15)
    past.joints[2] = np.nan
    positions = rng.normal(0, 0.2, (6, 3, 3)).astype(np.float32)
    counts = rng.integers(0, 4, 6)
    found = log_pasts(past, Candidates(positions, counts))
    for joint, k in np.ndindex(6, 3):
        expected: float = 0.0
        if k < counts[joint] and joint != 2:
            distance = float(np.linalg.norm(past.joints[joint] - positions[joint, k]))
            expected = -float(past.weight[joint]) * min((distance / 0.15) ** 2, MOST_REACHES**2)
        assert found[joint, k] == pytest.approx(expected, abs=1e-4)
    assert not log_pasts(None, Candidates(positions, counts)).any()


def test_another_person_contradicts_the_past() -> None:
    joints = np.random.default_rng(0).normal(0, 1, (9, 3)).astype(np.float32)
    moved = joints.copy()
    moved[:4] += 5  # less than half of the joints
    moved[4:, 0] += 0.9 * NEW_PERSON
    assert not contradicts(past_of(joints), moved)
    moved[4:, 0] += 0.2 * NEW_PERSON
    assert contradicts(past_of(joints), moved)
    assert contradicts(past_of(joints), np.full_like(joints, np.nan))


@pytest.mark.parametrize('count', [4, 8, 12])
def test_the_belief_is_carried_over_along_the_circle(count: int) -> None:
    belief = np.random.default_rng(count).uniform(-4, 0, count)
    expected = np.full(count, -np.inf)
    for k, j in itertools.product(range(count), repeat=2):
        steps = min((k - j) % count, (j - k) % count)
        expected[k] = max(expected[k], belief[j] - TURN_PENALTY * steps * 8 / count)
    expected = np.maximum(expected - expected.max(), -LARGEST_DOUBT)
    np.testing.assert_allclose(carry_over(belief), expected)


def surface(x: float) -> Surface:
    return Surface(np.array([x, 0, 2.0]), 0.5)


def person(x: float) -> Person:
    nothing = np.zeros((2, 3), np.float32)
    joints = FilteredJoints(nothing, np.ones(2))
    confidence = np.ones(2, np.float32)
    return Person(0, at_rest(0, surface(x)), joints, nothing, confidence, None, 0)


def test_a_body_is_the_nearest_person_whatever_its_number() -> None:
    people = [person(0), person(0.3), person(5)]
    surfaces = {7: surface(0.28), 1: surface(0.1), 4: surface(2)}
    assert people_of(FRAME_NS, surfaces, people) == {7: people[1], 1: people[0]}
    assert people_of(FRAME_NS, surfaces, []) == people_of(FRAME_NS, {}, people) == {}


def estimate(number: int, joints: list[list[float]], past: Past | None) -> BodyEstimate:
    body = BodyEstimate.in_image(*NO_IMAGES, CAMERA, number, past)
    body.joints = np.array(joints, np.float32)
    body.confidence = np.array([0.9, 0.4], np.float32)
    body.body_yaw = None
    return body


def test_a_movement_goes_on_and_a_gap_or_an_earlier_stamp_ends_it() -> None:
    history = PersonHistory()
    body = {1: surface(0)}
    history.begin(0, body)
    assert history.recall(1) is None
    history.remember(estimate(1, [[0, 0, 2], [0, 1, 2]], None))
    # The same body has another number now.
    history.begin(FRAME_NS, {5: surface(0)})
    past = history.recall(5)
    np.testing.assert_allclose(past.joints, [[0, 0, 2], [0, 1, 2]])
    np.testing.assert_allclose(past.weight, [0.9, 0.4])
    assert past.reach == pytest.approx(person_history.REACH, rel=1e-4)
    filtered = history.remember(estimate(5, [[0.02, 0, 2], [0, np.nan, 2]], past))
    assert 0 < filtered[0, 0] < 0.02
    history.begin(2 * FRAME_NS, body)
    past = history.recall(1)
    expected = filtered[0, 0] * (1 + person_history.TREND)
    assert past.joints[0, 0] == pytest.approx(expected, rel=1e-3)
    assert np.isnan(past.joints[1, 1])
    # Nobody is seen for some frames, then the person comes back.
    history.begin(3 * FRAME_NS, {})
    history.begin(4 * FRAME_NS, body)
    assert history.recall(1).reach == pytest.approx(person_history.REACH * np.sqrt(3), rel=1e-3)
    history.begin(4 * FRAME_NS + person_history.LONGEST_GAP_NS, body)
    assert history.recall(1) is None


def test_after_a_stamp_that_goes_back_nobody_is_known() -> None:
    history = PersonHistory()
    body = {1: surface(0)}
    history.begin(FRAME_NS, body)
    history.remember(estimate(1, [[0, 0, 2], [0, 1, 2]], None))
    history.begin(0, body)
    assert history.recall(1) is None


def test_all_body_yaws_are_tried_now_and_then() -> None:
    history = PersonHistory()
    body = {1: surface(0)}
    tried = []
    for frame in range(40):
        history.begin(frame * FRAME_NS, body)
        past = history.recall(1)
        tried.append(past is None or past.all_round)
        history.remember(estimate(1, [[0, 0, 2], [0, 1, 2]], past))
    every = np.diff(np.flatnonzero(tried))
    assert (every == person_history.ALL_ROUND_EVERY + 1).all()
    assert len(every) >= 2


def test_the_filter_moves_joints_as_far_as_their_certainty_says() -> None:
    rng = np.random.default_rng(0)
    expected = FilteredJoints(rng.normal(0, 1, (7, 3)).astype(np.float32), rng.random(7) * 0.01)
    confidence = np.linspace(0, 1, 7).astype(np.float32)
    positions = (expected.positions + rng.normal(0, 0.02, (7, 3))).astype(np.float32)
    positions[1] += 2.0  # a sudden movement
    expected.positions[2], positions[3] = np.nan, np.nan
    measured = measured_joints(positions, confidence)
    found = filter_joints(expected, 0.04, measured)
    for j in range(7):
        error = DOUBTFUL_ERROR * (1 - confidence[j]) + SURE_ERROR * confidence[j]
        noise, prior = error**2, expected.variance[j] + (SPEED_ERROR * 0.04) ** 2
        innovation = positions[j] - expected.positions[j]
        if np.isnan(innovation).any():  # only what is measured counts
            np.testing.assert_array_equal(found.positions[j], positions[j])
            assert found.variance[j] == pytest.approx(noise, rel=1e-6)
            continue
        beyond = np.linalg.norm(innovation) - GATE * np.sqrt(prior + noise)
        assert (beyond > 0) == (j == 1)
        prior += max(beyond, 0) ** 2
        gain = prior / (prior + noise)
        wanted = expected.positions[j] + gain * innovation
        np.testing.assert_allclose(found.positions[j], wanted, atol=1e-5)
        assert found.variance[j] == pytest.approx((1 - gain) * prior, rel=1e-5)
    # The sudden movement is followed nearly at once.
    assert np.linalg.norm(found.positions[1] - positions[1]) < 0.1
