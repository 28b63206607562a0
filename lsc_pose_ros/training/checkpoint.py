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

"""What a training that is interrupted leaves behind, so that another one can go on from there."""

import hashlib
from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.pose.forest.forest import LeafVotes
from lsc_pose_ros.training.samples import Samples


class FinishedTree(NamedTuple):
    """A tree with the votes of its leaves; nodes and leaves are numbered from 0.

    Attributes:
        feature, threshold, left: as in Forest, shape (nodes,).
        joint_votes: votes for the joints.
        pair_votes: votes for the pairs of joints.
    """

    feature: NDArray[np.int16]
    threshold: NDArray[np.uint8]
    left: NDArray[np.int32]
    joint_votes: LeafVotes
    pair_votes: LeafVotes


class Limits(NamedTuple):
    """What the indices in a tree must stay below.

    Attributes:
        features: the number of features.
        joints: the number of joints.
        edges: the number of pairs of joints.
    """

    features: int
    joints: int
    edges: int


class Checkpoint(Protocol):
    """Where a training keeps its finished trees.

    Each tree has random numbers of its own, so the trees that are kept and those that are grown
    later make the same forest as an uninterrupted training.
    """

    def load(self, key: str, limits: Limits, wanted: int) -> list[FinishedTree]:
        """Return the trees that the training `key` has finished before, at most `wanted`.

        They are checked by `limits`.
        """

    def store(self, key: str, trees: Sequence[FinishedTree]) -> None:
        """Keep the finished trees of the training `key`, if possible: it goes on anyway."""


def training_key(samples: Samples, settings: object) -> str:
    """Return a text that two trainings share only if their trees are the same.

    Args:
        samples: the samples that the trees learn.
        settings: all that changes a tree besides the samples, as a tuple of tuples.
    """
    digest = hashlib.sha256(repr(settings).encode())
    for array in samples:
        digest.update(repr((array.shape, array.dtype.str)).encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()
