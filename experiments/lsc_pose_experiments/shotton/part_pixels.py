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

"""The pixels of a body in space, with the probability of each body part."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.shotton.part_forest import PartForest, classify
from lsc_pose_experiments.shotton.part_images import body_image
from lsc_pose_ros.body_parts.depth_grid import FARTHEST, depth_grid
from lsc_pose_ros.camera.projection import back_project
from lsc_pose_ros.data_types.image_arguments import ImageArguments
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.inference.density import VoteCloud

NEGLIGIBLE = np.float32(0.02)
"""A pixel whose probability of a part is lower does not count for that part."""

MOST_PIXELS = 500
"""The largest number of pixels that count for a part; they are taken evenly from all."""


class PartPixels(NamedTuple):
    """The n pixels of a body.

    Attributes:
        points: metres, shape (n, 3).
        probabilities: the probability of each class, shape (n, CLASSES).
    """

    points: NDArray[np.float32]
    probabilities: NDArray[np.float32]


class PartCloud(NamedTuple):
    """The m pixels that may show one body part.

    Attributes:
        votes: their positions, and their weights P(c | I, x) d(x)^2 (Shotton et al., eq. 8).
        probability: P(c | I, x), shape (m,).
    """

    votes: VoteCloud
    probability: NDArray[np.float32]


def classify_body(images: ImageArguments, body: int, forest: PartForest) -> PartPixels | None:
    """Return the classified pixels of a body; None if none of its pixels has a depth.

    Args:
        images: depth, labels and camera.
        body: the number of the body.
        forest: classifies the pixels.
    """
    cut = body_image(images, body)
    if cut is None:
        return None
    depth, camera = cut
    grid = depth_grid(depth, camera)
    probabilities = classify(grid, forest, 1, float(FARTHEST))
    rows, columns = np.nonzero(grid.depth)
    middle = grid.step // 2
    points = back_project(
        columns * grid.step + middle, rows * grid.step + middle, grid.depth[rows, columns], camera
    )
    return PartPixels(points, probabilities[rows, columns])


@kernel
def part_cloud(pixels: PartPixels, part: int) -> PartCloud:
    """Return the pixels that may show a part, at most MOST_PIXELS, evenly from all.

    Args:
        pixels: the pixels of a body.
        part: the class, 1 + the number of the joint.
    """
    points, probabilities = pixels.points, pixels.probabilities
    count = 0
    for n in range(points.shape[0]):
        count += probabilities[n, part] >= NEGLIGIBLE
    stride = max(1, -(-count // MOST_PIXELS))
    kept = -(-count // stride)
    x, y, z = np.empty(kept, np.float32), np.empty(kept, np.float32), np.empty(kept, np.float32)
    weight, probability = np.empty(kept, np.float32), np.empty(kept, np.float32)
    seen = 0
    for n in range(points.shape[0]):
        if probabilities[n, part] < NEGLIGIBLE:
            continue
        if seen % stride == 0:
            k = seen // stride
            x[k], y[k], z[k] = points[n, 0], points[n, 1], points[n, 2]
            probability[k] = probabilities[n, part]
            weight[k] = probability[k] * z[k] * z[k]
        seen += 1
    return PartCloud(VoteCloud(x, y, z, weight), probability)
