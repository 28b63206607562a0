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

"""Checks that the parts of a model fit together before a kernel uses them.

A file from elsewhere may be wrong, but it must not make a kernel read outside of its arrays.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.model_io.unusable_model import UnusableModelError
from lsc_pose_ros.pose.forest.forest import Forest, LeafVotes
from lsc_pose_ros.pose.model import Model

MOST_TREES = 100
"""A forest with more trees takes too long."""

MOST_SPLITS = 128
"""The largest number of splits on the way from a root to a leaf."""

MOST_VOTES = 1000
"""The largest number of votes of a leaf for joints, and for pairs; trained ones have tens."""


def check_model(model: Model) -> None:
    """Check every index that a kernel uses, because kernels check none.

    Raises:
        UnusableModelError: the model's parts do not fit together.
    """
    count, edges = len(model.joints), model.edges
    numbers = model.joints.astype(np.int64)
    if not count or numbers[-1] >= len(JOINT_NAMES) or (np.diff(numbers) <= 0).any():
        msg = 'its joints are not sorted numbers of the vocabulary'
        raise UnusableModelError(msg)
    if edges.shape[1:] != (2,) or len(edges) >= count or not _is_forest(edges, count):
        msg = 'its edges are no trees over its joints'
        raise UnusableModelError(msg)
    if model.limb_lengths.shape != edges.shape[:1] or not (model.limb_lengths > 0).all():
        msg = 'its limb lengths do not fit its edges'
        raise UnusableModelError(msg)
    _check_calibration(model.calibration, count)
    check_forest(model.forest, model.feature_size, count, len(edges))


def check_counts(trees: int, depth: int, votes: int) -> None:
    """Check what grows with the settings of a training; `check_forest` checks the forest itself.

    Args:
        trees: the number of trees.
        depth: the largest number of splits from a root to a leaf.
        votes: the largest number of votes of a leaf, for joints or for pairs.

    Raises:
        UnusableModelError: a file cannot have so many.
    """
    for count, most, what in (
        (trees, MOST_TREES, 'trees'),
        (depth, MOST_SPLITS, 'splits above a leaf'),
        (votes, MOST_VOTES, 'votes in a leaf'),
    ):
        if count > most:
            msg = f'it has {count} {what}; the limit is {most}'
            raise UnusableModelError(msg)


def check_forest(forest: Forest, features: int, joints: int, edges: int) -> None:
    """Check every index in `forest`.

    Args:
        forest: the forest.
        features: the number of features that its nodes may compare.
        joints: the number of joints.
        edges: the number of pairs of joints.

    Raises:
        UnusableModelError: an index leads outside of its array, or a number is none.
    """
    leaves = len(forest.joint_votes.start) - 1
    _check_nodes(forest, features, leaves)
    _check_depth(forest)
    _check_votes(forest.joint_votes, leaves, joints)
    _check_votes(forest.pair_votes, leaves, edges)


def _check_calibration(calibration: NDArray[np.float32], count: int) -> None:
    good = (
        len(calibration) in (0, count)
        and calibration.shape[1] > 1
        # Written so that NaN is not good.
        and bool(((calibration >= 0) & (calibration <= 1)).all())
        and bool((np.diff(calibration, axis=1) >= 0).all())
    )
    if not good:
        msg = 'its confidences do not rise within 0 to 1 for each joint'
        raise UnusableModelError(msg)


def _is_forest(edges: NDArray[np.int32], count: int) -> bool:
    """Return whether each joint has at most one parent, listed before its children."""
    if edges.size and (edges.min() < 0 or edges.max() >= count):
        return False
    if len(set(edges[:, 1].tolist())) < len(edges):
        return False
    settled: set[int] = set()
    for parent, child in edges.tolist():
        if child in settled or parent == child:
            return False
        settled |= {parent, child}
    return True


def _check_nodes(forest: Forest, size: int, leaves: int) -> None:
    """Check that every path from a root ends in one of the leaves."""
    nodes = len(forest.feature)
    if len(forest.threshold) != nodes or len(forest.left) != nodes or not len(forest.roots):
        msg = 'its trees are incomplete'
        raise UnusableModelError(msg)
    splits = forest.feature >= 0
    own = np.arange(nodes)
    good = (
        (forest.roots >= 0).all()
        and (forest.roots < nodes).all()
        and (forest.feature >= -1).all()
        and (forest.feature < size).all()
        # A child comes after its parent, so no path is a circle.
        and (forest.left[splits] > own[splits]).all()
        and (forest.left[splits] < nodes - 1).all()
        and (forest.left[~splits] >= 0).all()
        and (forest.left[~splits] < leaves).all()
    )
    if not good:
        msg = 'its trees point to nodes or leaves that do not exist'
        raise UnusableModelError(msg)


def _check_depth(forest: Forest) -> None:
    """Check that a point passes few nodes; that each node has one parent, too."""
    check_counts(len(forest.roots), 0, 0)
    level, passed = forest.roots, 0
    for _ in range(MOST_SPLITS + 1):
        passed += len(level)
        if passed > len(forest.feature):
            msg = 'its trees share nodes'
            raise UnusableModelError(msg)
        splits = level[forest.feature[level] >= 0]
        if not len(splits):
            return
        level = np.concatenate([forest.left[splits], forest.left[splits] + 1])
    msg = f'a leaf is below more than {MOST_SPLITS} splits'
    raise UnusableModelError(msg)


def _check_votes(votes: LeafVotes, leaves: int, targets: int) -> None:
    count = len(votes.target)
    good = (
        len(votes.start) == leaves + 1
        and leaves > 0
        and votes.start[0] == 0
        and votes.start[-1] == count
        and (np.diff(votes.start) >= 0).all()
        and np.diff(votes.start).max() <= MOST_VOTES
        and votes.offset.shape == (count, 3)
        and votes.weight.shape == (count,)
        and (votes.target < targets).all()
        and np.isfinite(votes.offset).all()
        and np.isfinite(votes.weight).all()
        and (votes.weight >= 0).all()
    )
    if not good:
        msg = f'its votes do not fit its leaves, or a leaf has more than {MOST_VOTES}'
        raise UnusableModelError(msg)
