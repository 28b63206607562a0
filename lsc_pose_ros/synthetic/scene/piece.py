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

"""A piece of furniture: its surface, and the boxes that people must not intersect."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lsc_pose_ros.synthetic.scene.shapes import (
    Blocks,
    Mesh,
    bar_axes,
    box_mesh,
    join,
    loft,
    rounded,
)

_UPRIGHT = np.eye(3)


class Piece(NamedTuple):
    """A piece of furniture, in its own frame or placed in the level frame.

    Its own frame is x to its left, y up, z to its front; the origin is on the floor.

    Attributes:
        mesh: the surface.
        blocks: boxes that contain the surface.
    """

    mesh: Mesh
    blocks: Blocks

    def placed(self, position: NDArray[np.float64], front: NDArray[np.float64]) -> 'Piece':
        """Return the piece in the level frame: x right, y down, z away.

        Args:
            position: of the piece's origin, metres, shape (3,).
            front: horizontal direction of its front (x, z), length 1.
        """
        axes = front_axes(front)
        blocks = self.blocks
        return Piece(
            Mesh(self.mesh.vertices @ axes.T + position, self.mesh.triangles),
            Blocks(blocks.centres @ axes.T + position, axes @ blocks.axes, blocks.halves),
        )

    def moved(self, offset: NDArray[np.float64]) -> 'Piece':
        """Return the piece displaced by `offset`, metres, shape (3,)."""
        return Piece(
            self.mesh._replace(vertices=self.mesh.vertices + offset),
            self.blocks._replace(centres=self.blocks.centres + offset),
        )

    def size(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the lowest and the highest coordinates of the surface, metres, shape (3,)."""
        return self.mesh.vertices.min(axis=0), self.mesh.vertices.max(axis=0)


def front_axes(front: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the axes (left, up, front), in columns, of a piece with this front (x, z)."""
    x, z = front
    return np.array([[-z, 0.0, x], [0.0, -1.0, 0.0], [x, 0.0, z]])


class PieceBuilder:
    """Collects the shapes of a piece."""

    def __init__(self) -> None:
        """Start without shapes."""
        self._boxes: list[tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]]
        self._boxes = []
        self._hulls: list[tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]]
        self._hulls = []
        self._meshes: list[Mesh] = []

    def box(
        self,
        centre: ArrayLike,
        size: ArrayLike,
        axes: NDArray[np.float64] = _UPRIGHT,
    ) -> None:
        """Add a box; `size` is its width, height and depth, metres."""
        self._boxes.append(
            (np.asarray(centre, np.float64), axes, 0.5 * np.asarray(size, np.float64))
        )

    def bar(self, start: ArrayLike, end: ArrayLike, width: float, depth: float = 0.0) -> None:
        """Add a bar between two points with a rectangular section, metres."""
        first, last = np.asarray(start, np.float64), np.asarray(end, np.float64)
        length = float(np.sqrt(((last - first) ** 2).sum()))
        self.box(0.5 * (first + last), (width, length, depth or width), bar_axes(first, last))

    def post(
        self, base: ArrayLike, height: float, radius: float, top: float | None = None
    ) -> None:
        """Add an upright cylinder or, if the radius at the top differs, a cone."""
        radii = (radius, radius if top is None else top)
        self.shape(loft((0.0, height), radii, radii, sides=10), base)

    def cushion(self, centre: ArrayLike, size: ArrayLike, exponent: float = 0.45) -> None:
        """Add a rounded body; `size` is its width, height and depth, metres."""
        self.shape(rounded(0.5 * np.asarray(size, np.float64), exponent), centre)

    def shape(self, mesh: Mesh, position: ArrayLike, axes: NDArray[np.float64] = _UPRIGHT) -> None:
        """Add any shape, turned by `axes` and displaced to `position`."""
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        origin = np.asarray(position, np.float64)
        self._meshes.append(Mesh(mesh.vertices @ axes.T + origin, mesh.triangles))
        self._hulls.append((axes @ (0.5 * (low + high)) + origin, axes, 0.5 * (high - low)))

    def add(self, piece: Piece, position: ArrayLike) -> None:
        """Add another piece, with the same front, at a position."""
        moved = piece.moved(np.asarray(position, np.float64))
        self._meshes.append(moved.mesh)
        self._hulls += list(zip(*moved.blocks, strict=True))

    def build(self) -> Piece:
        """Return the piece of all shapes."""
        meshes = list(self._meshes)
        if self._boxes:
            meshes.append(box_mesh(_blocks(self._boxes)))
        return Piece(join(meshes), _blocks(self._boxes + self._hulls))


def _blocks(
    boxes: list[tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]],
) -> Blocks:
    centres, axes, halves = zip(*boxes, strict=True)
    return Blocks(np.array(centres), np.array(axes), np.array(halves))
