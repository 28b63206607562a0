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

"""The size of a person: the lengths of the limbs, which do not change, learnt over seconds."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS, default_edges

LONGEST_MEMORY = 60.0
"""So many sure frames are remembered; older ones fade."""

LEAST_KNOWN = 3.0
"""Sizes of which less is known, in sure frames, are not compared."""

LENGTH_ERROR = 0.05
"""The standard deviation of a length in a frame, metres."""

MOST_DIFFERENT = 3.0
"""The sizes of two people never differ by more than this."""


class BodySize(NamedTuple):
    """The lengths of a person's limbs.

    Attributes:
        lengths: the mean of each, metres, 0 if unknown, shape (E,).
        weight: how many sure frames each is from, shape (E,).
    """

    lengths: NDArray[np.float64]
    weight: NDArray[np.float64]

    def updated(self, seen: 'BodySize') -> 'BodySize':
        """Return the size after another frame."""
        total = self.weight + seen.weight
        lengths = (self.weight * self.lengths + seen.weight * seen.lengths) / np.where(
            total > 0, total, 1
        )
        return BodySize(lengths, np.minimum(total, LONGEST_MEMORY))


def limbs_of(joints: NDArray[np.uint16]) -> NDArray[np.int32]:
    """Return the edges and the trunk as pairs of indices into `joints`, shape (E, 2)."""
    edges, numbers = default_edges(joints), joints.tolist()
    trunk = [JOINT_NUMBERS['torso'], JOINT_NUMBERS['pelvis']]
    if not set(trunk) <= set(numbers):
        return edges
    return np.append(edges, [[numbers.index(each) for each in trunk]], axis=0).astype(np.int32)


def size_in_frame(
    positions: NDArray[np.float32], confidence: NDArray[np.float32], limbs: NDArray[np.int32]
) -> BodySize:
    """Return the size of a body in one frame; a limb weighs as much as its less certain end.

    Args:
        positions: of the joints, metres, NaN if unknown, shape (J, 3).
        confidence: of each, shape (J,).
        limbs: as `limbs_of`.
    """
    first, second = limbs.T
    lengths = np.linalg.norm(positions[first] - positions[second], axis=1).astype(np.float64)
    known = np.isfinite(lengths)
    weight = np.where(known, np.minimum(confidence[first], confidence[second]), 0.0)
    return BodySize(np.where(known, lengths, 0.0), weight.astype(np.float64))


def size_difference(first: BodySize, second: BodySize) -> float:
    """Return how different two sizes are: the mean of w ((l - m) / e)^2, at most MOST_DIFFERENT.

    A limb counts as much as it is known in both, w. It is 0 if too little is known of the first.
    """
    weight = np.minimum(np.minimum(first.weight, second.weight), 1.0)
    if not len(weight) or first.weight.max() < LEAST_KNOWN:
        return 0.0
    squared = ((first.lengths - second.lengths) / LENGTH_ERROR) ** 2
    return min(float((weight * squared).mean()), MOST_DIFFERENT)
