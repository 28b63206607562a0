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


"""Trains the forest that classifies body parts."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from lsc_pose_experiments.depth_comparisons import join_nodes
from lsc_pose_experiments.shotton.part_forest import PartForest
from lsc_pose_experiments.shotton.part_samples import PartSamples
from lsc_pose_experiments.shotton.part_tree_growth import PartGrowth, PartTree, grow_part_tree
from lsc_pose_ros.errors import InputError

_BYTE = 255


def train_part_forest(
    samples: PartSamples,
    trees: int,
    growth: PartGrowth,
    seed: int,
    progress: Callable[[str], None] = lambda _step: None,
) -> PartForest:
    """Return a forest trained on `samples`; its trees grow in parallel.

    Args:
        samples: the samples.
        trees: number of trees.
        growth: the settings of each tree.
        seed: of all random numbers.
        progress: called with a description of each step as it begins.

    Raises:
        InputError: there are no samples.
    """
    if not len(samples.part):
        msg = 'no image has a pixel with depth; the body parts cannot be learnt'
        raise InputError(msg)
    progress(f'growing {trees} trees on {len(samples.part)} samples')
    seeds = np.random.SeedSequence(seed).generate_state(trees)
    with ThreadPoolExecutor(trees) as pool:
        grown = list(pool.map(lambda each: grow_part_tree(samples, growth, each), seeds))
    return join_part_trees(grown)


def join_part_trees(trees: list[PartTree]) -> PartForest:
    """Return the trees as one forest, with nodes and leaves renumbered consecutively."""
    nodes = join_nodes([tree.left for tree in trees])
    return PartForest(
        nodes.roots,
        np.concatenate([tree.splits for tree in trees]),
        nodes.left,
        np.rint(np.concatenate([tree.leaves for tree in trees]) * _BYTE).astype(np.uint8),
    )
