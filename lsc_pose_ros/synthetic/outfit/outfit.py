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

"""An outfit: surfaces that people wear, which follow their bones like skin."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.body.body_file import BodyModel
from lsc_pose_ros.synthetic.body.body_mesh import PosedBody, RestBody, blend_skin
from lsc_pose_ros.synthetic.scene.shapes import Mesh

_FULL = 65535


class Outfit(NamedTuple):
    """Surfaces in the rest pose: x to the person's left, y up, z forward.

    Attributes:
        vertices: metres, shape (V, 3).
        triangles: numbers of vertices, shape (T, 3), uint16.
        bones: the bones that each vertex follows, shape (V, 4), uint8.
        weights: their weights in units of 1/65535, descending, shape (V, 4), uint16.
        parts: the body part of each triangle, shape (T,).
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.uint16]
    bones: NDArray[np.uint8]
    weights: NDArray[np.uint16]
    parts: NDArray[np.int32]

    def posed(self, rest: RestBody, body: PosedBody) -> NDArray[np.float64]:
        """Return the vertices on a posed body, in its frame, metres, shape (V, 3)."""
        shifts = body.heads - np.einsum('bij,bj->bi', body.orientations, rest.heads)
        return blend_skin(self.vertices, self.bones, self.weights, body.orientations, shifts)


class Garment(NamedTuple):
    """One surface of an outfit.

    Attributes:
        mesh: the surface in the rest pose.
        weights: of the bones by name, shape (V,) each; they add up to 1.
        joints: numbers of the joints that its triangles can belong to.
        behind: whether it is in the way of a seat.
    """

    mesh: Mesh
    weights: dict[str, NDArray[np.float64]]
    joints: tuple[int, ...]
    behind: bool = False


def rigid(mesh: Mesh, bone: str, joints: tuple[int, ...]) -> Garment:
    """Return a garment that moves with one bone."""
    return Garment(mesh, {bone: np.ones(len(mesh.vertices))}, joints)


def outfit_of(body: BodyModel, rest: RestBody, garments: Sequence[Garment]) -> Outfit:
    """Return the outfit of all `garments`; a triangle belongs to the nearest joint."""
    numbers = {str(name): number for number, name in enumerate(body.bones)}
    first, parts, bones, weights = 0, [], [], []
    vertices, triangles = [np.zeros((0, 3))], [np.zeros((0, 3), np.int64)]
    for garment in garments:
        mesh = garment.mesh
        vertices.append(mesh.vertices)
        triangles.append(mesh.triangles + first)
        first += len(mesh.vertices)
        middles = mesh.vertices[mesh.triangles].mean(axis=1)
        own = np.array(garment.joints)
        distances = ((middles[:, None] - rest.joints[own]) ** 2).sum(axis=2)
        parts.append(1 + own[distances.argmin(axis=1)])
        table = np.zeros((len(mesh.vertices), 4))
        table[:, : len(garment.weights)] = np.stack(list(garment.weights.values()), axis=1)
        names = np.zeros(4, np.int64)
        names[: len(garment.weights)] = [numbers[name] for name in garment.weights]
        order = np.argsort(-table, axis=1, kind='stable')
        weights.append(np.take_along_axis(table, order, axis=1))
        bones.append(names[order])
    return Outfit(
        np.concatenate(vertices),
        np.concatenate(triangles).astype(np.uint16),
        np.concatenate([np.zeros((0, 4)), *bones]).astype(np.uint8),
        np.rint(_FULL * np.concatenate([np.zeros((0, 4)), *weights])).astype(np.uint16),
        np.concatenate([np.zeros(0), *parts]).astype(np.int32),
    )
