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

"""A forest as the small arrays of a model file.

What follows from other arrays is left out, and what need not be exact is rounded:

- The nodes of a tree are ordered level by level: the children of the first split are the second
  and third node, those of the next split the fourth and fifth, so no child index is stored.
  Leaves are numbered in the same order.
- Offsets are multiples of 0.02 rho_bar for joints, about a centimetre, and of 0.04 rho_bar for
  pairs; the densities that they form are 7 cm wide. Weights are multiples of 1/15. These steps
  are doubled until the largest value fits into the array's type.
- Votes are ordered by joint, and x, y and z are separate rows. The offsets of one joint are
  similar, so the archive compresses them well.
"""

from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.model_io.unusable_model import UnusableModelError
from lsc_pose_ros.pose.forest.forest import Forest, LeafVotes, TreeNodes

Arrays: TypeAlias = dict[str, Any]
"""Arrays by name; the reader of the file has checked that each has its form."""

Form: TypeAlias = tuple[type[np.generic], int]
"""The type of an array and its number of dimensions."""

_VOTES: dict[str, Form] = {
    'count': (np.uint16, 1),  # the number of votes of each leaf
    'target': (np.uint8, 1),  # the joint or pair of each vote, ordered by leaf
    'offset': (np.int8, 2),  # the offset of each vote in steps, ordered by target
    'weight': (np.uint8, 1),  # the weight of each vote in steps, ordered by target
    'steps': (np.float32, 1),  # the step of the offsets and that of the weights
}

ARRAYS: dict[str, Form] = {
    'nodes': (np.int32, 1),  # the number of nodes of each tree
    'feature': (np.int16, 1),  # the feature of each node; -1: the node is a leaf
    'threshold': (np.uint8, 1),  # the threshold of each split
    **{f'joint_{name}': form for name, form in _VOTES.items()},
    **{f'pair_{name}': form for name, form in _VOTES.items()},
}
"""The arrays of a packed forest."""


class _Steps(NamedTuple):
    """Values are rounded to multiples of these; offsets in units of rho_bar."""

    offset: float
    weight: float


# Far more than any model has, and small enough that no float32 overflows.
_LARGEST_STEP = 1e6

_STEPS = {'joint': _Steps(0.02, 1 / 15), 'pair': _Steps(0.04, 1 / 15)}


def pack_forest(forest: Forest) -> dict[str, NDArray[np.generic]]:
    """Return `forest` as the arrays of ARRAYS."""
    packed, leaves = _pack_trees(forest)
    return {
        **packed,
        **_pack_votes('joint', _in_order(forest.joint_votes, leaves)),
        **_pack_votes('pair', _in_order(forest.pair_votes, leaves)),
    }


def unpack_forest(arrays: Arrays) -> Forest:
    """Return the forest that `pack_forest` packed.

    Raises:
        UnusableModelError: the arrays do not fit together. Their values are not checked.
    """
    return Forest(
        *_unpack_trees(arrays), _unpack_votes('joint', arrays), _unpack_votes('pair', arrays)
    )


def _pack_trees(forest: Forest) -> tuple[dict[str, NDArray[np.generic]], NDArray[np.int32]]:
    """Return the nodes as arrays, and the old numbers of the leaves in the new order."""
    order, nodes = _level_order(forest)
    feature = forest.feature[order]
    splits = feature >= 0
    packed: dict[str, NDArray[np.generic]] = {
        'nodes': nodes,
        'feature': feature,
        'threshold': forest.threshold[order][splits],
    }
    return packed, forest.left[order][~splits]


