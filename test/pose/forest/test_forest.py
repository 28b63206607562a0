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

"""The leaves that descriptors reach, against equation 7."""

import numpy as np
import pytest
from random_votes import random_votes

from lsc_pose_ros.pose.features.shape_context_3d import DESCRIPTOR_SIZE
from lsc_pose_ros.pose.forest.forest import Forest, find_leaves


def random_forest(seed: int, targets: int = 5) -> Forest:
    """Return two random trees."""
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


def test_value_at_the_threshold_goes_right() -> None:
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
