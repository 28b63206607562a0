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

from lsc_pose_ros.pose.features.shape_context_3d import DESCRIPTOR_SIZE
from lsc_pose_ros.pose.forest.forest import Forest, LeafVotes, find_leaves
from lsc_pose_ros.pose.forest.votes import VoteSettings, gather_votes


def random_votes(rng: np.random.Generator, leaves: int, targets: int) -> LeafVotes:
    counts = rng.integers(0, 6, leaves)
    start = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    total = int(start[-1])
    return LeafVotes(
        start,
        rng.integers(0, targets, total).astype(np.uint8),
        rng.normal(0, 0.2, (total, 3)).astype(np.float32),
        # Few different weights, so that many are equal at the limit.
        rng.choice([0.2, 0.5, 0.5, 0.9], total).astype(np.float32),
    )


def random_forest(seed: int, targets: int = 5) -> Forest:
    """Return two random trees: splits and leaves in the order in which they are made."""
    rng = np.random.default_rng(seed)
    feature: list[int] = []
    left: list[int] = []
    roots: list[int] = []
    leaves = 0
    for _ in range(2):
        waiting = [len(feature)]
        roots.append(len(feature))
        feature.append(-1)
        left.append(0)
        while waiting:
            node = waiting.pop(0)
            if rng.random() < 0.6 or (len(waiting) < 2 and len(feature) < 40):
                feature[node] = int(rng.integers(DESCRIPTOR_SIZE))
                left[node] = len(feature)
                for _child in range(2):
                    waiting.append(len(feature))
                    feature.append(-1)
                    left.append(0)
            else:
                left[node] = leaves
                leaves += 1
            if len(feature) > 400:
                break
        for node in waiting:
            left[node] = leaves
            leaves += 1
    return Forest(
        np.array(roots, np.int32),
        np.array(feature, np.int16),
        rng.integers(1, 255, len(feature)).astype(np.uint8),
        np.array(left, np.int32),
        random_votes(rng, leaves, targets),
        random_votes(rng, leaves, targets),
    )


def leaf_twin(forest: Forest, quantised: np.ndarray, root: int) -> int:
    """Equation 7 at every node: left below the threshold, else right."""
    node = root
    while forest.feature[node] != -1:
        right = not quantised[forest.feature[node]] < forest.threshold[node]
        node = int(forest.left[node]) + right
    return int(forest.left[node])


@pytest.mark.parametrize('seed', range(5))
def test_every_point_finds_its_leaf(seed: int) -> None:
    forest = random_forest(seed)
    rng = np.random.default_rng(seed)
    quantised = rng.integers(0, 256, (70, DESCRIPTOR_SIZE)).astype(np.uint8)
    expected = [[leaf_twin(forest, row, int(root)) for root in forest.roots] for row in quantised]
    np.testing.assert_array_equal(find_leaves(forest, quantised), expected)


def test_a_level_at_the_threshold_goes_right() -> None:
    votes = random_votes(np.random.default_rng(0), 2, 1)
    forest = Forest(
        np.zeros(1, np.int32),
        np.array([7, -1, -1], np.int16),
        np.array([100, 0, 0], np.uint8),
        np.array([1, 0, 1], np.int32),
        votes,
        votes,
    )
    quantised = np.zeros((3, DESCRIPTOR_SIZE), np.uint8)
    quantised[:, 7] = [99, 100, 101]
    assert find_leaves(forest, quantised)[:, 0].tolist() == [0, 1, 1]


def votes_twin(
    votes: LeafVotes, leaves: np.ndarray, origins: np.ndarray, vote_settings: VoteSettings
) -> list[list[tuple[float, list[float]]]]:
    """Equation 13 for each target, then the heaviest, earlier ones first among equals."""
    cast: list[list[tuple[float, list[float]]]] = [[] for _ in range(vote_settings.targets)]
    for point, row in enumerate(leaves):
        for leaf in row:
            for entry in range(votes.start[leaf], votes.start[leaf + 1]):
                place = origins[point] + vote_settings.scale * votes.offset[entry]
                cast[votes.target[entry]].append((float(votes.weight[entry]), place.tolist()))
    return [sorted(mine, key=lambda vote: -vote[0])[: vote_settings.heaviest] for mine in cast]


@pytest.mark.parametrize('seed', range(5))
@pytest.mark.parametrize('heaviest', [1, 7, 10_000])
def test_the_heaviest_votes_are_cast(seed: int, heaviest: int) -> None:
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
            np.array([place for _, place in found]).reshape(-1, 3),
            np.array([place for _, place in expected]).reshape(-1, 3),
            atol=1e-6,
        )


def test_a_target_without_votes_has_none() -> None:
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
