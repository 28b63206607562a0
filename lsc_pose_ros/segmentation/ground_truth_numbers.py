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

"""Gives segmented bodies the numbers that they have in the ground truth."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.skeletons import Skeletons


def numbered_as_ground_truth(
    labels: NDArray[np.int32], ground_truth: Skeletons, camera: Intrinsics
) -> NDArray[np.int32]:
    """Return `labels` with the numbers of the ground truth.

    A segmenter numbers bodies in its own order. Each body gets the number of the skeleton that has
    most joints on its pixels. A body without joints gets a number that no skeleton has.

    Args:
        labels: the body number of each pixel, NO_BODY for none, shape (H, W).
        ground_truth: the labelled skeletons.
        camera: the intrinsics.
    """
    bodies = np.unique(labels[labels != NO_BODY])
    counts = np.array(
        [joints_on(labels, bodies, positions, camera) for positions in ground_truth.positions]
    ).reshape(len(ground_truth.bodies), len(bodies))
    free = int(max([*ground_truth.bodies.tolist(), 0])) + 1
    numbers = {int(body): free + rank for rank, body in enumerate(bodies)}
    while counts.size and counts.max() > 0:
        skeleton, rank = np.unravel_index(int(counts.argmax()), counts.shape)
        numbers[int(bodies[rank])] = int(ground_truth.bodies[skeleton])
        counts[skeleton] = 0
        counts[:, rank] = 0
    numbered = np.full_like(labels, NO_BODY)
    for body, number in numbers.items():
        numbered[labels == body] = number
    return numbered


def joints_on(
    labels: NDArray[np.int32],
    bodies: NDArray[np.int32],
    positions: NDArray[np.float32],
    camera: Intrinsics,
) -> NDArray[np.int64]:
    """Return how many joints of one skeleton are on the pixels of each body, shape (B,).

    Args:
        labels: the body number of each pixel, shape (H, W).
        bodies: the numbers that are counted, shape (B,).
        positions: metres, NaN if unknown, shape (J, 3).
        camera: the intrinsics.
    """
    pixels = project(positions, camera)
    pixels = np.rint(pixels[np.isfinite(pixels).all(axis=-1)])
    height, width = labels.shape
    inside = (pixels >= 0).all(axis=-1) & (pixels < (width, height)).all(axis=-1)
    columns, rows = pixels[inside].astype(np.int64).T
    on_body: NDArray[np.bool_] = labels[rows, columns][:, None] == bodies
    counts: NDArray[np.int64] = on_body.sum(axis=0)
    return counts
