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


"""Classifies the cells of a depth grid twice: alone, and with what is around them.

A forest that only sees depth takes many things of the size of a limb for one. The second forest
also compares what the first one found: there are legs below a trunk, and a head above it.
Z. Tu and X. Bai, "Auto-context and its application to high-level vision tasks and 3D brain image
segmentation", PAMI 2010.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.body_parts.depth_grid import DepthGrid
from lsc_pose_ros.body_parts.part_forest import (
    NOT_A_PERSON,
    PartForest,
    classify_cells,
    classify_likely,
)
from lsc_pose_ros.body_parts.smoothing import SMOOTHING_REACH, smooth_person
from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.numerics.jit import kernel

_SIDES = ('l', 'r')
_GROUPS = (
    ('head', 'neck'),
    ('torso', 'pelvis', *(f'{s}_{name}' for s in _SIDES for name in ('shoulder', 'hip'))),
    tuple(f'{s}_{name}' for s in _SIDES for name in ('elbow', 'wrist', 'hand')),
    tuple(f'{s}_{name}' for s in _SIDES for name in ('knee', 'ankle', 'foot')),
)

PLANES = 2 + len(_GROUPS)
"""Depth; the probability of a person; those of head, trunk, arms and legs."""

_PLANE_OF_CLASS = np.zeros(1 + len(JOINT_NUMBERS), np.int64)
for _plane, _names in enumerate(_GROUPS):
    for _name in _names:
        _PLANE_OF_CLASS[1 + JOINT_NUMBERS[_name]] = 2 + _plane

UNIT = np.float32(0.001)
"""Values are multiples of this; a probability p is stored as p + UNIT, because 0 is unknown."""


REFINED = 0.35
"""Cells that show a person with a smaller smoothed probability are not classified again."""


class PartForests(NamedTuple):
    """The two forests that classify body parts.

    Attributes:
        first: compares depths.
        second: compares the planes of `context_planes`.
    """

    first: PartForest
    second: PartForest


class CellParts(NamedTuple):
    """What the cells of a grid show.

    Attributes:
        depth: metres, 0 if unknown, shape (h, w).
        probabilities: of each class, shape (h, w, CLASSES); all 0 at a cell that is not
            classified.
        person: the smoothed probability of a person, shape (h, w).
    """

    depth: NDArray[np.float32]
    probabilities: NDArray[np.float32]
    person: NDArray[np.float32]


def classify_in_context(
    grid: DepthGrid, forests: PartForests, stride: int, farthest: float
) -> CellParts:
    """Return what every `stride`-th cell of a grid shows.

    Cells that the first forest takes for a person are classified by the second one.

    Args:
        grid: the depth grid.
        forests: the forests.
        stride: how many cells apart the classified ones are, along rows and columns.
        farthest: cells at a larger depth are not classified, metres.
    """
    alone = classify_alone(grid, forests.first, stride, farthest)
    planes = context_planes(alone.depth, alone.probabilities, alone.person)
    wanted = alone.person >= REFINED
    fx, fy = grid.focal_lengths
    probabilities = np.zeros_like(alone.probabilities)
    classify_cells(planes, (fx / stride, fy / stride), forests.second, 1, wanted, probabilities)
    known = (alone.depth > 0) & (alone.depth <= farthest)
    probabilities[known & ~wanted, NOT_A_PERSON] = 1
    person = smooth_person(probabilities, alone.depth, SMOOTHING_REACH)
    return CellParts(alone.depth, probabilities, person)


def classify_alone(grid: DepthGrid, forest: PartForest, stride: int, farthest: float) -> CellParts:
    """Return what every `stride`-th cell shows according to the first forest.

    Args: see `classify_in_context`.
    """
    depth = np.ascontiguousarray(grid.depth[::stride, ::stride])
    probabilities = classify_likely(grid, forest, stride, farthest)
    return CellParts(depth, probabilities, smooth_person(probabilities, depth, SMOOTHING_REACH))


@kernel
def context_planes(
    depth: NDArray[np.float32],
    probabilities: NDArray[np.float32],
    person: NDArray[np.float32],
) -> NDArray[np.float32]:
    """Return the planes, shape (PLANES, h, w), all multiples of UNIT.

    Args:
        depth: metres, 0 if unknown, shape (h, w).
        probabilities: of each class, shape (h, w, CLASSES); all 0 where nothing was classified.
        person: the smoothed probability of a person, shape (h, w).
    """
    height, width = depth.shape
    planes = np.zeros((PLANES, height, width), np.float32)
    for i in range(height):
        for j in range(width):
            here = planes[:, i, j]
            here[0] = np.rint(depth[i, j] / UNIT) * UNIT
            here[1] = person[i, j]
            for c in range(1, probabilities.shape[2]):
                here[_PLANE_OF_CLASS[c]] += probabilities[i, j, c]
            for p in range(1, PLANES):
                here[p] = (np.rint(here[p] / UNIT) + np.float32(1.0)) * UNIT
    return planes
