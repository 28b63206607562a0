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

"""The trees of directions, and the walks that they lead."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.depth_comparisons import depth_at
from lsc_pose_experiments.walks.body_grid import BodyGrid
from lsc_pose_experiments.walks.walk_order import CENTRE, WalkOrder
from lsc_pose_ros.numerics.jit import kernel

NEAREST = np.float32(0.1)
"""No point of a walk is nearer to the camera, metres."""


class DirectionTrees(NamedTuple):
    """One tree for each of J joints, all nodes in one table.

    Attributes:
        roots: the first node of each tree, shape (J,), int32.
        splits: u right, u down, v right, v down in metres, and the threshold in metres,
            shape (n, 5), float32. A point with f below the threshold goes left.
        left: the left child of each node; the right child follows it. A leaf has -1 - its row in
            `directions`. Shape (n,), int32.
        directions: K unit vectors at each leaf, shape (L, K, 3), float32.
        cumulative: the sum of the probabilities of a direction and those before it,
            shape (L, K), float32.
    """

    roots: NDArray[np.int32]
    splits: NDArray[np.float32]
    left: NDArray[np.int32]
    directions: NDArray[np.float32]
    cumulative: NDArray[np.float32]


class WalkSettings(NamedTuple):
    """How the walks go.

    Attributes:
        steps: number of steps to each joint.
        step: length of a step, metres.
        skipped: number of first steps that do not count for the mean.
    """

    steps: int = 64
    step: float = 0.05
    skipped: int = 16


@kernel
def walk_body(
    grid: BodyGrid,
    centre: NDArray[np.float32],
    trees: DirectionTrees,
    order: WalkOrder,
    draws: NDArray[np.float32],
    settings: WalkSettings,
) -> NDArray[np.float32]:
    """Return position, metres, and confidence of each joint, shape (J, 4).

    A joint is the mean of the steps of the walk to it. The confidence is 1 - |e - b| / (n s) for
    a walk of n steps of length s from b to e: 1 if it stays around a point, 0 if it goes straight
    on.

    Args:
        grid: the body.
        centre: of the body, metres, shape (3,).
        trees: of the J joints.
        order: of the walks.
        draws: random numbers from 0 to 1, which choose the directions, shape (J, steps).
        settings: of the walks.
    """
    found = np.zeros((order.joint.shape[0], 4), np.float32)
    for n in range(order.joint.shape[0]):
        joint, start = order.joint[n], order.start[n]
        point = centre.copy()
        if start != CENTRE:
            point[:] = found[start, :3]
        walk_to_joint(grid, point, trees, joint, draws[joint], settings, found[joint])
    return found


@kernel
def walk_to_joint(
    grid: BodyGrid,
    point: NDArray[np.float32],
    trees: DirectionTrees,
    joint: int,
    draws: NDArray[np.float32],
    settings: WalkSettings,
    found: NDArray[np.float32],
) -> None:
    """Walk from a point towards a joint; write position and confidence into `found`.

    Args:
        grid: the body.
        point: where the walk starts; moved to its end, shape (3,).
        trees: of all joints.
        joint: the index of the joint.
        draws: the random numbers of the steps, shape (steps,).
        settings: of the walks.
        found: shape (4,); 0 before.
    """
    counted = settings.steps - settings.skipped
    first = point.copy()
    for s in range(settings.steps):
        leaf = find_leaf(grid, point, trees, joint)
        k = 0
        while k + 1 < trees.cumulative.shape[1] and draws[s] >= trees.cumulative[leaf, k]:
            k += 1
        for axis in range(3):
            point[axis] += np.float32(settings.step) * trees.directions[leaf, k, axis]
        point[2] = max(point[2], NEAREST)
        if s + 1 == settings.skipped:
            first[:] = point
        if s >= settings.skipped:
            for axis in range(3):
                found[axis] += point[axis] / np.float32(counted)
    straight = np.sqrt(np.sum((point - first) ** 2)) / np.float32(counted * settings.step)
    found[3] = max(np.float32(0), np.float32(1) - straight)


@kernel
def find_leaf(
    grid: BodyGrid, point: NDArray[np.float32], trees: DirectionTrees, joint: int
) -> int:
    """Return the leaf that a point reaches in the tree of a joint: a row of `directions`.

    The point need not be on the surface: its own depth scales the offsets, and takes the place of
    the second depth if the second offset is 0.
    """
    depth, camera, splits = grid.depth, grid.camera, trees.splits
    z = point[2]
    across, down = np.float32(camera.fx) / z, np.float32(camera.fy) / z
    row = point[1] * down + np.float32(camera.cy)
    column = point[0] * across + np.float32(camera.cx)
    node = trees.roots[joint]
    left: int = trees.left[node]
    while left >= 0:
        value = depth_at(depth, row + splits[node, 1] * down, column + splits[node, 0] * across)
        if splits[node, 2] == 0 and splits[node, 3] == 0:
            value -= z
        else:
            value -= depth_at(
                depth, row + splits[node, 3] * down, column + splits[node, 2] * across
            )
        node = left + (value >= splits[node, 4])
        left = trees.left[node]
    return -1 - left
