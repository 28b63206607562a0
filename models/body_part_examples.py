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


# ruff: noqa: INP001 - no package
"""Images as the network of body parts sees them in its training: varied at random."""

from typing import Any, NamedTuple

import numpy as np
from body_part_scenes import PartGrids
from numpy.typing import NDArray

from lsc_pose_ros.body_parts.part_network import input_planes
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.segmentation.people import FARTHEST, STRIDE

HEIGHT, WIDTH = 64, 80
"""Rows and columns of all images; others are cut or filled at random."""

_TYPICAL_CELLS = 200
"""A person of so many cells counts once."""

_NOBODY = np.float32(0.6)
"""How much a cell counts that shows no person."""

_BEYOND = 0.3
"""Cells so much farther than FARTHEST are still learnt, metres."""


class Example(NamedTuple):
    """One image.

    Attributes:
        planes: what the network sees, shape (INPUTS, HEIGHT, WIDTH).
        parts: the class of each cell, shape (HEIGHT, WIDTH), int64.
        to_middle: from each cell to the middle of its person as in `CellParts`, metres, shape
            (3, HEIGHT, WIDTH).
        weight: how much each cell counts, shape (HEIGHT, WIDTH).
    """

    planes: NDArray[np.float32]
    parts: NDArray[np.int64]
    to_middle: NDArray[np.float32]
    weight: NDArray[np.float32]


class _View(NamedTuple):
    """A part of an image at one resolution.

    Attributes:
        depth: metres, 0 if unknown, shape (h, w).
        parts: the class of each cell, shape (h, w).
        bodies: the body number of each cell, shape (h, w).
        focal_length: in cells.
    """

    depth: NDArray[np.float32]
    parts: NDArray[np.uint8]
    bodies: NDArray[np.uint8]
    focal_length: float


def _other_sides() -> NDArray[np.uint8]:
    """Return the class of each class in the mirror."""
    sides = {'l_': 'r_', 'r_': 'l_'}
    names = [sides.get(name[:2], name[:2]) + name[2:] for name in JOINT_NAMES]
    return np.array([0, *(1 + JOINT_NAMES.index(name) for name in names)], np.uint8)


OTHER_SIDES = _other_sides()


def draw_example(grids: PartGrids, index: int, random: np.random.Generator) -> Example:
    """Return an image of `grids`, with random resolution, mirror, depth loss and noise."""
    view = _resampled(grids, index, random)
    if random.random() < 0.5:
        view = _mirrored(view)
    depth = _disturbed(view.depth, random)
    planes = input_planes(np.ascontiguousarray(depth), (view.focal_length, view.focal_length))
    lines = _span(depth.shape[0], HEIGHT, random), _span(depth.shape[1], WIDTH, random)
    return Example(
        _framed(planes, lines),
        _framed(view.parts.astype(np.int64), lines),
        _framed(ways_to_middles(depth, view.bodies, view.focal_length), lines),
        _framed(_weights(depth, view.bodies), lines),
    )


def _resampled(grids: PartGrids, index: int, random: np.random.Generator) -> _View:
    """Return the image with other distances of its cells."""
    depth = grids.depth[index]
    spacing = float(STRIDE)
    if random.random() < 0.6:
        spacing *= float(np.exp(random.uniform(-0.35, 0.25)))
    rows, columns = (
        np.minimum(
            np.arange(int(size / spacing)) * spacing + random.integers(STRIDE), size - 1
        ).astype(int)
        for size in depth.shape
    )
    cells = np.ix_(rows, columns)
    fx, fy = grids.focal_lengths[index]
    return _View(
        depth[cells].astype(np.float32) / np.float32(1000.0),
        grids.parts[index][cells],
        grids.bodies[index][cells],
        float(np.sqrt(fx * fy)) / spacing,
    )


def _mirrored(view: _View) -> _View:
    return _View(
        view.depth[:, ::-1],
        OTHER_SIDES[view.parts[:, ::-1]],
        view.bodies[:, ::-1],
        view.focal_length,
    )


def _disturbed(depth: NDArray[np.float32], random: np.random.Generator) -> NDArray[np.float32]:
    """Return depth with an error of the scale, holes, noise and missing cells, each sometimes."""
    depth = depth.copy()
    if random.random() < 0.15:
        depth *= np.float32(random.uniform(0.94, 1.06))
    if random.random() < 0.3:
        for _ in range(random.integers(1, 4)):
            row, column = random.integers(depth.shape[0]), random.integers(depth.shape[1])
            height, width = random.integers(2, 14, 2)
            depth[row : row + height, column : column + width] = 0
    if random.random() < 0.25:
        noise = random.normal(0, random.uniform(0, 0.01), depth.shape)
        depth *= (1 + noise).astype(np.float32)
    if random.random() < 0.15:
        depth[random.random(depth.shape) < random.uniform(0, 0.3)] = 0
    return depth


def _weights(depth: NDArray[np.float32], bodies: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Return how much each cell counts: those of small people more than those of large ones."""
    known = depth > 0
    near = known & (depth <= FARTHEST + _BEYOND)
    weights = np.where(near, np.where(bodies > 0, np.float32(1), _NOBODY), np.float32(0))
    for body in np.unique(bodies[known & (bodies > 0)]):
        cells = known & (bodies == body)
        weights[cells] *= np.clip(np.sqrt(_TYPICAL_CELLS / cells.sum()), 0.6, 3.0)
    return weights


def ways_to_middles(
    depth: NDArray[np.float32], bodies: NDArray[np.uint8], focal_length: float
) -> NDArray[np.float32]:
    """Return the way from each cell to the middle of its person, metres, shape (3, h, w).

    The middle has the mean row, column and depth of the person's visible cells. The way across
    and down the image is at the depth of the cell.

    Args:
        depth: metres, 0 if unknown, shape (h, w).
        bodies: the body number of each cell, 0 for none, shape (h, w).
        focal_length: in cells.
    """
    ways = np.zeros((3, *depth.shape), np.float32)
    for body in np.unique(bodies[bodies > 0]):
        cells = (depth > 0) & (bodies == body)
        if not cells.any():
            continue
        rows, columns = np.nonzero(cells)
        z = depth[cells]
        ways[0][cells] = (columns.mean() - columns) * z / focal_length
        ways[1][cells] = (rows.mean() - rows) * z / focal_length
        ways[2][cells] = z.mean() - z
    return ways


_Span = tuple[slice, slice]


def _framed(planes: NDArray[Any], lines: tuple[_Span, _Span]) -> NDArray[Any]:
    """Return planes of HEIGHT x WIDTH cells: cut out, or filled with 0.

    Args:
        planes: shape (..., h, w).
        lines: which rows are taken and which ones they become; the same of columns.
    """
    (rows, to_rows), (columns, to_columns) = lines
    framed = np.zeros((*planes.shape[:-2], HEIGHT, WIDTH), planes.dtype)
    framed[..., to_rows, to_columns] = planes[..., rows, columns]
    return framed


def _span(size: int, wanted: int, random: np.random.Generator) -> _Span:
    """Return which of `size` lines are taken, and which of `wanted` lines they become."""
    if size <= wanted:
        first = int(random.integers(wanted - size + 1))
        return slice(0, size), slice(first, first + size)
    first = int(random.integers(size - wanted + 1))
    return slice(first, first + wanted), slice(0, wanted)
