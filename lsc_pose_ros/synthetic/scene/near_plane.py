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

"""Cuts meshes at the plane before the camera at which rendering begins."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.synthetic.scene.mesh_render import NEAREST
from lsc_pose_ros.synthetic.scene.shapes import Mesh

_PLANE = 1.01 * NEAREST


def cut_at_near_plane(mesh: Mesh) -> Mesh:
    """Return the part of a mesh, in the camera's frame, that is in front of the camera.

    Triangles that cross the plane are replaced by one or two triangles.
    """
    before = mesh.vertices[:, 2] >= _PLANE
    count = before[mesh.triangles].sum(axis=1)
    kept = mesh.triangles[count == 3]
    crossing = mesh.triangles[(count == 1) | (count == 2)]
    if not len(crossing):
        return Mesh(mesh.vertices, kept)
    vertices, triangles = [mesh.vertices], [kept]
    first = len(mesh.vertices)
    for triangle in crossing:
        polygon = _cut_polygon(mesh.vertices[triangle])
        vertices.append(polygon)
        triangles += [np.array([[first, first + k, first + k + 1]]) for k in (1, 2)]
        triangles[-1] = triangles[-1][: len(polygon) - 3]
        first += len(polygon)
    return Mesh(np.concatenate(vertices), np.concatenate(triangles))


def _cut_polygon(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the corners of a triangle's part in front of the plane, shape (3 or 4, 3)."""
    points = []
    for number, corner in enumerate(corners):
        after = corners[(number + 1) % 3]
        if corner[2] >= _PLANE:
            points.append(corner)
        if (corner[2] >= _PLANE) != (after[2] >= _PLANE):
            fraction = (_PLANE - corner[2]) / (after[2] - corner[2])
            points.append(corner + fraction * (after - corner))
    return np.array(points)
