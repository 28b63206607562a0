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

"""The pictorial structure: the most likely joints of a body together (eq. 16, 17)."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.forest.votes import Votes, votes_of_target
from lsc_pose_ros.pose.inference.candidates import Candidates
from lsc_pose_ros.pose.inference.density import (
    Point,
    Position,
    density,
    mean_shift,
    squared_distance,
)

# The least density: no candidate is impossible, and the logarithm is finite. The density of one
# vote of full weight falls to it at 3.7 bandwidths, near where the sums are cut off.
_FLOOR = 1e-6
# The penalty, a logarithm, if a left and a right joint of the legs have the same position. It only
# decides between candidates: from 3 to 20 the estimates are nearly the same.
_CLOSE_LEGS = 5.0
_MOST_SWEEPS = 20
_CONVERGED = 0.0005


class Structure(NamedTuple):
    """The tree-shaped model of the body that joins the densities.

    Attributes:
        edges: (parent, child) joint indices, parents before their children, shape (E, 2).
        limb_lengths: h_ij, metres, shape (E,).
        joint_bandwidth: h_j, metres.
        pair_weight: the power of the pair densities.
        legs: (left, right) joint indices of the legs, shape (P, 2).
        legs_apart: a pair closer than this is penalised, metres; 0: none is.
    """

    edges: NDArray[np.int32]
    limb_lengths: NDArray[np.float32]
    joint_bandwidth: float
    pair_weight: float
    legs: NDArray[np.int32]
    legs_apart: float


@kernel
def log_pair(structure: Structure, pairs: Votes, edge: int, offset: Position) -> float:
    """Return pair_weight log phi(x_i, x_j) of an edge, `offset` = x_j - x_i in metres (eq. 15).

    It is 0 for an edge without votes.
    """
    cloud = votes_of_target(pairs, edge)
    if cloud.x.shape[0] == 0:
        return 0.0
    value = density(offset, cloud, structure.limb_lengths[edge])
    return structure.pair_weight * math.log(max(float(value), _FLOOR))


@kernel
def log_joint(structure: Structure, votes: Votes, joint: int, position: Position) -> float:
    """Return log phi(x_j) of a joint at `position`, metres (eq. 14).

    It is 0 for a joint without votes.
    """
    cloud = votes_of_target(votes, joint)
    if cloud.x.shape[0] == 0:
        return 0.0
    return math.log(max(float(density(position, cloud, structure.joint_bandwidth)), _FLOOR))


@kernel
def log_legs(structure: Structure, left: Position, right: Position) -> float:
    """Return the penalty, 0 or less, for a left and a right joint of the legs that are close.

    The two legs look alike, and a hidden leg gets the votes of the other one: then both have their
    best position there. This goes beyond the paper, whose graph joins no left to a right joint.

    Args:
        structure: has the distance at which the penalty ends.
        left: the left joint, metres, shape (3,).
        right: the right joint, likewise.
    """
    if structure.legs_apart <= 0:
        return 0.0
    distance = math.sqrt(float(squared_distance(left, right)))
    return -_CLOSE_LEGS * max(0.0, 1.0 - distance / structure.legs_apart)


@kernel
def best_candidates(
    structure: Structure,
    joints: Votes,
    pairs: Votes,
    candidates: Candidates,
    priors: NDArray[np.float64],
) -> NDArray[np.int64]:
    """Return the index of each joint's best candidate, shape (J,): eq. 16 and log_legs, exactly.

    Without log_legs the graph is two trees, which dynamic programming solves exactly. If no legs
    are close in that solution, it is also the best one with log_legs, which is never positive.
    Otherwise each choice of the right leg's candidates is tried: with these fixed, the graph is
    trees again. The index of a joint without a candidate is -1.

    Args:
        structure: edges, bandwidths and legs.
        joints: the votes for each joint.
        pairs: the votes for each edge.
        candidates: the modes of each joint's density.
        priors: the logarithm of what is known of each candidate otherwise, shape (J, K).
    """
    joint_scores = _joint_scores(structure, joints, candidates) + priors
    pair_scores = _pair_scores(structure, pairs, candidates)
    chosen = _best_in_trees(structure.edges, joint_scores, pair_scores, candidates.counts)
    if not _any_close_legs(structure, candidates, chosen):
        return chosen
    best = -np.inf
    for number in range(_right_leg_choices(structure, candidates)):
        trial = _with_right_leg(structure, candidates, joint_scores, number)
        option = _best_in_trees(structure.edges, trial, pair_scores, candidates.counts)
        value = _value(structure.edges, trial, pair_scores, option)
        if value > best:
            best, chosen = value, option
    return chosen


@kernel
def _joint_scores(
    structure: Structure, joints: Votes, candidates: Candidates
) -> NDArray[np.float64]:
    """Return log phi of each candidate, shape (J, K)."""
    positions, counts = candidates.positions, candidates.counts
    scores = np.zeros(positions.shape[:2])
    for joint in range(positions.shape[0]):
        for k in range(counts[joint]):
            scores[joint, k] = log_joint(structure, joints, joint, positions[joint, k])
    return scores


@kernel
def _pair_scores(
    structure: Structure, pairs: Votes, candidates: Candidates
) -> NDArray[np.float64]:
    """Return log phi of each edge for all candidates of parent and child, shape (E, K, K)."""
    positions, counts, edges = candidates.positions, candidates.counts, structure.edges
    scores = np.zeros((edges.shape[0], positions.shape[1], positions.shape[1]))
    for edge in range(edges.shape[0]):
        parent, child = edges[edge]
        for k in range(counts[parent]):
            for other in range(counts[child]):
                offset = _offset(positions[parent, k], positions[child, other])
                scores[edge, k, other] = log_pair(structure, pairs, edge, offset)
    return scores


@kernel
def _best_in_trees(
    edges: NDArray[np.int32],
    joint_scores: NDArray[np.float64],
    pair_scores: NDArray[np.float64],
    counts: NDArray[np.int64],
) -> NDArray[np.int64]:
    """Return the best candidates, shape (J,), by dynamic programming from the leaves up."""
    scores = joint_scores.copy()
    pointers = np.zeros((edges.shape[0], scores.shape[1]), np.int64)
    for edge in range(edges.shape[0] - 1, -1, -1):
        parent, child = edges[edge]
        if counts[child] == 0:
            continue
        for k in range(counts[parent]):
            best, which = -np.inf, 0
            for other in range(counts[child]):
                score = scores[child, other] + pair_scores[edge, k, other]
                if score > best:
                    best, which = score, other
            scores[parent, k] += best
            pointers[edge, k] = which
    return _trace_back(edges, scores, pointers, counts)


@kernel
def _trace_back(
    edges: NDArray[np.int32],
    scores: NDArray[np.float64],
    pointers: NDArray[np.int64],
    counts: NDArray[np.int64],
) -> NDArray[np.int64]:
    chosen = np.full(counts.shape[0], -1)
    for joint in range(counts.shape[0]):
        if counts[joint]:
            chosen[joint] = np.argmax(scores[joint, : counts[joint]])
    for edge in range(edges.shape[0]):
        parent, child = edges[edge]
        if chosen[parent] >= 0 and chosen[child] >= 0:
            chosen[child] = pointers[edge, chosen[parent]]
    return chosen


@kernel
def _value(
    edges: NDArray[np.int32],
    joint_scores: NDArray[np.float64],
    pair_scores: NDArray[np.float64],
    chosen: NDArray[np.int64],
) -> float:
    total = 0.0
    for joint in range(chosen.shape[0]):
        if chosen[joint] >= 0:
            total += joint_scores[joint, chosen[joint]]
    for edge in range(edges.shape[0]):
        parent, child = edges[edge]
        if chosen[parent] >= 0 and chosen[child] >= 0:
            total += pair_scores[edge, chosen[parent], chosen[child]]
    return total


@kernel
def _any_close_legs(
    structure: Structure, candidates: Candidates, chosen: NDArray[np.int64]
) -> bool:
    for pair in range(structure.legs.shape[0]):
        left, right = structure.legs[pair]
        if chosen[left] < 0 or chosen[right] < 0:
            continue
        position = candidates.positions[left, chosen[left]]
        if log_legs(structure, position, candidates.positions[right, chosen[right]]) < 0:
            return True
    return False


@kernel
def _right_leg_choices(structure: Structure, candidates: Candidates) -> int:
    """Return the number of combinations of the right leg's candidates."""
    choices = 1
    for pair in range(structure.legs.shape[0]):
        choices *= max(1, candidates.counts[structure.legs[pair, 1]])
    return choices


