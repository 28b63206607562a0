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

"""Random Tree Walks in plain numpy, written from its description."""

import numpy as np
from lsc_pose_experiments.depth_comparisons import BEYOND
from lsc_pose_experiments.walks.body_grid import BodyGrid, GridCamera
from lsc_pose_experiments.walks.walk_trees import DirectionTrees, WalkSettings


def comparison_of_point(
    depth: np.ndarray, camera: GridCamera, point: np.ndarray, split: np.ndarray
) -> float:
    """d(p + u) - d(p + v): depths at the projections of a point, moved parallel to the image."""

    def probe(right: float, down: float) -> float:
        x, y, z = np.add(point, (right, down, 0))
        row = int(np.floor(camera.fy * y / z + camera.cy))
        column = int(np.floor(camera.fx * x / z + camera.cx))
        inside = 0 <= row < depth.shape[0] and 0 <= column < depth.shape[1]
        return float(depth[row, column]) if inside and depth[row, column] > 0 else float(BEYOND)

    return probe(*split[:2]) - (probe(*split[2:4]) if split[2:4].any() else point[2])


def leaf_of_point(grid: BodyGrid, point: np.ndarray, trees: DirectionTrees, joint: int) -> int:
    """The leaf that a point reaches."""
    node = trees.roots[joint]
    while trees.left[node] >= 0:
        split = trees.splits[node]
        value = comparison_of_point(grid.depth, grid.camera, point, split)
        node = trees.left[node] + int(value >= split[4])
    return int(-1 - trees.left[node])


def walk(
    grid: BodyGrid,
    start: np.ndarray,
    trees: DirectionTrees,
    joint: int,
    draws: np.ndarray,
    settings: WalkSettings,
) -> np.ndarray:
    """All positions of a walk, with its start, shape (steps + 1, 3)."""
    path = [np.array(start, float)]
    for draw in draws:
        leaf = leaf_of_point(grid, path[-1], trees, joint)
        k = np.searchsorted(trees.cumulative[leaf][:-1], draw, side='right')
        path.append(path[-1] + settings.step * trees.directions[leaf, k])
    return np.array(path)


def position_and_confidence(path: np.ndarray, settings: WalkSettings) -> np.ndarray:
    """The mean of the counted steps, and one minus their straightness, shape (4,)."""
    counted = path[settings.skipped + 1 :]
    length = settings.step * len(counted)
    straight = np.linalg.norm(path[-1] - path[settings.skipped]) / length
    return np.append(counted.mean(axis=0), 1 - straight)
