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


"""Samples for the training of the second body-part forest: cells with what is around them."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.body_parts.context import REFINED, UNIT, classify_alone, context_planes
from lsc_pose_ros.body_parts.depth_grid import DepthGrid
from lsc_pose_ros.body_parts.part_forest import NOT_A_PERSON, PartForest
from lsc_pose_ros.training.body_parts.part_samples import PartSamples


class PartGrid(NamedTuple):
    """A depth grid whose body parts are known.

    Attributes:
        grid: the depth grid.
        parts: the class of each cell, shape (h, w), uint8.
    """

    grid: DepthGrid
    parts: NDArray[np.uint8]


def collect_context_samples(
    images: Iterable[PartGrid],
    first: PartForest,
    stride: int,
    most: int,
    farthest: float,
    seed: int,
) -> PartSamples:
    """Draw samples from the cells that the second forest has to classify.

    Args:
        images: depth grids with their body parts; the first forest must not have learnt from them.
        first: the first forest.
        stride: how many cells apart the classified ones are.
        most: the largest number of cells per image that show a person, and of those that do not.
        farthest: cells at a larger depth are not drawn, metres.
        seed: of the random numbers.
    """
    random = np.random.default_rng(seed)
    planes, shapes, focal_lengths, cells = [], [], [], []
    for number, (grid, every_part) in enumerate(images):
        alone = classify_alone(grid, first, stride, farthest)
        values = context_planes(alone.depth, alone.probabilities, alone.person)
        planes.append(np.rint(values / UNIT).astype(np.uint16).reshape(len(values), -1))
        shapes.append(alone.depth.shape)
        focal_lengths.append([length / stride for length in grid.focal_lengths])
        parts = every_part[::stride, ::stride]
        refined = alone.person >= REFINED
        for chosen in (refined & (parts != NOT_A_PERSON), refined & (parts == NOT_A_PERSON)):
            found = np.argwhere(chosen)
            found = found[random.permutation(len(found))[:most]]
            part = parts[found[:, 0], found[:, 1]]
            cells.append(np.column_stack([np.full(len(found), number), found, part]))
    sizes = np.array([each.shape[1] for each in planes], np.int64)
    columns = np.concatenate(cells).T
    return PartSamples(
        np.concatenate(planes, axis=1),
        np.cumsum(sizes) - sizes,
        np.array(shapes, np.int64),
        np.array(focal_lengths, np.float32),
        columns[0].astype(np.int32),
        columns[1].astype(np.int32),
        columns[2].astype(np.int32),
        columns[3].astype(np.uint8),
    )
