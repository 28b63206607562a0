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


"""Samples for the training of the body-part forest: cells of depth grids and their classes."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.body_parts.classes import NOT_A_PERSON
from lsc_pose_ros.body_parts.depth_grid import DepthGrid, depth_grid
from lsc_pose_ros.data_types.camera import Intrinsics

_MILLIMETRES = 1000.0


class PartImage(NamedTuple):
    """A depth image whose body parts are known.

    Attributes:
        depth: metres, 0 if unknown, shape (H, W).
        parts: the class of each pixel: NOT_A_PERSON or 1 + joint number, shape (H, W), uint8.
        camera: the intrinsics.
    """

    depth: NDArray[np.float32]
    parts: NDArray[np.uint8]
    camera: Intrinsics


class PartSamples(NamedTuple):
    """S cells of I grids. The grids are stored one after the other, row by row.

    Attributes:
        depth: of all cells, millimetres, 0 if unknown, shape (cells,), uint16.
        start: index of each grid's first cell in `depth`, shape (I,).
        shape: rows and columns of each grid, shape (I, 2).
        focal_lengths: fx and fy of each grid in cells, shape (I, 2).
        image: the grid of each sample, shape (S,).
        row: its row, shape (S,).
        column: its column, shape (S,).
        part: its class, shape (S,).
    """

    depth: NDArray[np.uint16]
    start: NDArray[np.int64]
    shape: NDArray[np.int64]
    focal_lengths: NDArray[np.float32]
    image: NDArray[np.int32]
    row: NDArray[np.int32]
    column: NDArray[np.int32]
    part: NDArray[np.uint8]


def collect_samples(
    images: Iterable[PartImage],
    people: int,
    others: int,
    farthest: float,
    seed: int,
) -> PartSamples:
    """Draw samples from `images`.

    Args:
        images: the images.
        people: number of cells per image that show a person; fewer if there are not so many.
        others: number of cells per image that show no person, likewise.
        farthest: cells at a larger depth are not drawn, metres.
        seed: of the random numbers.
    """
    random = np.random.default_rng(seed)
    grids: list[DepthGrid] = []
    cells: list[NDArray[np.int32]] = []
    for number, image in enumerate(images):
        grid = depth_grid(image.depth, image.camera)
        grids.append(grid._replace(depth=_as_millimetres(grid.depth)))
        parts = parts_of_cells(image.parts, grid.step)
        depth = grids[-1].depth
        usable = (depth > 0) & (depth <= farthest * _MILLIMETRES)
        for chosen, wanted in (
            (usable & (parts != NOT_A_PERSON), people),
            (usable & (parts == NOT_A_PERSON), others),
        ):
            found = np.argwhere(chosen).astype(np.int32)
            found = found[random.permutation(len(found))[:wanted]]
            part = parts[found[:, 0], found[:, 1]].astype(np.int32)
            cells.append(np.column_stack([np.full(len(found), number, np.int32), found, part]))
    columns = np.concatenate(cells).T if cells else np.zeros((4, 0), np.int32)
    sizes = np.array([grid.depth.size for grid in grids], np.int64)
    return PartSamples(
        np.concatenate([grid.depth.ravel() for grid in grids]).astype(np.uint16),
        np.cumsum(sizes) - sizes,
        np.array([grid.depth.shape for grid in grids], np.int64),
        np.array([grid.focal_lengths for grid in grids], np.float32),
        np.ascontiguousarray(columns[0]),
        np.ascontiguousarray(columns[1]),
        np.ascontiguousarray(columns[2]),
        columns[3].astype(np.uint8),
    )


def parts_of_cells(parts: NDArray[np.uint8], step: int) -> NDArray[np.uint8]:
    """Return the class of each cell's middle pixel, shape (H // step, W // step)."""
    height, width = parts.shape[0] // step, parts.shape[1] // step
    middle = step // 2
    return parts[middle : height * step : step, middle : width * step : step]


def _as_millimetres(depth: NDArray[np.float32]) -> NDArray[np.float32]:
    millimetres: NDArray[np.float32] = np.rint(depth * _MILLIMETRES).astype(np.float32)
    return millimetres
