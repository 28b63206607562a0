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

"""A regression forest as flat parallel arrays, and the leaves that descriptors reach in it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel


class TreeNodes(NamedTuple):
    """The nodes of T trees; the attributes are those of Forest."""

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
        weight: the size of the cluster that the vote represents, shape (V,).
    """

    start: NDArray[np.int32]
    target: NDArray[np.uint8]
    offset: NDArray[np.float32]
    weight: NDArray[np.float32]


class Forest(NamedTuple):
    """T trees in one set of node arrays; a node is a split or a leaf.

    Attributes:
        roots: the root node of each tree, shape (T,).
        feature: the index of the feature that a split compares, -1 in a leaf, shape (nodes,).
        threshold: a smaller feature goes left, shape (nodes,) (eq. 7).
        left: a split's left child (the right one follows it), or a leaf's number, (nodes,).
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
    """Return the leaf that each descriptor reaches in each tree, shape (N, T) (eq. 7).

    Args:
        forest: the trees.
        quantised: quantised descriptors, shape (N, F).
    """
    # All points descend a tree together, one level at a time. The nodes are scattered over memory:
    # the processor fetches those of several points at once, but cannot fetch a point's next node
    # before its current one is there.
    count = quantised.shape[0]
    leaves = np.empty((count, forest.roots.shape[0]), np.int32)
    nodes = np.empty(count, np.int32)
    descending = np.empty(count, np.int32)
    for tree in range(forest.roots.shape[0]):
        for i in range(count):
            nodes[i], descending[i] = forest.roots[tree], i
        active = count
        while active:
            remaining = 0
            for n in range(active):
                i, node = descending[n], nodes[n]
                feature, left = forest.feature[node], forest.left[node]
                if feature < 0:
                    leaves[i, tree] = left
                else:
                    goes_right = quantised[i, feature] >= forest.threshold[node]
                    nodes[remaining] = left + goes_right
                    descending[remaining] = i
                    remaining += 1
            active = remaining
    return leaves
