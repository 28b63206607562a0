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

"""How good a split is: the spread of the joints' offsets, or the paper's entropy (eq. 8 to 10).

Either looks, for each sample, at a few numbers about the joints near it, its evidence. They add
up, so that a set of samples is judged by the sums over it.
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
"""What splits can be chosen by: `spread` finds limb ends better, `entropy` is the paper's."""

# How many numbers each criterion keeps for a joint: w and w o, or p.
_MOMENTS = 4


class Evidence(NamedTuple):
    """What S samples say of the joints in their reach, sample after sample.

    Attributes:
        start: the evidence of sample s is start[s] to start[s + 1], shape (S + 1,).
        joint: which joint, shape (n,).
        value: of the spread: a weight w and w times the offset, shape (n, 4); of the entropy: the
            joint's contribution, shape (n, 1).
        nothing: what no sample says: zeros for each joint, shape (J, 4) or (J, 1).
    """

    start: NDArray[np.int64]
    joint: NDArray[np.uint8]
    value: NDArray[np.float32]
    nothing: NDArray[np.float32]


@kernel
def contributions(
    points: NDArray[np.float32], person: NDArray[np.int32], joints: NDArray[np.float32]
) -> Evidence:
    """Return p(x_j | p) of each sample, adding up to 1 over the joints (eq. 10).

    p(x_j | p) ~ exp(-||x_j - p||^2 / rho_bar^2) where ||x_j - p|| <= rho_bar, else 0; lengths are
    in units of rho_bar. A point with no labelled joint in reach has no evidence.

    Args:
        points: shape (S, 3).
        person: whose point it is, shape (S,).
        joints: NaN where not labelled, shape (P, J, 3).
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
    return Evidence(start, joint, value, np.zeros((joints.shape[1], 1), np.float32))


@kernel
def offset_moments(
    points: NDArray[np.float32],
    person: NDArray[np.int32],
    joints: NDArray[np.float32],
    reach: float,
) -> Evidence:
    """Return (w, w o) of each sample and joint in reach: what the spread of offsets is made of.

    o = x_j - p, w = exp(-||o||^2 / reach^2) where ||o|| <= reach: a point speaks of what is near
    it, as its votes do. Arguments as `contributions`; `reach` in units of rho_bar.
    """
    start, joint = _in_reach(points, person, joints, reach)
    value = np.empty((joint.shape[0], _MOMENTS), np.float32)
    for s in range(points.shape[0]):
        for n in range(start[s], start[s + 1]):
            place = joints[person[s], joint[n]]
            weight = np.float32(math.exp(-squared_distance(place, points[s]) / (reach * reach)))
            value[n, 0] = weight
            for axis in range(3):
                value[n, 1 + axis] = weight * (place[axis] - points[s, axis])
    return Evidence(start, joint, value, np.zeros((joints.shape[1], _MOMENTS), np.float32))


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
def evidence_of(evidence: Evidence, members: NDArray[np.int32]) -> Evidence:
    """Return the evidence of some samples, in their order: what a node reads again and again."""
    start = np.zeros(members.shape[0] + 1, np.int64)
    for m in range(members.shape[0]):
        s = members[m]
        start[m + 1] = start[m] + evidence.start[s + 1] - evidence.start[s]
    joint = np.empty(start[-1], np.uint8)
    value = np.empty((start[-1], evidence.value.shape[1]), np.float32)
    for m in range(members.shape[0]):
        first = evidence.start[members[m]]
        for k in range(start[m + 1] - start[m]):
            joint[start[m] + k] = evidence.joint[first + k]
            for c in range(value.shape[1]):
                value[start[m] + k, c] = evidence.value[first + k, c]
    return Evidence(start, joint, value, evidence.nothing)


@kernel
def add_up(sums: NDArray[np.float32], evidence: Evidence, sample: int) -> None:
    """Add the evidence of one sample to `sums`, shape (J, numbers a joint)."""
    for n in range(evidence.start[sample], evidence.start[sample + 1]):
        joint = evidence.joint[n]
        if sums.shape[1] == _MOMENTS:  # spelt out, for speed
            sums[joint, 0] += evidence.value[n, 0]
            sums[joint, 1] += evidence.value[n, 1]
            sums[joint, 2] += evidence.value[n, 2]
            sums[joint, 3] += evidence.value[n, 3]
        else:
            sums[joint, 0] += evidence.value[n, 0]


@kernel
def cost_of(sums: NDArray[np.float32], count: int) -> np.float32:
    """Return what a set costs of which the evidence adds up to `sums`; the less, the better.

    Args:
        sums: shape (J, numbers a joint).
        count: |S|, how many samples the set has.
    """
    if sums.shape[1] == _MOMENTS:
        return _spread(sums)
    return _entropy_times_count(sums, count)


@kernel
def _spread(sums: NDArray[np.float32]) -> np.float32:
    """Return -sum over j of ||sum w o||^2 / sum w.

    The weighted squared distance of the offsets from their means, sum over j of
    sum w ||o - mean_j||^2, is this and sum w ||o||^2, which no split changes.
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

    The unit is the bit: it is compared with its like only. To 2e-5 |S|.
    """
    bits = sums.view(np.int32)
    total, weight = np.float32(0), np.float32(0)
    for j in range(sums.shape[0]):
        total += sums[j, 0] * log2_from_bits(bits[j, 0])
        weight += sums[j, 0]
    return weight * np.float32(np.log2(count)) - total
