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

"""Samples for the trees of directions: points around a joint, and the directions to it."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.depth_comparisons import Cells
from lsc_pose_experiments.walks.body_grid import BodyGrid, GridCamera, body_grid, pinhole_images
from lsc_pose_experiments.walks.walk_trees import NEAREST
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.image_arguments import ImageArguments
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.training.samples import select_joints

_MILLIMETRES = 1000.0


class LabelledBody(NamedTuple):
    """A body and its joints.

    Attributes:
        grid: the body.
        joints: metres, NaN if not labelled, shape (J, 3).
    """

    grid: BodyGrid
    joints: NDArray[np.float32]


class BodyGrids(NamedTuple):
    """I grids, stored one after the other, row by row.

    Attributes:
        depth: of all cells, millimetres, 0 beside the body, shape (cells,), uint16.
        start: index of each grid's first cell in `depth`, shape (I,).
        shape: rows and columns of each grid, shape (I, 2).
        camera: fx, fy, cx and cy of each grid, shape (I, 4).
    """

    depth: NDArray[np.uint16]
    start: NDArray[np.int64]
    shape: NDArray[np.int64]
    camera: NDArray[np.float32]


class DirectionSamples(NamedTuple):
    """S points around one joint.

    Attributes:
        grid: the index of the body of each point, shape (S,).
        point: metres, shape (S, 3).
        direction: the unit vector from it to the joint, shape (S, 3).
    """

    grid: NDArray[np.int32]
    point: NDArray[np.float32]
    direction: NDArray[np.float32]


def labelled_bodies(frame: Frame, joints: NDArray[np.uint16]) -> Iterator[LabelledBody]:
    """Yield the labelled bodies of `frame` that are visible."""
    if frame.ground_truth is None:
        return
    images = pinhole_images(ImageArguments(frame.depth, frame.labels, frame.camera))
    positions = select_joints(frame.ground_truth, joints)
    for row, body in enumerate(frame.ground_truth.bodies.tolist()):
        grid = body_grid(images, body)
        if grid is not None and not np.isnan(positions[row]).all():
            yield LabelledBody(grid, positions[row])


def join_grids(grids: Iterable[BodyGrid]) -> BodyGrids:
    """Return the grids in one table; depths are rounded to millimetres."""
    depths: list[NDArray[np.uint16]] = []
    shapes: list[tuple[int, ...]] = []
    cameras: list[GridCamera] = []
    for grid in grids:
        depths.append(np.rint(grid.depth * _MILLIMETRES).astype(np.uint16).ravel())
        shapes.append(grid.depth.shape)
        cameras.append(grid.camera)
    sizes = np.array([len(depth) for depth in depths], np.int64)
    return BodyGrids(
        np.concatenate(depths),
        np.cumsum(sizes) - sizes,
        np.array(shapes, np.int64),
        np.array(cameras, np.float32),
    )


def draw_samples(
    joints: NDArray[np.float32], points: int, reach: float, rng: np.random.Generator
) -> DirectionSamples:
    """Return random points around a joint, as many near it as far from it.

    Args:
        joints: the joint of each body, metres, NaN if not labelled, shape (I, 3).
        points: number of points for each body.
        reach: the largest distance of a point from the joint, metres.
        rng: draws directions and distances, both uniformly.
    """
    labelled = np.flatnonzero(np.isfinite(joints).all(axis=1))
    grid = np.repeat(labelled, points).astype(np.int32)
    normal = rng.standard_normal((len(grid), 3), np.float32)
    direction = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    distance = np.float32(reach) * rng.random((len(grid), 1), np.float32)
    point = joints[grid] - distance * direction
    kept = point[:, 2] > NEAREST
    return DirectionSamples(grid[kept], point[kept], direction[kept])


@kernel
def cells_of(grids: BodyGrids, samples: DirectionSamples, members: NDArray[np.int64]) -> Cells:
    """Return the cells of some samples, where their depths are compared."""
    n = members.shape[0]
    first, rows, columns = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n, np.int64)
    row, column, z = np.empty(n, np.float32), np.empty(n, np.float32), np.empty(n, np.float32)
    across, down = np.empty_like(z), np.empty_like(z)
    for k in range(n):
        grid, point = samples.grid[members[k]], samples.point[members[k]]
        camera = grids.camera[grid]
        first[k], rows[k], columns[k] = (
            grids.start[grid],
            grids.shape[grid, 0],
            grids.shape[grid, 1],
        )
        z[k] = point[2]
        across[k], down[k] = camera[0] / z[k], camera[1] / z[k]
        row[k] = point[1] * down[k] + camera[3]
        column[k] = point[0] * across[k] + camera[2]
    return Cells(first, rows, columns, row, column, across, down, z)
