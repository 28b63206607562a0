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

"""Meshes of simple shapes: boxes, bars, bodies with elliptic sections, sheets and leaves.

A shape's frame is that of furniture: x to its left, y up, z to its front.
"""

import math
from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray


class Mesh(NamedTuple):
    """A surface of triangles.

    Attributes:
        vertices: metres, shape (V, 3).
        triangles: numbers of vertices, shape (T, 3).
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]


class Blocks(NamedTuple):
    """K boxes that contain a shape; people must not intersect them.

    Attributes:
        centres: metres, shape (K, 3).
        axes: the directions of the boxes' own axes, in columns, shape (K, 3, 3).
        halves: half sizes along these axes, metres, shape (K, 3).
    """

    centres: NDArray[np.float64]
    axes: NDArray[np.float64]
    halves: NDArray[np.float64]


_SIGNS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
_SIDES = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4),
                   (1, 5, 7, 3)])  # fmt: skip
_BOX_TRIANGLES = np.concatenate([_SIDES[:, [0, 1, 2]], _SIDES[:, [0, 2, 3]]])


def join(meshes: Sequence[Mesh]) -> Mesh:
    """Return one mesh of all `meshes`."""
    if not meshes:
        return Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64))
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate(
            [mesh.triangles + start for mesh, start in zip(meshes, first, strict=False)]
        ),
    )


def box_mesh(blocks: Blocks) -> Mesh:
    """Return the surface of all `blocks`."""
    corners = (_SIGNS * blocks.halves[:, None]) @ blocks.axes.transpose(0, 2, 1)
    vertices = (corners + blocks.centres[:, None]).reshape(-1, 3)
    starts = 8 * np.arange(len(blocks.centres))
    return Mesh(vertices, (_BOX_TRIANGLES + starts[:, None, None]).reshape(-1, 3))


def bar_axes(start: NDArray[np.float64], end: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the axes, in columns, of a bar whose y axis points from `start` to `end`, (3, 3)."""
    x, y, z = (end - start).tolist()
    length = math.sqrt(x * x + y * y + z * z)
    x, y, z = x / length, y / length, z / length
    if abs(z) < 0.9:  # across is the direction of (x, y, z) x (0, 0, 1)
        across = math.sqrt(x * x + y * y)
        ax, ay, az = y / across, -x / across, 0.0
    else:  # (x, y, z) x (1, 0, 0)
        across = math.sqrt(y * y + z * z)
        ax, ay, az = 0.0, z / across, -y / across
    third = (ay * z - az * y, az * x - ax * z, ax * y - ay * x)
    return np.array([[ax, x, third[0]], [ay, y, third[1]], [az, z, third[2]]])


def loft(
    heights: ArrayLike,
    widths: ArrayLike,
    depths: ArrayLike,
    *,
    exponent: float = 1.0,
    sides: int = 12,
    shift: ArrayLike = 0.0,
) -> Mesh:
    """Return a closed body with horizontal sections (superellipses).

    Args:
        heights: of the R sections, metres, shape (R,).
        widths: half widths of the sections, metres, shape (R,).
        depths: half depths of the sections, metres, shape (R,).
        exponent: 1 gives ellipses; smaller values give rounded rectangles.
        sides: number of corners of each section.
        shift: displacement of the sections to the front, metres, a number or shape (R,).
    """
    heights = np.asarray(heights, np.float64)
    unit = _section(sides, exponent)
    vertices = np.empty((len(heights), sides, 3))
    vertices[..., 0] = np.multiply.outer(np.asarray(widths, np.float64), unit[0])
    vertices[..., 1] = heights[:, None]
    vertices[..., 2] = np.multiply.outer(np.asarray(depths, np.float64), unit[1])
    vertices[..., 2] += np.broadcast_to(np.asarray(shift, np.float64), heights.shape)[:, None]
    ends = vertices[[0, -1]].mean(axis=1)
    return Mesh(
        np.concatenate([vertices.reshape(-1, 3), ends]), _loft_triangles(len(heights), sides)
    )


def rounded(half: ArrayLike, exponent: float) -> Mesh:
    """Return a rounded body around the origin with the given half sizes, shape (3,).

    An exponent of 1 gives an ellipsoid; smaller values give a cushion or a rounded box.
    """
    width, height, depth = np.asarray(half, np.float64)
    heights, radii = _profile(exponent)
    return loft(height * heights, width * radii, depth * radii, exponent=exponent)


def sheet(depths: NDArray[np.float64], width: float, height: float) -> Mesh:
    """Return a hanging sheet from y = 0 up to `height`, `width` wide.

    Args:
        depths: z of the points of a grid, from bottom to top, metres, shape (R, C).
        width: metres.
        height: metres.
    """
    rows, columns = depths.shape
    vertices = np.empty((rows, columns, 3))
    vertices[..., 0] = width * (np.arange(columns) / (columns - 1) - 0.5)
    vertices[..., 1] = height * (np.arange(rows) / (rows - 1))[:, None]
    vertices[..., 2] = depths
    return Mesh(vertices.reshape(-1, 3), _grid_triangles(rows, columns))


def leaves(centres: NDArray[np.float64], size: float) -> Mesh:
    """Return triangular leaves of a length of `size` around `centres`, shape (N, 3)."""
    turns = scattered(3 * len(centres)).reshape(-1, 3, 3)
    vertices = (centres[:, None] + size * turns).reshape(-1, 3)
    return Mesh(vertices, np.arange(len(vertices)).reshape(-1, 3))


def scattered(count: int) -> NDArray[np.float64]:
    """Return points that are evenly scattered in the cube from -0.5 to 0.5, shape (count, 3).

    They are the additive recurrence of Roberts (2018) with the plastic number of three dimensions.
    """
    steps = np.array([0.8191725133961645, 0.6710436067037893, 0.5497004779019703])
    points: NDArray[np.float64] = (0.5 + np.arange(1, count + 1)[:, None] * steps) % 1.0 - 0.5
    return points


@cache
def _section(sides: int, exponent: float) -> NDArray[np.float64]:
    angles = 2 * np.pi * np.arange(sides) / sides
    circle = np.stack([np.cos(angles), np.sin(angles)])
    section: NDArray[np.float64] = np.sign(circle) * np.abs(circle) ** exponent
    return section


@cache
def _profile(exponent: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    angles = np.pi * (np.arange(7) / 6 - 0.5)
    sine, cosine = np.sin(angles), np.abs(np.cos(angles))
    return np.sign(sine) * np.abs(sine) ** exponent, cosine**exponent


@cache
def _loft_triangles(rings: int, sides: int) -> NDArray[np.int64]:
    side = np.arange(sides)
    following = (side + 1) % sides
    walls = [
        np.stack([start + side, start + following, start + sides + following], axis=1)
        for start in range(0, (rings - 1) * sides, sides)
    ] + [
        np.stack([start + side, start + sides + following, start + sides + side], axis=1)
        for start in range(0, (rings - 1) * sides, sides)
    ]
    last = (rings - 1) * sides
    bottom = np.stack([np.full(sides, rings * sides), following, side], axis=1)
    top = np.stack([np.full(sides, rings * sides + 1), last + side, last + following], axis=1)
    return np.concatenate([*walls, bottom, top])


@cache
def _grid_triangles(rows: int, columns: int) -> NDArray[np.int64]:
    first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    quads = np.stack([first, first + 1, first + columns + 1, first + columns], axis=1)
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
