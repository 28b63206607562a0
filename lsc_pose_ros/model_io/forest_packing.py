"""A forest as the small arrays of a model file.

What follows from something else is left out, and what need not be exact is rounded:

- The nodes of a tree stand level by level, so that the first split's children are the second and
  the third node, the next split's the fourth and the fifth, and no node need say where they are.
  Leaves are numbered in the same order.
- Offsets are whole steps of 0.02 rho_bar for joints, about a centimetre, and twice that for pairs;
  the densities that are made of them are 7 cm wide. Weights are fifteenths. Where these are too
  small for the largest number, they are doubled until they are not.
- The offsets of one joint are near one another, so all votes for the first joint stand first, then
  those for the second, and x, y and z by themselves: so the archive makes them smaller.
"""

from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.model_io.model_check import UnusableModelError
from lsc_pose_ros.pose.forest.forest import Forest, LeafVotes, TreeNodes

# By their names; that each is of its form is for the reader of the file to check.
Arrays: TypeAlias = dict[str, Any]

Form: TypeAlias = tuple[type[np.generic], int]
"""The type of an array and how many dimensions it has."""

_VOTES: dict[str, Form] = {
    'count': (np.uint16, 1),  # of the votes of each leaf
    'target': (np.uint8, 1),  # of each vote, leaf after leaf
    'offset': (np.int8, 2),  # of each vote, target after target, in steps
    'weight': (np.uint8, 1),  # likewise
    'steps': (np.float32, 1),  # of the offsets and of the weights
}

ARRAYS: dict[str, Form] = {
    'nodes': (np.int32, 1),  # how many each tree has
    'feature': (np.int16, 1),  # of each node, -1 in a leaf
    'threshold': (np.uint8, 1),  # of each split
    **{f'joint_{name}': form for name, form in _VOTES.items()},
    **{f'pair_{name}': form for name, form in _VOTES.items()},
}
"""What a forest is packed in."""


class _Steps(NamedTuple):
    """What is rounded to: offsets in units of rho_bar, and weights."""

    offset: float
    weight: float


# Far more than any model has, and no float32 overflows.
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
    """Return the forest that `pack_forest` has made `arrays` of.

    Raises:
        UnusableModelError: the arrays do not fit together. What is in them is not checked.
    """
    return Forest(
        *_unpack_trees(arrays), _unpack_votes('joint', arrays), _unpack_votes('pair', arrays)
    )


def _pack_trees(forest: Forest) -> tuple[dict[str, NDArray[np.generic]], NDArray[np.int32]]:
    """Return the nodes as arrays, and the leaves in their new order."""
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
    before = np.cumsum(splits) - splits  # how many splits stand before each node
    left = np.empty(len(feature), np.int32)
    # Of the k-th split of a tree, the left child is the (1 + 2 k)-th node of the tree.
    rank = before - np.repeat(before[roots], nodes)
    left[splits] = (np.repeat(roots, nodes) + 1 + 2 * rank)[splits]
    left[~splits] = np.arange(len(feature) - splits.sum())
    threshold = np.zeros(len(feature), np.uint8)
    threshold[splits] = arrays['threshold']
    return TreeNodes(roots.astype(np.int32), feature, threshold, left)


def _level_order(forest: Forest) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Return the nodes, tree after tree and level after level, and how many each tree has."""
    trees: list[NDArray[np.int64]] = []
    for root in forest.roots:
        level = np.array([root], np.int64)
        quantised = []
        while len(level):
            quantised.append(level)
            left = forest.left[level[forest.feature[level] >= 0]].astype(np.int64)
            level = np.stack([left, left + 1], axis=1).ravel()
        trees.append(np.concatenate(quantised))
    return np.concatenate(trees), np.array([len(tree) for tree in trees], np.int32)


def _in_order(votes: LeafVotes, leaves: NDArray[np.int32]) -> LeafVotes:
    """Return the votes of these `leaves`, in this order."""
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


def _step(values: NDArray[np.float32], step: float, most: int) -> np.float32:
    """Return `step`, doubled until no value is more than `most` steps."""
    largest = float(np.abs(values).max(initial=0))
    while round(largest / step) > most:
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
        msg = 'the steps of its votes are not within reason'
        raise UnusableModelError(msg)
    by_target = np.argsort(target, kind='stable')
    places = np.empty((total, 3), np.float32)
    places[by_target] = offset.T * steps[0]
    weights = np.empty(total, np.float32)
    weights[by_target] = weight * steps[1]
    return LeafVotes(_starts(count), target, places, weights)
