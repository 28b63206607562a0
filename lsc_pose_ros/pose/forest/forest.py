"""A regression forest as flat parallel arrays, and the way of a descriptor down its trees."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel


class TreeNodes(NamedTuple):
    """The nodes of T trees and nothing else, as in Forest."""

    roots: NDArray[np.int32]
    feature: NDArray[np.int16]
    threshold: NDArray[np.uint8]
    left: NDArray[np.int32]


class LeafVotes(NamedTuple):
    """The relative votes of all leaves, leaf after leaf (eq. 11, 12).

    Attributes:
        start: the votes of leaf l are start[l] to start[l + 1], shape (L + 1,).
        target: which joint, or which edge, a vote is for, shape (V,).
        offset: in units of rho_bar, shape (V, 3).
        weight: the size of the cluster that the vote stands for, shape (V,).
    """

    start: NDArray[np.int32]
    target: NDArray[np.uint8]
    offset: NDArray[np.float32]
    weight: NDArray[np.float32]


class Forest(NamedTuple):
    """T trees in one set of node arrays; a node is a split or a leaf.

    Attributes:
        roots: the node at which each tree begins, shape (T,).
        feature: which bin of the descriptor a split compares, -1 in a leaf, shape (nodes,).
        threshold: a level below it goes left, shape (nodes,) (eq. 7).
        left: a split's left child (the right one follows it), a leaf's number, shape (nodes,).
        joint_votes: the leaves' votes for joints, relative to the point.
        pair_votes: the leaves' votes for edges: the child joint relative to its parent.
    """

    roots: NDArray[np.int32]
    feature: NDArray[np.int16]
    threshold: NDArray[np.uint8]
    left: NDArray[np.int32]
    joint_votes: LeafVotes
    pair_votes: LeafVotes


@kernel
def find_leaves(forest: Forest, quantised: NDArray[np.uint8]) -> NDArray[np.int32]:
    """Return the leaf that each descriptor reaches in each tree, shape (N, T).

    Args:
        forest: the trees.
        quantised: quantised descriptors, shape (N, 360).
    """
    # All points go down a tree together, a step at a time: nodes lie anywhere in memory, and those
    # of several points are fetched at once, while a point's next one is known only after its last.
    count = quantised.shape[0]
    leaves = np.empty((count, forest.roots.shape[0]), np.int32)
    nodes = np.empty(count, np.int32)
    on_their_way = np.empty(count, np.int32)
    for tree in range(forest.roots.shape[0]):
        for i in range(count):
            nodes[i], on_their_way[i] = forest.roots[tree], i
        walking = count
        while walking:
            still_walking = 0
            for n in range(walking):
                i, node = on_their_way[n], nodes[n]
                feature, left = forest.feature[node], forest.left[node]
                if feature < 0:
                    leaves[i, tree] = left
                else:
                    goes_right = quantised[i, feature] >= forest.threshold[node]
                    nodes[still_walking] = left + goes_right
                    on_their_way[still_walking] = i
                    still_walking += 1
            walking = still_walking
    return leaves
