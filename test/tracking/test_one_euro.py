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

"""The One-Euro filter, compared with the algorithm of the paper for single numbers."""

import math

import numpy as np
import pytest

from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.tracking.one_euro import (
    MEMORY_NS,
    OneEuroBodies,
    OneEuroPoints,
    OneEuroSettings,
)

SETTINGS = OneEuroSettings(cutoff=1.2, beta=3.0)
SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND
JOINTS = 3


def alpha(seconds, cutoff):
    """Equation 3 of the paper, and tau of a cutoff frequency."""
    tau = 1 / (2 * math.pi * cutoff)
    return 1 / (1 + tau / seconds)


class PlainFilter:
    """Algorithm 1 for one point."""

    def __init__(self):
        self.before = None

    def filter(self, stamp, point, settings):
        if any(math.isnan(x) for x in point):
            return point
        elapsed = None if self.before is None else (stamp - self.before[0]) / SECOND
        if elapsed is None or elapsed > MEMORY_NS / SECOND:
            self.before = stamp, list(point), [0.0, 0.0, 0.0]
            return point
        if elapsed <= 0:
            return point
        assert self.before is not None
        _, smooth, speed = self.before
        a = alpha(elapsed, 1.0)
        speed = [
            a * (x - s) / elapsed + (1 - a) * v
            for x, s, v in zip(point, smooth, speed, strict=True)
        ]
        a = alpha(elapsed, settings.cutoff + settings.beta * math.hypot(*speed))
        smooth = [a * x + (1 - a) * s for x, s in zip(point, smooth, strict=True)]
        self.before = stamp, smooth, speed
        return smooth


def walk(seed, frames=200):
    """Return stamps with gaps, repeats and steps back, and points, some of them unknown."""
    random = np.random.default_rng(seed)
    steps = random.choice(
        [33, 34, 7, 0, -20, 400, 500, 501, 2000], frames, p=[0.6, 0.2, *[0.2 / 7] * 7]
    )
    stamps = START + np.cumsum(steps) * 1_000_000
    points = np.cumsum(random.normal(0, 0.05, (frames, JOINTS, 3)), axis=0).astype(np.float32)
    points[random.random((frames, JOINTS)) < 0.15] = np.nan
    points[random.random((frames, JOINTS)) < 0.02, 1] = np.nan  # a single axis
    return stamps.tolist(), points


@pytest.mark.parametrize('seed', range(4))
def test_results_are_those_of_the_paper(seed):
    stamps, points = walk(seed)
    body, plain = OneEuroPoints(JOINTS), [PlainFilter() for _ in range(JOINTS)]
    for stamp, joints in zip(stamps, points, strict=True):
        expected = [
            each.filter(stamp, joint, SETTINGS)
            for each, joint in zip(plain, joints.tolist(), strict=True)
        ]
        found = body.filter(stamp, joints, SETTINGS)
        assert found.dtype == np.float32
        np.testing.assert_allclose(found, np.array(expected), rtol=1e-5, atol=1e-6)


def test_input_is_not_modified():
    stamps, points = walk(1, 10)
    before = points.copy()
    body = OneEuroPoints(JOINTS)
    for stamp, joints in zip(stamps, points, strict=True):
        body.filter(stamp, joints, SETTINGS)
    np.testing.assert_array_equal(points, before)


def test_resting_joints_are_smoothed_and_moving_joints_are_followed():
    random = np.random.default_rng(3)
    frames = 90
    points = np.zeros((frames, 2, 3), np.float32)
    points[:, 1, 0] = 2.0 * np.arange(frames) / 30  # 2 m/s, a fast hand
    noisy = points + random.normal(0, 0.01, points.shape).astype(np.float32)
    body = OneEuroPoints(2)
    smooth = np.array(
        [
            body.filter(START + number * SECOND // 30, joints, OneEuroSettings(1.0, 8.0))
            for number, joints in enumerate(noisy)
        ]
    )[30:]
    rest = np.diff(smooth[:, 0], axis=0).std() / np.diff(noisy[30:, 0], axis=0).std()
    assert rest < 0.3
    lag = np.abs(smooth[:, 1, 0] - points[30:, 1, 0]).mean()
    assert lag < 0.02


def test_smoothing_does_not_depend_on_the_direction():
    stamps, points = walk(7, 60)
    random = np.random.default_rng(0)
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    straight, turned = OneEuroPoints(JOINTS), OneEuroPoints(JOINTS)
    for stamp, joints in zip(stamps, points, strict=True):
        smooth = straight.filter(stamp, joints, SETTINGS)
        other = turned.filter(stamp, (joints @ turn).astype(np.float32), SETTINGS)
        known = np.isfinite(joints).all(axis=1)
        np.testing.assert_allclose(smooth[known] @ turn, other[known], atol=1e-5)


def skeletons(bodies, positions):
    positions = np.asarray(positions, np.float32).reshape(len(bodies), JOINTS, 3)
    joints = np.arange(positions.shape[1], dtype=np.uint16)
    confidence = np.full(positions.shape[:2], 0.5, np.float32)
    return Skeletons(np.array(bodies, np.uint16), joints, positions, confidence)


def test_bodies_are_filtered_independently():
    random = np.random.default_rng(11)
    filters, alone = OneEuroBodies(), {}
    stamp = START
    for _ in range(300):
        stamp += int(random.choice([33, 200, 900])) * 1_000_000
        bodies = np.flatnonzero(random.random(4) < 0.6).tolist()
        seen = skeletons(bodies, random.normal(size=(len(bodies), JOINTS, 3)))
        found = filters.filter(stamp, seen, SETTINGS)
        assert found.bodies.tolist() == bodies
        np.testing.assert_array_equal(found.confidence, seen.confidence)
        for row, body in enumerate(bodies):
            own = alone.setdefault(body, OneEuroPoints(JOINTS))
            expected = own.filter(stamp, seen.positions[row], SETTINGS)
            np.testing.assert_array_equal(found.positions[row], expected)


def test_no_bodies_and_bodies_without_joints():
    filters = OneEuroBodies()
    nobody = skeletons([], np.zeros((0, JOINTS, 3)))
    assert filters.filter(START, nobody, SETTINGS).positions.shape == nobody.positions.shape
    unseen = skeletons([3], np.full((1, JOINTS, 3), np.nan))
    assert np.isnan(filters.filter(START + 1, unseen, SETTINGS).positions).all()


def test_history_of_an_absent_body_is_deleted():
    filters = OneEuroBodies()
    for number in range(100):
        filters.filter(
            START + number * SECOND, skeletons([number], np.ones((JOINTS, 3))), SETTINGS
        )
    assert len(filters._bodies) == 1
