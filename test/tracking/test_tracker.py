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

"""Tracking of body numbers."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.tracking.tracker import MEMORY_NS, Tracker, body_distance

FRAME = 33_000_000
START = 1_700_000_000 * 10**9

POSE = np.array([[0, -0.8, 0], [0, -0.5, 0], [0.2, 0, 0.1], [-0.2, 0, 0.1]], np.float32)


def people(places):
    """Return bodies by number in the mask, at x metres each, or None without known joints."""
    labels = sorted(places)
    positions = np.full((len(labels), len(POSE), 3), np.nan, np.float32)
    for row, label in enumerate(labels):
        if places[label] is not None:
            positions[row] = POSE + np.array([places[label], 0, 3], np.float32)
    confidence = np.full(positions.shape[:2], 0.25, np.float32) + np.array(labels)[:, None] / 100
    return Skeletons(
        np.array(labels, np.uint16),
        np.arange(len(POSE), dtype=np.uint16),
        positions,
        confidence.astype(np.float32),
    )


def numbers(tracker, frame, places):
    """Return the positions by the numbers of the tracker."""
    found = tracker.follow(START + frame * FRAME, people(places))
    assert found.bodies.dtype == np.uint16
    assert found.bodies.tolist() == sorted(set(found.bodies.tolist()))
    return {
        number: None if np.isnan(joints).all() else round(float(joints[0, 0]), 3)
        for number, joints in zip(found.bodies.tolist(), found.positions, strict=True)
    }


@pytest.fixture
def tracker():
    return Tracker()


def test_numbers_of_the_mask_are_kept(tracker):
    assert numbers(tracker, 0, {1: 0.0, 7: 1.0}) == {1: 0.0, 7: 1.0}
    assert numbers(tracker, 1, {1: 0.1, 7: 0.9}) == {1: 0.1, 7: 0.9}


def test_numbers_persist_if_the_mask_renumbers(tracker):
    random = np.random.default_rng(4)
    homes = np.array([-1.5, -0.5, 0.5, 1.5])
    numbers(tracker, 0, dict(enumerate(homes.tolist(), 1)))
    for frame in range(1, 60):
        places = homes + random.uniform(-0.2, 0.2, 4)
        labels = random.choice(np.arange(1, 12), 4, replace=False).tolist()
        found = numbers(tracker, frame, dict(zip(labels, places.tolist(), strict=True)))
        assert found == {body: round(x, 3) for body, x in enumerate(places.tolist(), 1)}


def test_labels_of_the_bodies_of_a_frame(tracker):
    tracker.follow(START, people({1: 0.0, 2: 1.0, 3: 2.5}))
    assert tracker.labels_of(START) == {1: 1, 2: 2, 3: 3}
    tracker.follow(START + FRAME, people({5: 1.0, 9: 0.0}))
    assert tracker.labels_of(START + FRAME) == {1: 9, 2: 5}
    assert tracker.labels_of(START) == {3: 3}  # the body that was last seen then


def test_joints_and_confidence_stay_with_their_body(tracker):
    tracker.follow(START, people({1: 0.0, 2: 1.0}))
    swapped = people({1: 1.0, 2: 0.0})
    found = tracker.follow(START + FRAME, swapped)
    np.testing.assert_array_equal(found.positions, swapped.positions[::-1])
    np.testing.assert_array_equal(found.confidence, swapped.confidence[::-1])
    np.testing.assert_array_equal(found.joints, swapped.joints)


def test_remaining_body_keeps_its_number(tracker):
    numbers(tracker, 0, {1: 0.0, 2: 1.0})
    assert numbers(tracker, 1, {1: 1.02}) == {2: 1.02}


def test_number_persists_over_a_short_absence(tracker):
    numbers(tracker, 0, {1: 0.0, 2: 1.0})
    numbers(tracker, 1, {1: 1.0})
    within = MEMORY_NS // FRAME
    assert numbers(tracker, 2, {}) == {}
    assert numbers(tracker, within, {1: 1.0, 2: 0.1}) == {1: 0.1, 2: 1.0}


def test_numbers_are_free_after_a_long_absence(tracker):
    numbers(tracker, 0, {1: 0.0})
    later = MEMORY_NS // FRAME + 2
    assert numbers(tracker, later, {1: 1.0, 4: 0.0}) == {1: 1.0, 4: 0.0}


def test_large_jump_is_a_new_body(tracker):
    numbers(tracker, 0, {1: 0.0})
    assert numbers(tracker, 1, {1: 0.6}) == {2: 0.6}
    assert numbers(tracker, 2, {1: 0.05, 2: 0.6}) == {1: 0.05, 2: 0.6}


def test_new_body_gets_an_unused_number(tracker):
    numbers(tracker, 0, {1: 0.0})
    # The mask exchanges them: the new body has the number of the known one.
    assert numbers(tracker, 1, {1: 2.0, 2: 0.0}) == {1: 0.0, 3: 2.0}
    assert numbers(tracker, 2, {1: 2.0, 2: 0.0, 3: -2.0}) == {1: 0.0, 3: 2.0, 4: -2.0}


def test_the_bodies_are_assigned_together(tracker):
    """The first is nearer to where the second was than the second is; yet both have moved."""
    numbers(tracker, 0, {1: 0.0, 2: 0.3})
    assert numbers(tracker, 1, {1: 0.28, 2: 0.5}) == {1: 0.28, 2: 0.5}
    # So large a step is less likely than somebody new.
    numbers(tracker, 100, {1: 0.0, 2: 0.4})
    assert numbers(tracker, 101, {1: 0.38, 2: 0.9}) == {2: 0.38, 3: 0.9}


def test_body_without_joints_is_matched_by_the_mask(tracker):
    numbers(tracker, 0, {1: 0.0, 2: 1.0})
    numbers(tracker, 1, {1: 1.0, 2: 0.0})
    assert numbers(tracker, 2, {1: None, 2: 0.0}) == {1: 0.0, 2: None}
    assert numbers(tracker, 3, {1: 1.0, 2: 0.0}) == {1: 0.0, 2: 1.0}


def test_hidden_joints_keep_the_track(tracker):
    first = people({1: 0.0, 2: 1.0})
    first.positions[:, 2:] = np.nan
    tracker.follow(START, first)
    second = people({1: 1.0, 2: 0.0})
    second.positions[:, 1] = np.nan
    assert tracker.follow(START + FRAME, second).positions[0, 0, 0] == 0
    third = people({1: 0.0, 2: 1.0})
    third.positions[:, 0] = np.nan
    found = tracker.follow(START + 2 * FRAME, third)
    assert found.bodies.tolist() == [1, 2]
    assert found.positions[0, 1, 0] == 0


def test_numbers_are_reused_after_the_largest(tracker):
    numbers(tracker, 0, {65535: 0.0})
    assert numbers(tracker, 1, {65535: 2.0, 1: 0.0}) == {2: 2.0, 65535: 0.0}


def test_stamps_that_repeat_or_go_back_a_little(tracker):
    numbers(tracker, 10, {1: 0.0, 2: 1.0})
    assert numbers(tracker, 10, {1: 1.0, 2: 0.0}) == {1: 0.0, 2: 1.0}
    assert numbers(tracker, 8, {1: 1.0, 2: 0.0}) == {1: 0.0, 2: 1.0}


def test_distance_as_the_mean_over_common_joints():
    random = np.random.default_rng(2)
    for _ in range(50):
        first, second = random.normal(size=(2, 6, 3)).astype(np.float32)
        first[random.random(6) < 0.3] = np.nan
        second[random.random(6) < 0.3] = np.nan
        apart = [
            sum((a - b) ** 2 for a, b in zip(*pair, strict=True)) ** 0.5
            for pair in zip(first.tolist(), second.tolist(), strict=True)
        ]
        apart = [each for each in apart if each == each]  # noqa: PLR0124 - NaN is not
        expected = sum(apart) / len(apart) if apart else float('inf')
        assert body_distance(first, second) == pytest.approx(expected, rel=1e-5)
    assert body_distance(first * np.nan, second) == float('inf')
