"""The pictorial structure: the best joints together (eq. 16, 17)."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.forest.votes import Votes, votes_for
from lsc_pose_ros.pose.inference.density import Place, Point, density, mean_shift, squared_distance

# Below this a density counts as this: no candidate is impossible, and the logarithm is finite. A
# single vote of full weight has faded to it at 3.7 bandwidths, where the sums are cut off.
_FLOOR = 1e-6
# The logarithm of how much less likely it is that a left and a right joint of the legs are in one
# place. It is to decide between candidates, no more: from 3 to 20 the answers are nearly the same.
_CROWDED = 5.0
_MOST_SWEEPS = 20
_STANDSTILL = 0.0005


class Structure(NamedTuple):
    """The model of the body that the densities are joined by.

    Attributes:
        edges: (parent, child) joint indices, parents before their children, shape (E, 2).
        limb_lengths: h_ij, metres, shape (E,).
        joint_bandwidth: h_j, metres.
        pair_weight: the power of the pair densities.
        legs: (left, right) joint indices of the legs, shape (P, 2).
        legs_apart: from which distance on the two of a pair do not crowd each other, metres.
    """

    edges: NDArray[np.int32]
    limb_lengths: NDArray[np.float32]
    joint_bandwidth: float
    pair_weight: float
    legs: NDArray[np.int32]
    legs_apart: float


class Candidates(NamedTuple):
    """The modes of each joint's density.

    Attributes:
        places: metres, shape (J, K, 3).
        counts: how many of the K places are used, shape (J,).
    """

    places: NDArray[np.float32]
    counts: NDArray[np.int64]


@kernel
def log_pair(structure: Structure, pairs: Votes, edge: int, offset: Place) -> float:
    """Return pair_weight log phi(x_i, x_j) of an edge, `offset` = x_j - x_i in metres (eq. 15).

    An edge without votes says nothing: 0.
    """
    cloud = votes_for(pairs, edge)
    if cloud.x.shape[0] == 0:
        return 0.0
    value = density(offset, cloud, structure.limb_lengths[edge])
    return structure.pair_weight * math.log(max(float(value), _FLOOR))


@kernel
def log_joint(structure: Structure, votes: Votes, joint: int, place: Place) -> float:
    """Return log phi(x_j) of a joint at `place`, metres (eq. 14); 0 for a joint without votes."""
    cloud = votes_for(votes, joint)
    if cloud.x.shape[0] == 0:
        return 0.0
    return math.log(max(float(density(place, cloud, structure.joint_bandwidth)), _FLOOR))


@kernel
def log_legs(structure: Structure, left: Place, right: Place) -> float:
    """Return how a left and a right joint of the legs, in metres, get on: 0 where they are apart.

    The two legs look alike, and a leg that is hidden gets the votes of the other one: then both
    have their best place there. This goes beyond the paper, whose graph ties no left to a right.
    """
    if structure.legs_apart <= 0:
        return 0.0
    distance = math.sqrt(float(squared_distance(left, right)))
    return -_CROWDED * max(0.0, 1.0 - distance / structure.legs_apart)


@kernel
def best_candidates(
    structure: Structure, joints: Votes, pairs: Votes, candidates: Candidates
) -> NDArray[np.int64]:
    """Return which candidate of each joint is best, shape (J,): eq. 16 and log_legs, exact.

    Without the legs' term the graph is two trees, which are solved exactly. Where their solution
    crowds no legs it is also the best with that term, which never adds anything. Elsewhere each
    way to choose the right leg is tried: it makes the rest trees again.
    A joint without a candidate gives -1 and takes no part.
    """
    scores = _joint_scores(structure, joints, candidates)
    ties = _pair_scores(structure, pairs, candidates)
    chosen = _best_in_trees(structure.edges, scores, ties, candidates.counts)
    if not _any_crowded(structure, candidates, chosen):
        return chosen
    best = -np.inf
    for number in range(_ways(structure, candidates)):
        trial = _with_right_leg(structure, candidates, scores, number)
        option = _best_in_trees(structure.edges, trial, ties, candidates.counts)
        value = _value(structure.edges, trial, ties, option)
        if value > best:
            best, chosen = value, option
    return chosen


@kernel
def _joint_scores(
    structure: Structure, joints: Votes, candidates: Candidates
) -> NDArray[np.float64]:
    """Return log phi of each candidate, shape (J, K)."""
    places, counts = candidates.places, candidates.counts
    scores = np.zeros(places.shape[:2])
    for joint in range(places.shape[0]):
        for k in range(counts[joint]):
            scores[joint, k] = log_joint(structure, joints, joint, places[joint, k])
    return scores


@kernel
def _pair_scores(
    structure: Structure, pairs: Votes, candidates: Candidates
) -> NDArray[np.float64]:
    """Return log phi of each edge for all candidates of parent and child, shape (E, K, K)."""
    places, counts, edges = candidates.places, candidates.counts, structure.edges
    scores = np.zeros((edges.shape[0], places.shape[1], places.shape[1]))
    for edge in range(edges.shape[0]):
        parent, child = edges[edge]
        for k in range(counts[parent]):
            for other in range(counts[child]):
                offset = _offset(places[parent, k], places[child, other])
                scores[edge, k, other] = log_pair(structure, pairs, edge, offset)
    return scores


@kernel
def _best_in_trees(
    edges: NDArray[np.int32],
    joint_scores: NDArray[np.float64],
    pair_scores: NDArray[np.float64],
    counts: NDArray[np.int64],
) -> NDArray[np.int64]:
    """Return the best candidates, shape (J,); scores pass from the leaves to the roots."""
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
def _any_crowded(structure: Structure, candidates: Candidates, chosen: NDArray[np.int64]) -> bool:
    for pair in range(structure.legs.shape[0]):
        left, right = structure.legs[pair]
        if chosen[left] < 0 or chosen[right] < 0:
            continue
        place = candidates.places[left, chosen[left]]
        if log_legs(structure, place, candidates.places[right, chosen[right]]) < 0:
            return True
    return False


@kernel
def _ways(structure: Structure, candidates: Candidates) -> int:
    """Return how many ways there are to choose the right leg."""
    ways = 1
    for pair in range(structure.legs.shape[0]):
        ways *= max(1, candidates.counts[structure.legs[pair, 1]])
    return ways


@kernel
def _with_right_leg(
    structure: Structure, candidates: Candidates, scores: NDArray[np.float64], number: int
) -> NDArray[np.float64]:
    """Return the joints' scores where the right leg is chosen in the way `number`, (J, K)."""
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
            place = candidates.places[left, k]
            trial[left, k] += log_legs(structure, place, candidates.places[right, fixed])
    return trial