def _unpack_trees(arrays: Arrays) -> TreeNodes:
    nodes, feature = arrays['nodes'].astype(np.int64), arrays['feature']
    splits = feature >= 0
    if (nodes < 1).any() or nodes.sum() != len(feature):
        msg = 'its trees are incomplete'
        raise UnusableModelError(msg)
    if len(arrays['threshold']) != splits.sum():
        msg = 'its thresholds do not fit its splits'
        raise UnusableModelError(msg)
    roots = np.cumsum(nodes) - nodes
    before = np.cumsum(splits) - splits  # the number of splits before each node
    left = np.empty(len(feature), np.int32)
    # The left child of a tree's k-th split is the tree's (1 + 2 k)-th node, counted from 0.
    rank = before - np.repeat(before[roots], nodes)
    left[splits] = (np.repeat(roots, nodes) + 1 + 2 * rank)[splits]
    left[~splits] = np.arange(len(feature) - splits.sum())
    threshold = np.zeros(len(feature), np.uint8)
    threshold[splits] = arrays['threshold']
    return TreeNodes(roots.astype(np.int32), feature, threshold, left)


def _level_order(forest: Forest) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Return the nodes ordered by tree and level, and the number of nodes of each tree."""
    trees: list[NDArray[np.int64]] = []
    for root in forest.roots:
        level = np.array([root], np.int64)
        levels = []
        while len(level):
            levels.append(level)
            left = forest.left[level[forest.feature[level] >= 0]].astype(np.int64)
            level = np.stack([left, left + 1], axis=1).ravel()
        trees.append(np.concatenate(levels))
    return np.concatenate(trees), np.array([len(tree) for tree in trees], np.int32)


def _in_order(votes: LeafVotes, leaves: NDArray[np.int32]) -> LeafVotes:
    """Return the votes ordered by `leaves`."""
    counts = np.diff(votes.start)[leaves]
    start = _starts(counts)
    rows = np.repeat(votes.start[:-1][leaves] - start[:-1], counts) + np.arange(start[-1])
    return LeafVotes(start, votes.target[rows], votes.offset[rows], votes.weight[rows])


def _starts(counts: NDArray[Any]) -> NDArray[np.int32]:
    return np.concatenate([[0], np.cumsum(counts, dtype=np.int64)]).astype(np.int32)


def _pack_votes(kind: str, votes: LeafVotes) -> dict[str, NDArray[np.generic]]:
    offset_step = _step(votes.offset, _STEPS[kind].offset, np.iinfo(np.int8).max)
    weight_step = _step(votes.weight, _STEPS[kind].weight, np.iinfo(np.uint8).max)
    offset = np.rint(votes.offset / offset_step).astype(np.int8)
    weight = np.rint(votes.weight / weight_step).astype(np.uint8)
    weight[(votes.weight > 0) & (weight == 0)] = 1
    by_target = np.argsort(votes.target, kind='stable')
    return {
        f'{kind}_count': np.diff(votes.start).astype(np.uint16),
        f'{kind}_target': votes.target,
        f'{kind}_offset': np.ascontiguousarray(offset[by_target].T),
        f'{kind}_weight': weight[by_target],
        f'{kind}_steps': np.array([offset_step, weight_step], np.float32),
    }


def _step(values: NDArray[np.float32], step: float, limit: int) -> np.float32:
    """Return `step`, doubled until no value is more than `limit` steps."""
    largest = float(np.abs(values).max(initial=0))
    while round(largest / step) > limit:
        step *= 2
    return np.float32(step)


def _unpack_votes(kind: str, arrays: Arrays) -> LeafVotes:
    count, target, offset, weight, steps = (
        arrays[f'{kind}_{name}'] for name in ('count', 'target', 'offset', 'weight', 'steps')
    )
    total = int(count.sum(dtype=np.int64))
    if not (len(target) == len(weight) == total and offset.shape == (3, total)):
        msg = 'its votes do not fit its leaves'
        raise UnusableModelError(msg)
    if steps.shape != (2,) or not ((steps > 0) & (steps < _LARGEST_STEP)).all():
        msg = 'the steps of its votes are out of range'
        raise UnusableModelError(msg)
    by_target = np.argsort(target, kind='stable')
    offsets = np.empty((total, 3), np.float32)
    offsets[by_target] = offset.T * steps[0]
    weights = np.empty(total, np.float32)
    weights[by_target] = weight * steps[1]
    return LeafVotes(_starts(count), target, offsets, weights)