@kernel
def _with_right_leg(
    structure: Structure, candidates: Candidates, scores: NDArray[np.float64], number: int
) -> NDArray[np.float64]:
    """Return the joints' scores with the right leg fixed to combination `number`, (J, K)."""
    trial = scores.copy()
    for pair in range(structure.legs.shape[0]):
        left, right = structure.legs[pair]
        count = candidates.counts[right]
        if count == 0:
            continue
        fixed = number % count
        number //= count
        for k in range(count):
            if k != fixed:
                trial[right, k] = -np.inf
        for k in range(candidates.counts[left]):
            position = candidates.positions[left, k]
            trial[left, k] += log_legs(structure, position, candidates.positions[right, fixed])
    return trial


@kernel
def ascend(
    structure: Structure, joints: Votes, pairs: Votes, start: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Return the joints after ascent of log G from `start`, metres, shape (J, 3) (eq. 17).

    One joint after the other, x_j moves to the zero of its gradient for fixed kernel weights: the
    mean of the positions that its own votes (precision 1/h_j^2) and its neighbours' pair votes
    (precision 1/h_ij^2) give. This is the mean-shift step of a product of densities; log G never
    decreases.

    Args:
        structure: edges and bandwidths.
        joints: the votes for each joint.
        pairs: the votes for each edge.
        start: metres, NaN for a joint that is left out, shape (J, 3).
    """
    positions = start.copy()
    for _ in range(_MOST_SWEEPS):
        farthest = np.float32(0)
        for joint in range(positions.shape[0]):
            if math.isnan(positions[joint, 0]):
                continue
            moved = _ascent_step(structure, joints, pairs, positions, joint)
            farthest = max(farthest, squared_distance(moved, positions[joint]))
            positions[joint, 0], positions[joint, 1], positions[joint, 2] = moved
        if farthest < _CONVERGED * _CONVERGED:
            break
    return positions


@kernel
def _ascent_step(
    structure: Structure,
    joints: Votes,
    pairs: Votes,
    positions: NDArray[np.float32],
    joint: int,
) -> Point:
    bandwidth = structure.joint_bandwidth
    precision = 1.0 / (bandwidth * bandwidth)
    position = mean_shift(positions[joint], votes_of_target(joints, joint), bandwidth)
    x, y, z = precision * position[0], precision * position[1], precision * position[2]
    for edge in range(structure.edges.shape[0]):
        parent, child = structure.edges[edge]
        if joint not in (parent, child) or pairs.start[edge] == pairs.start[edge + 1]:
            continue
        cloud = votes_of_target(pairs, edge)
        other = parent if joint == child else child
        if math.isnan(positions[other, 0]):
            continue
        length = structure.limb_lengths[edge]
        limb = mean_shift(_offset(positions[parent], positions[child]), cloud, length)
        pull = structure.pair_weight / (length * length)
        side = 1.0 if joint == child else -1.0
        x += pull * (positions[other, 0] + side * limb[0])
        y += pull * (positions[other, 1] + side * limb[1])
        z += pull * (positions[other, 2] + side * limb[2])
        precision += pull
    return np.float32(x / precision), np.float32(y / precision), np.float32(z / precision)


@kernel
def _offset(origin: Position, position: Position) -> Point:
    return position[0] - origin[0], position[1] - origin[1], position[2] - origin[2]
