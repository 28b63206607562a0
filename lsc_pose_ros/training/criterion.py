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

"""The cost of a split: the spread of the joints' offsets, or the paper's entropy (eq. 8 to 10).

Both are computed from a few numbers for each sample and joint in reach, the joint statistics.
These are additive: the cost of a set of samples follows from their sums.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.fast_math import log2_from_bits
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.inference.density import squared_distance

SPREAD = 'spread'
ENTROPY = 'entropy'

CRITERIA = (SPREAD, ENTROPY)
"""The criteria of splits: `spread` finds limb ends better, `entropy` is the paper's."""

# Numbers of the spread for each joint: w and w o. The entropy has one: p.
_MOMENTS = 4


class JointStatistics(NamedTuple):
    """Statistics of S samples about the joints in their reach, ordered by sample.

    Attributes:
        start: sample s has the entries start[s] to start[s + 1], shape (S + 1,).
        joint: the joint index of each entry, shape (n,).
        value: for the spread a weight w and w times the offset, shape (n, 4); for the entropy the
            contribution of the joint, shape (n, 1).
        zeros: the sums over no sample, shape (J, 4) or (J, 1).
    """

    start: NDArray[np.int64]
    joint: NDArray[np.uint8]
    value: NDArray[np.float32]
    zeros: NDArray[np.float32]


@kernel
def contributions(
    points: NDArray[np.float32], person: NDArray[np.int32], joints: NDArray[np.float32]
) -> JointStatistics:
    """Return p(x_j | p) of each sample, normalised over the joints (eq. 10).

    p(x_j | p) ~ exp(-||x_j - p||^2 / rho_bar^2) if ||x_j - p|| <= rho_bar, else 0; lengths are in
    units of rho_bar. A point without a labelled joint in reach has no entries.

    Args:
        points: positions in units of rho_bar, shape (S, 3).
        person: index of the person of each point, shape (S,).
        joints: positions in units of rho_bar, NaN if not labelled, shape (P, J, 3).
    """
    start, joint = _in_reach(points, person, joints, 1.0)
    value = np.empty((joint.shape[0], 1), np.float32)
    for s in range(points.shape[0]):
        total = 0.0
        for n in range(start[s], start[s + 1]):
            squared = squared_distance(joints[person[s], joint[n]], points[s])
            value[n, 0] = math.exp(-squared)
            total += value[n, 0]
        for n in range(start[s], start[s + 1]):
            value[n, 0] /= np.float32(total)
    return JointStatistics(start, joint, value, np.zeros((joints.shape[1], 1), np.float32))


@kernel
def offset_moments(
    points: NDArray[np.float32],
    person: NDArray[np.int32],
    joints: NDArray[np.float32],
    reach: float,
) -> JointStatistics:
    """Return (w, w o) of each sample and joint in reach, the moments of the offsets' spread.

    o = x_j - p, w = exp(-||o||^2 / reach^2) if ||o|| <= reach: near joints weigh more, as in the
    votes. Arguments as `contributions`; `reach` in units of rho_bar.
    """
    start, joint = _in_reach(points, person, joints, reach)
    value = np.empty((joint.shape[0], _MOMENTS), np.float32)
    for s in range(points.shape[0]):
        for n in range(start[s], start[s + 1]):
            position = joints[person[s], joint[n]]
            weight = np.float32(math.exp(-squared_distance(position, points[s]) / (reach * reach)))
            value[n, 0] = weight
            for axis in range(3):
                value[n, 1 + axis] = weight * (position[axis] - points[s, axis])
    return JointStatistics(start, joint, value, np.zeros((joints.shape[1], _MOMENTS), np.float32))


@kernel
def _in_reach(
    points: NDArray[np.float32],
    person: NDArray[np.int32],
    joints: NDArray[np.float32],
    reach: float,
) -> tuple[NDArray[np.int64], NDArray[np.uint8]]:
    start = np.zeros(points.shape[0] + 1, np.int64)
    for s in range(points.shape[0]):
        start[s + 1] = start[s]
        for j in range(joints.shape[1]):
            # False for NaN.
            start[s + 1] += squared_distance(joints[person[s], j], points[s]) <= reach * reach
    joint = np.empty(start[-1], np.uint8)
    for s in range(points.shape[0]):
        n = start[s]
        for j in range(joints.shape[1]):
            if squared_distance(joints[person[s], j], points[s]) <= reach * reach:
                joint[n] = j
                n += 1
    return start, joint


@kernel
def select_statistics(statistics: JointStatistics, members: NDArray[np.int32]) -> JointStatistics:
    """Return the statistics of `members`, sample indices, in their order.

    A node reads them many times, so they are copied into contiguous memory.
    """
    start = np.zeros(members.shape[0] + 1, np.int64)
    for m in range(members.shape[0]):
        s = members[m]
        start[m + 1] = start[m] + statistics.start[s + 1] - statistics.start[s]
    joint = np.empty(start[-1], np.uint8)
    value = np.empty((start[-1], statistics.value.shape[1]), np.float32)
    for m in range(members.shape[0]):
        first = statistics.start[members[m]]
        for k in range(start[m + 1] - start[m]):
            joint[start[m] + k] = statistics.joint[first + k]
            for c in range(value.shape[1]):
                value[start[m] + k, c] = statistics.value[first + k, c]
    return JointStatistics(start, joint, value, statistics.zeros)


@kernel
def add_statistics(sums: NDArray[np.float32], statistics: JointStatistics, sample: int) -> None:
    """Add the statistics of one sample to `sums`, shape (J, 4) or (J, 1)."""
    for n in range(statistics.start[sample], statistics.start[sample + 1]):
        joint = statistics.joint[n]
        if sums.shape[1] == _MOMENTS:  # unrolled for speed
            sums[joint, 0] += statistics.value[n, 0]
            sums[joint, 1] += statistics.value[n, 1]
            sums[joint, 2] += statistics.value[n, 2]
            sums[joint, 3] += statistics.value[n, 3]
        else:
            sums[joint, 0] += statistics.value[n, 0]


@kernel
def cost_of(sums: NDArray[np.float32], count: int) -> np.float32:
    """Return the cost of a set of samples; a good split has low costs on both sides.

    Args:
        sums: the summed statistics of the set, shape (J, 4) or (J, 1).
        count: |S|, the number of samples.
    """
    if sums.shape[1] == _MOMENTS:
        return _spread(sums)
    return _entropy_times_count(sums, count)


@kernel
def _spread(sums: NDArray[np.float32]) -> np.float32:
    """Return -sum over j of ||sum w o||^2 / sum w.

    The spread, sum over j of sum w ||o - mean_j||^2, is this plus sum w ||o||^2, which is the same
    for all splits.
    """
    total = np.float32(0)
    for j in range(sums.shape[0]):
        weight = sums[j, 0]
        if weight > np.float32(1e-6):
            x, y, z = sums[j, 1], sums[j, 2], sums[j, 3]
            total -= (x * x + y * y + z * z) / weight
    return total


@kernel
def _entropy_times_count(sums: NDArray[np.float32], count: int) -> np.float32:
    """Return |S| H(S) = -sum over j of s_j log2(s_j / |S|), s_j the sums of contributions (eq. 9).

    The unit is the bit, and the error is below 2e-5 |S|. It is compared only with other entropies.
    """
    bits = sums.view(np.int32)
    total, weight = np.float32(0), np.float32(0)
    for j in range(sums.shape[0]):
        total += sums[j, 0] * log2_from_bits(bits[j, 0])
        weight += sums[j, 0]
    return weight * np.float32(np.log2(count)) - total
