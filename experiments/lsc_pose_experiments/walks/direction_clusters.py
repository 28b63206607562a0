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

"""Clusters of directions: k-means on the unit sphere."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel

_ROUNDS = 20


@kernel
def cluster_directions(
    directions: NDArray[np.float32],
    centres: NDArray[np.float32],
    cumulative: NDArray[np.float32],
) -> None:
    """Cluster unit vectors; write the clusters and their cumulative probabilities.

    The first centres are vectors at equal distances in the array. Each vector belongs to the
    centre with the largest dot product, and each centre is the normalised mean of its vectors. The
    probability of a cluster is its fraction of the vectors.

    Args:
        directions: shape (n, 3), n > 0.
        centres: receives the unit vectors, shape (K, 3).
        cumulative: receives the sums of the probabilities up to each cluster, shape (K,).
    """
    count, clusters = directions.shape[0], centres.shape[0]
    used = min(count, clusters)
    for k in range(clusters):
        centres[k] = directions[min(k, used - 1) * count // used]
    cluster = np.zeros(count, np.int64)
    sums, sizes = np.zeros((clusters, 3), np.float32), np.zeros(clusters, np.int64)
    for _ in range(_ROUNDS):
        moved = assign(directions, centres[:used], cluster, sums, sizes)
        for k in range(used):
            length = np.sqrt(sums[k, 0] ** 2 + sums[k, 1] ** 2 + sums[k, 2] ** 2)
            if length > 0:
                centres[k] = sums[k] / length
        if not moved:
            break
    before = 0
    for k in range(clusters):
        before += sizes[k]
        cumulative[k] = np.float32(before) / np.float32(count)


@kernel
def assign(
    directions: NDArray[np.float32],
    centres: NDArray[np.float32],
    cluster: NDArray[np.int64],
    sums: NDArray[np.float32],
    sizes: NDArray[np.int64],
) -> bool:
    """Assign each vector to its nearest centre; return whether one changed its cluster.

    Args:
        directions: shape (n, 3).
        centres: shape (K, 3).
        cluster: the cluster of each vector, updated, shape (n,).
        sums: receives the sum of the vectors of each cluster, shape (K or more, 3).
        sizes: receives their number, shape (K or more,).
    """
    sums[:] = 0
    sizes[:] = 0
    moved = False
    for n in range(directions.shape[0]):
        best, nearest = np.float32(-2), 0
        for k in range(centres.shape[0]):
            dot = np.float32(0)
            for axis in range(3):
                dot += directions[n, axis] * centres[k, axis]
            if dot > best:
                best, nearest = dot, k
        moved |= nearest != cluster[n]
        cluster[n] = nearest
        sums[nearest] += directions[n]
        sizes[nearest] += 1
    return moved
