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

"""Densities and modes, against equation 14."""

import numpy as np
import pytest
from plain import density as plain

from lsc_pose_ros.pose.inference.density import VoteCloud, climb, density, find_modes, mean_shift

BANDWIDTH = 0.07


def cloud(votes: np.ndarray, weights: np.ndarray) -> VoteCloud:
    return VoteCloud(*np.ascontiguousarray(votes.T), weights)


def random_votes(seed: int, count: int = 80) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    centres = rng.normal(0, 0.3, (3, 3))
    votes = centres[rng.integers(0, 3, count)] + rng.normal(0, 0.04, (count, 3))
    return votes.astype(np.float32), rng.random(count).astype(np.float32)


def density_twin(position: np.ndarray, votes: np.ndarray, weights: np.ndarray, h: float) -> float:
    squared = ((votes.astype(float) - position) ** 2).sum(axis=1)
    return float((weights * np.exp(-squared / h**2)).sum())


def mean_shift_twin(
    position: np.ndarray, votes: np.ndarray, weights: np.ndarray, h: float
) -> np.ndarray:
    squared = ((votes.astype(float) - position) ** 2).sum(axis=1)
    pull = weights * np.exp(-squared / h**2)
    return (pull[:, None] * votes).sum(axis=0) / pull.sum()


@pytest.mark.parametrize('seed', range(5))
def test_density_is_equation_14_and_mean_shift_its_weighted_mean(seed: int) -> None:
    votes, weights = random_votes(seed)
    for position in votes[:10] + np.float32(0.02):
        assert density(position, cloud(votes, weights), BANDWIDTH) == pytest.approx(
            density_twin(position, votes, weights, BANDWIDTH), rel=1e-4
        )
        np.testing.assert_allclose(
            mean_shift(position, cloud(votes, weights), BANDWIDTH),
            mean_shift_twin(position, votes, weights, BANDWIDTH),
            atol=1e-5,
        )


@pytest.mark.parametrize('seed', range(5))
def test_plain_kernels_agree(seed: int) -> None:
    votes, weights = random_votes(seed)
    for position in votes[:10] + np.float32(0.02):
        twin = density_twin(position, votes, weights, BANDWIDTH)
        assert plain.density(position, votes, weights, BANDWIDTH) == pytest.approx(twin, rel=1e-5)
    first = plain.find_modes(votes, weights, BANDWIDTH, 2)
    second = find_modes(cloud(votes, weights), BANDWIDTH, 2)
    assert len(first) == len(second)
    np.testing.assert_allclose(first, second, atol=0.01 * BANDWIDTH)


def test_far_from_all_votes_the_density_is_zero_and_mean_shift_does_not_move() -> None:
    votes, weights = random_votes(0)
    position = np.full(3, 100, np.float32)
    assert density(position, cloud(votes, weights), BANDWIDTH) == 0
    np.testing.assert_array_equal(mean_shift(position, cloud(votes, weights), BANDWIDTH), position)


def test_no_votes_give_no_density_and_no_mode() -> None:
    votes, weights = np.zeros((0, 3), np.float32), np.zeros(0, np.float32)
    assert density(np.zeros(3, np.float32), cloud(votes, weights), BANDWIDTH) == 0
    assert len(find_modes(cloud(votes, weights), BANDWIDTH, 2)) == 0


@pytest.mark.parametrize('seed', range(5))
def test_climb_ends_on_a_mode(seed: int) -> None:
    votes, weights = random_votes(seed)
    mode = np.array(climb(votes[0], cloud(votes, weights), BANDWIDTH), float)
    height = density_twin(mode, votes, weights, BANDWIDTH)
    assert height >= density_twin(votes[0], votes, weights, BANDWIDTH)
    assert (
        np.linalg.norm(mean_shift_twin(mode, votes, weights, BANDWIDTH) - mode) < 1e-2 * BANDWIDTH
    )


@pytest.mark.parametrize('seed', range(8))
def test_first_mode_is_the_highest_and_the_second_is_another(seed: int) -> None:
    votes, weights = random_votes(seed)
    modes = find_modes(cloud(votes, weights), BANDWIDTH, 2)
    heights = [density_twin(mode.astype(float), votes, weights, BANDWIDTH) for mode in modes]
    climbed = [climb(vote, cloud(votes, weights), BANDWIDTH) for vote in votes]
    best = max(
        density_twin(np.array(position, float), votes, weights, BANDWIDTH) for position in climbed
    )
    # The climb starts at the highest vote, whose hill may just miss being the highest of all.
    assert heights[0] >= 0.97 * best
    if len(modes) == 2:
        assert np.linalg.norm(modes[0] - modes[1]) >= BANDWIDTH


def test_votes_at_one_position_have_one_mode() -> None:
    votes = np.full((20, 3), 0.4, np.float32)
    modes = find_modes(cloud(votes, np.ones(20, np.float32)), BANDWIDTH, 2)
    np.testing.assert_allclose(modes, [[0.4, 0.4, 0.4]], atol=1e-6)


def test_weightless_votes_have_no_mode() -> None:
    weightless = cloud(np.zeros((5, 3), np.float32), np.zeros(5, np.float32))
    assert len(find_modes(weightless, BANDWIDTH, 2)) == 0


@pytest.mark.parametrize('seed', range(8))
def test_second_mode_is_found_beyond_the_votes_that_lead_to_the_first(seed: int) -> None:
    """Many votes lie between one and two bandwidths from the first mode and lead back to it."""
    rng = np.random.default_rng(seed)
    first = rng.normal(0, 0.6 * BANDWIDTH, (150, 3))
    second = rng.normal(0, 0.2 * BANDWIDTH, (20, 3))
    second[:, 0] += 0.4
    votes = np.concatenate([first, second]).astype(np.float32)
    modes = find_modes(cloud(votes, np.ones(170, np.float32)), BANDWIDTH, 2)
    assert len(modes) == 2
    np.testing.assert_allclose(modes[0], [0, 0, 0], atol=0.4 * BANDWIDTH)
    np.testing.assert_allclose(modes[1], [0.4, 0, 0], atol=0.2 * BANDWIDTH)


def test_votes_near_an_earlier_start_start_no_climb() -> None:
    """The third vote climbs to the first mode; the first vote leads to another mode.

    The first vote is less than a bandwidth from the third, so that it starts no climb.
    """
    votes = np.zeros((5, 3), np.float32)
    votes[:, 0] = np.array([1.3, 2.6, 1.7, 2.3, 2.8]) * BANDWIDTH
    votes[:, 1] = np.array([0.0, 2.5, 0.7, 1.8, 1.6]) * BANDWIDTH
    weights = np.array([0.9, 0.8, 0.4, 1.0, 0.8], np.float32)
    mode = [2.507 * BANDWIDTH, 1.872 * BANDWIDTH, 0]
    near = {'rtol': 0, 'atol': 0.15 * BANDWIDTH}  # a climb stops when it is nearly flat
    np.testing.assert_allclose(find_modes(cloud(votes, weights), BANDWIDTH, 2), [mode], **near)
    climbed = [climb(vote, cloud(votes, weights), BANDWIDTH) for vote in votes]
    np.testing.assert_allclose(climbed[2], mode, **near)
    np.testing.assert_allclose(climbed[0], [1.48 * BANDWIDTH, 0.297 * BANDWIDTH, 0], **near)
