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

"""Trains the rival Random Tree Walks on labelled frames."""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.depth_comparisons import join_nodes
from lsc_pose_experiments.sampled_frames import SampledFrame, decode_frames
from lsc_pose_experiments.walks.direction_samples import (
    draw_samples,
    join_grids,
    labelled_bodies,
)
from lsc_pose_experiments.walks.direction_tree_growth import (
    DirectionGrowth,
    DirectionTree,
    grow_direction_tree,
)
from lsc_pose_experiments.walks.walk_estimator import WalkModel
from lsc_pose_experiments.walks.walk_trees import DirectionTrees, WalkSettings
from lsc_pose_ros.errors import InputError


class WalkModelSettings(NamedTuple):
    """The settings of the training and of the walks.

    Attributes:
        points: number of points around each joint of each body that are learned from.
        reach: the largest distance of these points from the joint, metres; a walk must not start
            farther away.
        growth: settings of each tree.
        walk: settings of the walks.
    """

    points: int = 100
    reach: float = 0.5
    growth: DirectionGrowth = DirectionGrowth()
    walk: WalkSettings = WalkSettings()


def train_walk_model(
    frames: Sequence[SampledFrame],
    joints: NDArray[np.uint16],
    settings: WalkModelSettings,
    seed: int,
) -> WalkModel:
    """Return a model trained on the labelled people in `frames`; its trees grow in parallel.

    Args:
        frames: the frames.
        joints: the numbers of the joints to learn; those that are never labelled are left out.
        settings: the settings.
        seed: seed of all random numbers.

    Raises:
        InputError: there is nothing to learn from.
    """
    bodies = [body for frame in decode_frames(frames) for body in labelled_bodies(frame, joints)]
    if not bodies:
        msg = 'no labelled person is visible; the directions to the joints cannot be learned'
        raise InputError(msg)
    positions = np.stack([body.joints for body in bodies])
    learned = np.flatnonzero(np.isfinite(positions).all(axis=2).any(axis=0))
    grids = join_grids(body.grid for body in bodies)
    seeds = np.random.SeedSequence(seed).spawn(len(learned))

    def grow(j: int) -> DirectionTree:
        rng = np.random.default_rng(seeds[j])
        samples = draw_samples(positions[:, learned[j]], settings.points, settings.reach, rng)
        return grow_direction_tree(grids, samples, settings.growth, int(rng.integers(2**31)))

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        trees = join_direction_trees(list(pool.map(grow, range(len(learned)))))
    return WalkModel(joints[learned], trees, settings.walk, seed)


def join_direction_trees(trees: list[DirectionTree]) -> DirectionTrees:
    """Return the trees in one table, with nodes and leaves renumbered consecutively."""
    nodes = join_nodes([tree.left for tree in trees])
    return DirectionTrees(
        nodes.roots,
        np.concatenate([tree.splits for tree in trees]),
        nodes.left,
        np.concatenate([tree.directions for tree in trees]),
        np.concatenate([tree.cumulative for tree in trees]),
    )
