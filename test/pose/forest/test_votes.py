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

"""The votes of points, against equation 13."""

import numpy as np
import pytest
from random_votes import random_votes

from lsc_pose_ros.pose.forest.forest import LeafVotes
from lsc_pose_ros.pose.forest.votes import VoteSettings, gather_votes


def votes_twin(
    votes: LeafVotes, leaves: np.ndarray, origins: np.ndarray, vote_settings: VoteSettings
) -> list[list[tuple[float, list[float]]]]:
    """Equation 13 for each target, then the heaviest, earlier ones first among equals."""
    cast: list[list[tuple[float, list[float]]]] = [[] for _ in range(vote_settings.targets)]
    for point, row in enumerate(leaves):
        for leaf in row:
            for entry in range(votes.start[leaf], votes.start[leaf + 1]):
                position = origins[point] + vote_settings.scale * votes.offset[entry]
                cast[votes.target[entry]].append((float(votes.weight[entry]), position.tolist()))
    return [sorted(mine, key=lambda vote: -vote[0])[: vote_settings.heaviest] for mine in cast]


@pytest.mark.parametrize('seed', range(5))
@pytest.mark.parametrize('heaviest', [1, 7, 10_000])
def test_heaviest_votes_are_kept(seed: int, heaviest: int) -> None:
    rng = np.random.default_rng(seed)
    votes = random_votes(rng, 30, 4)
    leaves = rng.integers(0, 30, (40, 3)).astype(np.int32)
    origins = rng.normal(0, 1, (40, 3)).astype(np.float32)
    vote_settings = VoteSettings(4, heaviest, 0.7)
    cast = gather_votes(votes, leaves, origins, vote_settings)
    for target, expected in enumerate(votes_twin(votes, leaves, origins, vote_settings)):
        mine = slice(cast.start[target], cast.start[target + 1])
        found = sorted(
            zip(cast.weight[mine].tolist(), cast.position[mine].tolist(), strict=True),
            key=lambda vote: -vote[0],
        )
        assert [weight for weight, _ in found] == [weight for weight, _ in expected]
        np.testing.assert_allclose(
            np.array([position for _, position in found]).reshape(-1, 3),
            np.array([position for _, position in expected]).reshape(-1, 3),
            atol=1e-6,
        )


def test_target_without_votes_has_none() -> None:
    votes = LeafVotes(
        np.zeros(2, np.int32),
        np.zeros(0, np.uint8),
        np.zeros((0, 3), np.float32),
        np.zeros(0, np.float32),
    )
    cast = gather_votes(
        votes, np.zeros((5, 1), np.int32), np.zeros((5, 3), np.float32), VoteSettings(3, 9, 1.0)
    )
    assert cast.start.tolist() == [0, 0, 0, 0]
    assert len(cast.weight) == 0
