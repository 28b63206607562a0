"""The pictorial structure: the best joints together (eq. 16, 17)."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.core.density import Place, Point, density, mean_shift, squared_distance
from lsc_pose_ros.core.jit import kernel
from lsc_pose_ros.core.votes import CastVotes, votes_for

# Below this a density counts as this: no candidate is impossible, and the logarithm is finite. A
# single vote of full weight has faded to it at 3.7 bandwidths, where the sums are cut off.
_FLOOR = 1e-6
_MOST_SWEEPS = 20
_STANDSTILL = 0.0005


class Structure(NamedTuple):
    """The model of the body that the densities are joined by.

    Attributes:
        edges: (parent, child) joint indices, parents before their children, shape (E, 2).
        limb_lengths: h_ij, metres, shape (E,).
        joint_bandwidth: h_j, metres.
        pair_weight: the power of the pair densities.
    """

    edges: NDArray[np.int32]
    limb_lengths: NDArray[np.float32]
    joint_bandwidth: float
    pair_weight: float


class Candidates(NamedTuple):
    """The modes of each joint's density.

    Attributes:
        places: metres, shape (J, K, 3).
        counts: how many of the K places are used, shape (J,).
    """

    places: NDArray[np.float32]
    counts: NDArray[np.int64]


@kernel
def log_pair(structure: Structure, pairs: CastVotes, edge: int, offset: Place) -> float:
    """Return pair_weight log phi(x_i, x_j) of an edge, `offset` = x_j - x_i in metres (eq. 15).

    An edge without votes says nothing: 0.
    """
    cloud = votes_for(pairs, edge)
    if cloud.x.shape[0] == 0:
        return 0.0
    value = density(offset, cloud, structure.limb_lengths[edge])
    return structure.pair_weight * math.log(max(float(value), _FLOOR))


@kernel
def log_joint(structure: Structure, votes: CastVotes, joint: int, place: Place) -> float:
    """Return log phi(x_j) of a joint at `place`, metres (eq. 14); 0 for a joint without votes."""
    cloud = votes_for(votes, joint)
    if cloud.x.shape[0] == 0:
        return 0.0
    return math.log(max(float(density(place, cloud, structure.joint_bandwidth)), _FLOOR))


@kernel
def best_candidates(
    structure: Structure, joints: CastVotes, pairs: CastVotes, candidates: Candidates
) -> NDArray[np.int64]:
    """Return which candidate of each joint is best, shape (J,): eq. 16, exact over the trees.

    Scores pass from the leaves to the roots (max-product), choices back. A joint without a
    candidate gives -1 and takes no part.
    """
    places, counts = candidates.places, candidates.counts
    edges = structure.edges
    scores = np.zeros(places.shape[:2])
    for joint in range(places.shape[0]):
        for k in range(counts[joint]):
            scores[joint, k] = log_joint(structure, joints, joint, places[joint, k])
    pointers = np.zeros((edges.shape[0], places.shape[1]), np.int64)
    for edge in range(edges.shape[0] - 1, -1, -1):
        parent, child = edges[edge]
        if counts[child] == 0:
            continue
        for k in range(counts[parent]):
            best, which = -np.inf, 0
            for other in range(counts[child]):
                offset = _offset(places[parent, k], places[child, other])
                score = scores[child, other] + log_pair(structure, pairs, edge, offset)
                if score > best:
                    best, which = score, other
            scores[parent, k] += best
            pointers[edge, k] = which
    return _trace_back(structure.edges, scores, pointers, counts)


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
def ascend(
    structure: Structure, joints: CastVotes, pairs: CastVotes, start: NDArray[np.float32]
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
    joints: CastVotes,
    pairs: CastVotes,
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
