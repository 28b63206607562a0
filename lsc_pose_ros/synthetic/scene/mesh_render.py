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

"""Renders meshes to a depth image and labels with a z-buffer.

A pixel shows the nearest triangle that contains its centre. Corners are rounded to 1/256 pixel,
which makes the test exact in integers: there are no gaps between adjacent triangles, and all
machines render the same pixels.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.numerics.jit import exact_kernel
from lsc_pose_ros.synthetic.scene.depth_image import DepthImage

SUBPIXELS = 256
"""Corners are rounded to this fraction of a pixel."""

NEAREST = 0.05
"""Triangles with a corner nearer to the camera's plane are not drawn, metres."""

_MAX_PIXEL = 1 << 20
"""Triangles with a corner farther outside are not drawn, because products would overflow."""


class RenderMesh(NamedTuple):
    """A surface in front of the camera.

    Attributes:
        vertices: in the optical frame, metres, shape (V, 3).
        triangles: numbers of vertices, shape (T, 3); both sides are visible.
        labels: one per triangle, shape (T,), or the same number for all of them.
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.uint16]
    labels: NDArray[np.int32] | int


def render_meshes(
    meshes: Sequence[RenderMesh], camera: Intrinsics, width: int, height: int
) -> DepthImage:
    """Render `meshes`; the nearest surface hides those behind it.

    Args:
        meshes: the surfaces.
        camera: the intrinsics.
        width: of the image, pixels.
        height: of the image, pixels.

    Returns:
        Depth, 0 in empty pixels, and labels.
    """
    depth = np.full((height, width), np.inf, np.float32)
    labels = np.full((height, width), NO_BODY, np.int32)
    for mesh in meshes:
        corners = project_corners(mesh.vertices, camera)
        own = np.full(len(mesh.triangles), mesh.labels, np.int32)
        draw_triangles(mesh.triangles, corners, mesh.vertices, own, DepthImage(depth, labels))
    depth[np.isinf(depth)] = 0.0
    return DepthImage(depth, labels)


@exact_kernel
def draw_over(image: DepthImage, other: DepthImage) -> None:
    """Draw `other` into `image` where it is nearer; a depth of 0 is empty in both."""
    depth, labels = image
    other_depth, other_labels = other
    height, width = depth.shape
    for row in range(height):
        for column in range(width):
            z = other_depth[row, column]
            if z > 0.0 and (depth[row, column] == 0.0 or z < depth[row, column]):
                depth[row, column] = z
                labels[row, column] = other_labels[row, column]


@exact_kernel
def project_corners(vertices: NDArray[np.float64], camera: Intrinsics) -> NDArray[np.int64]:
    """Return columns and rows in 1/SUBPIXELS, and 1 if the vertex can be drawn, shape (V, 3)."""
    corners = np.zeros((len(vertices), 3), np.int64)
    for vertex in range(len(vertices)):
        z = vertices[vertex, 2]
        if not z >= NEAREST:
            continue
        column = camera.cx + camera.fx * vertices[vertex, 0] / z
        row = camera.cy + camera.fy * vertices[vertex, 1] / z
        if abs(column) < _MAX_PIXEL and abs(row) < _MAX_PIXEL:
            corners[vertex, 0] = int(np.floor(column * SUBPIXELS + 0.5))
            corners[vertex, 1] = int(np.floor(row * SUBPIXELS + 0.5))
            corners[vertex, 2] = 1
    return corners


@exact_kernel
def draw_triangles(
    triangles: NDArray[np.uint16],
    corners: NDArray[np.int64],
    vertices: NDArray[np.float64],
    labels: NDArray[np.int32],
    image: DepthImage,
) -> None:
    """Draw triangles into `image`, whose depth is infinite in empty pixels."""
    for triangle in range(len(triangles)):
        a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
        if corners[a, 2] + corners[b, 2] + corners[c, 2] < 3:
            continue
        ax, ay, bx, by = corners[a, 0], corners[a, 1], corners[b, 0], corners[b, 1]
        cx, cy = corners[c, 0], corners[c, 1]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area > 0:
            depths = (vertices[a, 2], vertices[b, 2], vertices[c, 2])
            draw_triangle((ax, ay, bx, by, cx, cy), depths, area, labels[triangle], image)
        elif area < 0:  # seen from behind
            depths = (vertices[a, 2], vertices[c, 2], vertices[b, 2])
            draw_triangle((ax, ay, cx, cy, bx, by), depths, -area, labels[triangle], image)


@exact_kernel
def draw_triangle(
    corners: tuple[int, int, int, int, int, int],
    depths: tuple[float, float, float],
    area: int,
    label: int,
    image: DepthImage,
) -> None:
    """Draw one triangle into `image`.

    On a plane, 1/z is linear in the image: 1/z = sum_i w_i / z_i with the barycentric weights w.

    Args:
        corners: columns and rows of the corners in 1/SUBPIXELS.
        depths: z of the corners, metres.
        area: twice the triangle's area, which is positive.
        label: the label.
        image: the image.
    """
    ax, ay, bx, by, cx, cy = corners
    depth, labels = image
    height, width = depth.shape
    # Most triangles are small and contain no centre of a pixel.
    left = max(-(-min(ax, bx, cx) // SUBPIXELS), 0)
    right = min(max(ax, bx, cx) // SUBPIXELS, width - 1)
    top = max(-(-min(ay, by, cy) // SUBPIXELS), 0)
    bottom = min(max(ay, by, cy) // SUBPIXELS, height - 1)
    if left > right or top > bottom:
        return
    inverses = (1.0 / (area * depths[0]), 1.0 / (area * depths[1]), 1.0 / (area * depths[2]))
    steps = (SUBPIXELS * (by - cy), SUBPIXELS * (cy - ay), SUBPIXELS * (ay - by))
    x = left * SUBPIXELS
    for row in range(top, bottom + 1):
        y = row * SUBPIXELS
        areas = (
            (cx - bx) * (y - by) - (cy - by) * (x - bx),
            (ax - cx) * (y - cy) - (ay - cy) * (x - cx),
            (bx - ax) * (y - ay) - (by - ay) * (x - ax),
        )
        span = (depth[row, left : right + 1], labels[row, left : right + 1])
        draw_row(areas, steps, inverses, label, span)


@exact_kernel
def draw_row(
    areas: tuple[int, int, int],
    steps: tuple[int, int, int],
    inverses: tuple[float, float, float],
    label: int,
    span: tuple[NDArray[np.float32], NDArray[np.int32]],
) -> None:
    """Draw one row of a triangle.

    Args:
        areas: twice the areas opposite to the corners, at the first pixel.
        steps: how they change from one pixel to the next.
        inverses: 1/z of the corners by twice the triangle's area.
        label: the label.
        span: depth and labels of the row.
    """
    depth, labels = span
    of_a, of_b, of_c = areas
    entered = False
    for column in range(len(depth)):
        if of_a >= 0 and of_b >= 0 and of_c >= 0:
            entered = True
            z = np.float32(1.0 / (of_a * inverses[0] + of_b * inverses[1] + of_c * inverses[2]))
            if z < depth[column]:
                depth[column] = z
                labels[column] = label
        elif entered:  # the triangle is convex
            return
        of_a += steps[0]
        of_b += steps[1]
        of_c += steps[2]