@kernel
def ascend(
    structure: Structure, joints: Votes, pairs: Votes, start: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Return the joints after ascent of log G from `start`, shape (J, 3), metres (eq. 17).

    Joint by joint, x_j moves to where its gradient vanishes with the votes' shares held fixed: the
    mean of what its own votes (precision 1/h_j^2) and its neighbours' pair votes (precision
    1/h_ij^2) point at. It is the mean-shift step of the product of densities; it never descends.
    NaN marks a joint that takes no part.
    """
    places = start.copy()
    for _ in range(_MOST_SWEEPS):
        farthest = np.float32(0)
        for joint in range(places.shape[0]):
            if math.isnan(places[joint, 0]):
                continue
            moved = _uphill(structure, joints, pairs, places, joint)
            farthest = max(farthest, squared_distance(moved, places[joint]))
            places[joint, 0], places[joint, 1], places[joint, 2] = moved
        if farthest < _STANDSTILL * _STANDSTILL:
            break
    return places


@kernel
def _uphill(
    structure: Structure,
    joints: Votes,
    pairs: Votes,
    places: NDArray[np.float32],
    joint: int,
) -> Point:
    bandwidth = structure.joint_bandwidth
    precision = 1.0 / (bandwidth * bandwidth)
    place = mean_shift(places[joint], votes_for(joints, joint), bandwidth)
    x, y, z = precision * place[0], precision * place[1], precision * place[2]
    for edge in range(structure.edges.shape[0]):
        parent, child = structure.edges[edge]
        if joint not in (parent, child) or pairs.start[edge] == pairs.start[edge + 1]:
            continue
        cloud = votes_for(pairs, edge)
        other = parent if joint == child else child
        if math.isnan(places[other, 0]):
            continue
        length = structure.limb_lengths[edge]
        limb = mean_shift(_offset(places[parent], places[child]), cloud, length)
        pull = structure.pair_weight / (length * length)
        side = 1.0 if joint == child else -1.0
        x += pull * (places[other, 0] + side * limb[0])
        y += pull * (places[other, 1] + side * limb[1])
        z += pull * (places[other, 2] + side * limb[2])
        precision += pull
    return np.float32(x / precision), np.float32(y / precision), np.float32(z / precision)


@kernel
def _offset(origin: Place, place: Place) -> Point:
    return place[0] - origin[0], place[1] - origin[1], place[2] - origin[2]
