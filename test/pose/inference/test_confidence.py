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

"""The confidence from vote fractions."""

import numpy as np
import pytest

from lsc_pose_ros.pose.forest.votes import Votes
from lsc_pose_ros.pose.inference.confidence import confidence_in, uncalibrated, vote_fractions
from lsc_pose_ros.pose.inference.density import VoteCloud

BANDWIDTH = 0.07


def random_votes(rng, counts):
    start = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    x, y, z = rng.normal(0, 0.08, (3, start[-1])).astype(np.float32)
    return Votes(start, VoteCloud(x, y, z, rng.random(start[-1], np.float32)))


def fractions_twin(votes, positions):
    fractions = np.zeros(len(positions))
    for joint, position in enumerate(positions):
        mine = slice(votes.start[joint], votes.start[joint + 1])
        squared = ((votes.position[mine] - position) ** 2).sum(axis=1)
        weight = votes.weight[mine].astype(float)
        if len(weight) and not np.isnan(position).any():
            fractions[joint] = (weight * np.exp(-squared / BANDWIDTH**2)).sum() / weight.sum()
    return fractions


def confidence_twin(calibration, votes, positions):
    knots = np.linspace(0, 1, calibration.shape[1])
    found = np.array(
        [
            np.interp(fraction, knots, quantised)
            for fraction, quantised in zip(
                fractions_twin(votes, positions), calibration, strict=True
            )
        ]
    )
    return np.where(np.isnan(positions).any(axis=1), 0, found)


@pytest.mark.parametrize('seed', range(5))
@pytest.mark.parametrize('knots', [2, 5, 41])
def test_confidence_is_looked_up_between_the_knots(seed, knots):
    rng = np.random.default_rng(seed)
    votes = random_votes(rng, [30, 1, 0, 200, 7])
    positions = rng.normal(0, 0.05, (5, 3)).astype(np.float32)
    positions[4] = np.nan
    calibration = np.sort(rng.random((5, knots), np.float32), axis=1)
    found = confidence_in(calibration, votes, positions, BANDWIDTH)
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, confidence_twin(calibration, votes, positions), atol=1e-4)
    assert found[4] == 0


def test_without_a_calibration_the_vote_fraction_is_the_confidence():
    rng = np.random.default_rng(9)
    votes = random_votes(rng, [50, 0, 20])
    positions = np.array([[0, 0, 0], [0, 0, 0], [np.nan] * 3], np.float32)
    found = confidence_in(uncalibrated(), votes, positions, BANDWIDTH)
    np.testing.assert_array_equal(found, vote_fractions(votes, positions, BANDWIDTH))
    np.testing.assert_allclose(found, fractions_twin(votes, positions), atol=1e-5)


@pytest.mark.parametrize(('position', 'expected'), [(0.0, 0.9), (9.0, 0.2)])
def test_all_votes_and_none_are_the_ends_of_the_scale(position, expected):
    here = np.zeros(4, np.float32)
    votes = Votes(np.array([0, 4]), VoteCloud(here, here, here, here + np.float32(0.3)))
    calibration = np.array([[0.2, 0.5, 0.9]], np.float32)
    positions = np.full((1, 3), position, np.float32)
    found = confidence_in(calibration, votes, positions, BANDWIDTH)
    assert found[0] == pytest.approx(expected, abs=1e-5)
