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


"""The body-part forest, against plain numpy and its equations."""

import numpy as np
import pytest
from lsc_pose_experiments.shotton.part_forest import SURE, PartForest, classify
from plain.depth_comparison import comparison_twin
from random_depth import random_depth

from lsc_pose_ros.body_parts.classes import CLASSES, NOT_A_PERSON
from lsc_pose_ros.body_parts.depth_grid import depth_grid
from lsc_pose_ros.data_types.camera import Intrinsics

CAMERA = Intrinsics(140.0, 150.0, 79.5, 59.5)


def random_forest(seed: int, trees: int = 3) -> PartForest:
    """Return trees of three splits and four leaves each."""
    rng = np.random.default_rng(seed)
    splits = rng.uniform(-1.5, 1.5, (7 * trees, 5)).astype(np.float32)
    splits[rng.random(len(splits)) < 0.4, 2:4] = 0
    left = np.concatenate(
        [
            [7 * t + 1, 7 * t + 3, 7 * t + 5, *(-1 - np.arange(4 * t, 4 * t + 4))]
            for t in range(trees)
        ]
    )
    leaves = rng.integers(0, 256, (4 * trees, CLASSES)).astype(np.uint8)
    leaves[::3, NOT_A_PERSON] = 250
    roots = np.arange(trees, dtype=np.int32) * 7
    return PartForest(roots, splits, left.astype(np.int32), leaves)


@pytest.mark.parametrize('stride', [1, 2, 3])
@pytest.mark.parametrize('seed', range(3))
def test_probabilities_are_the_mean_of_the_leaves(seed: int, stride: int) -> None:
    forest = random_forest(seed)
    grid = depth_grid(random_depth(seed), CAMERA)
    found = classify(grid, forest, stride, 5.0)
    assert found.shape == (-(-30 // stride), -(-41 // stride), CLASSES)
    wrong = 0
    for i, j in np.ndindex(found.shape[:2]):
        row, column = i * stride, j * stride
        if not 0 < grid.depth[row, column] <= 5.0:
            assert not found[i, j].any()
            continue
        reached = []
        for root in forest.roots:
            node = root
            while forest.left[node] >= 0:
                value = comparison_twin(grid.depth, row, column, forest.splits[node], CAMERA)
                node = forest.left[node] + int(value >= forest.splits[node, 4])
            reached.append(forest.leaves[-1 - forest.left[node]] / 255)
            if np.mean(reached, axis=0)[NOT_A_PERSON] >= SURE:
                break
        wrong += not np.allclose(found[i, j], np.mean(reached, axis=0), rtol=0, atol=1e-6)
    assert wrong <= 0.02 * found[..., 0].size


@pytest.mark.parametrize('value', [0.0, np.nan, np.inf, np.finfo(np.float32).max])
def test_an_image_without_depth_has_no_probabilities(value: float) -> None:
    grid = depth_grid(np.full((40, 50), value, np.float32), CAMERA)
    assert not grid.depth.any()
    assert not classify(grid, random_forest(0), 2, 6.0).any()
