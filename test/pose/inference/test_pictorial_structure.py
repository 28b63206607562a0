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

"""The pictorial structure, against all combinations and equations 16 and 17."""

import itertools

import numpy as np
import pytest

from lsc_pose_ros.pose.forest.votes import Votes
from lsc_pose_ros.pose.inference.candidates import Candidates
from lsc_pose_ros.pose.inference.density import VoteCloud
from lsc_pose_ros.pose.inference.pictorial_structure import (
    Structure,
    ascend,
    best_candidates,
)

# Two trees, as the paper has them: 0 - (1, 2 - 3) and 4 - 5.
EDGES = np.array([[0, 1], [0, 2], [2, 3], [4, 5]], np.int32)
JOINTS = 6
NO_LEGS = np.empty((0, 2), np.int32)
# One pair in one tree and one between the trees.
LEGS = np.array([[3, 1], [5, 2]], np.int32)
FLOOR = 1e-6
CROWDED = 5.0


def no_priors(candidates: Candidates) -> np.ndarray:
    return np.zeros(candidates.positions.shape[:2])


def gather_votes(start: list[int], position: np.ndarray, weight: np.ndarray) -> Votes:
    columns = np.ascontiguousarray(position.T.astype(np.float32))
    return Votes(np.array(start), VoteCloud(*columns, weight.astype(np.float32)))


def cast(rng: np.random.Generator, centres: np.ndarray, empty: int | None) -> Votes:
    """Return votes around `centres`, (targets, 3), none for the target `empty`."""
    counts = rng.integers(5, 40, len(centres))
    if empty is not None:
        counts[empty] = 0
    start = np.concatenate([[0], np.cumsum(counts)])
    position = np.repeat(centres, counts, axis=0) + rng.normal(0, 0.08, (start[-1], 3))
    return gather_votes(start, position, rng.random(start[-1]))


def problem(
    seed: int,
    *,
    empty_joint: int | None = None,
    empty_edge: int | None = None,
    legs: np.ndarray = NO_LEGS,
) -> tuple[Structure, Votes, Votes, Candidates]:
    """Return joint votes, pair votes that roughly fit them, and two candidates for each joint."""
    rng = np.random.default_rng(seed)
    centres = rng.normal(0, 0.3, (JOINTS, 3))
    limbs = centres[EDGES[:, 1]] - centres[EDGES[:, 0]] + rng.normal(0, 0.1, (len(EDGES), 3))
    joints, pairs = cast(rng, centres, empty_joint), cast(rng, limbs, empty_edge)
    lengths = rng.uniform(0.1, 0.5, len(EDGES)).astype(np.float32)
    structure = Structure(EDGES, lengths, 0.07, 1.5, legs, 0.4)
    positions = rng.normal(0, 0.3, (JOINTS, 2, 3)).astype(np.float32)
    counts = rng.integers(1, 3, JOINTS)
    for joint in range(JOINTS):
        mine = joints.position[joints.start[joint] : joints.start[joint + 1]]
        if len(mine):
            positions[joint] = mine[rng.integers(0, len(mine), 2)]
        else:
            counts[joint] = 0
    return structure, joints, pairs, Candidates(positions, counts)


def log_sum(position: np.ndarray, votes: Votes, target: int, h: float) -> float:
    mine = slice(votes.start[target], votes.start[target + 1])
    if not len(votes.weight[mine]):
        return 0.0
    squared = ((votes.position[mine].astype(float) - position) ** 2).sum(axis=1)
    fraction = np.where(squared < 16 * h**2, np.exp(-squared / h**2), 0)
    return float(np.log(max((votes.weight[mine] * fraction).sum(), FLOOR)))


def log_g(
    structure: Structure, joints: Votes, pairs: Votes, positions: dict[int, np.ndarray]
) -> float:
    """The logarithm of equation 17 over the joints in `positions`, with the legs' penalty."""
    total = sum(log_sum(x, joints, j, structure.joint_bandwidth) for j, x in positions.items())
    for edge, (i, j) in enumerate(structure.edges.tolist()):
        if i in positions and j in positions:
            h = float(structure.limb_lengths[edge])
            total += structure.pair_weight * log_sum(positions[j] - positions[i], pairs, edge, h)
    for left, right in structure.legs.tolist():
        if left in positions and right in positions:
            distance = float(np.linalg.norm(positions[left] - positions[right]))
            total -= CROWDED * max(0.0, 1 - distance / structure.legs_apart)
    return float(total)


@pytest.mark.parametrize('seed', range(20))
@pytest.mark.parametrize('empty', [(None, None), (2, None), (None, 1), (5, 0)])
@pytest.mark.parametrize('legs', [NO_LEGS, LEGS], ids=['as in the paper', 'legs apart'])
def test_choice_is_the_best_of_all_combinations(
    seed: int, empty: tuple[int | None, int | None], legs: np.ndarray
) -> None:
    structure, joints, pairs, candidates = problem(
        seed, empty_joint=empty[0], empty_edge=empty[1], legs=legs
    )
    chosen = best_candidates(structure, joints, pairs, candidates, no_priors(candidates))

    def score(which: tuple[int, ...]) -> float:
        positions = {
            joint: candidates.positions[joint, k].astype(float)
            for joint, k in enumerate(which)
            if k >= 0
        }
        return log_g(structure, joints, pairs, positions)

    options = [range(count) if count else [-1] for count in candidates.counts]
    best = max(score(which) for which in itertools.product(*options))
    assert [k < 0 for k in chosen] == [count == 0 for count in candidates.counts]
    assert score(tuple(chosen)) == pytest.approx(best, abs=1e-4)


@pytest.mark.parametrize('seed', range(10))
def test_ascent_never_descends_and_ends_where_the_gradient_vanishes(seed: int) -> None:
    structure, joints, pairs, candidates = problem(seed)
    start = candidates.positions[:, 0]

    def value(positions: np.ndarray) -> float:
        return log_g(structure, joints, pairs, dict(enumerate(positions.astype(float))))

    end = ascend(structure, joints, pairs, start)
    assert value(end) >= value(start) - 1e-6
    assert value(ascend(structure, joints, pairs, end)) >= value(end) - 1e-4
    for _ in range(20):
        end = ascend(structure, joints, pairs, end)
    step = 1e-4
    for joint, axis in itertools.product(range(JOINTS), range(3)):
        above, below = end.astype(float).copy(), end.astype(float).copy()
        above[joint, axis] += step
        below[joint, axis] -= step
        slope = (
            log_g(structure, joints, pairs, dict(enumerate(above)))
            - log_g(structure, joints, pairs, dict(enumerate(below)))
        ) / (2 * step)
        # In metres: a slope of 4 under a curvature of 2 / 0.07^2 is 10 mm / 10.
        assert abs(slope) < 4


def test_ascent_leaves_out_joints_that_are_unknown() -> None:
    structure, joints, pairs, candidates = problem(3, empty_joint=2)
    start = candidates.positions[:, 0].copy()
    start[2] = np.nan
    end = ascend(structure, joints, pairs, start)
    assert np.isnan(end[2]).all()
    assert np.isfinite(np.delete(end, 2, axis=0)).all()


def test_pair_density_decides_between_equal_candidates() -> None:
    """A child has two equally likely positions; only one is a limb's length from its parent."""
    positions = np.array([[0, 0, 2], [0.3, 0, 2], [-0.3, 0, 2]])
    joints = gather_votes([0, 1, 3], positions, np.ones(3))
    pairs = gather_votes([0, 1], np.array([[-0.3, 0, 0]]), np.ones(1))
    structure = Structure(
        np.array([[0, 1]], np.int32), np.array([0.3], np.float32), 0.07, 1.0, NO_LEGS, 0.0
    )
    positions = np.array([[[0, 0, 2], [0, 0, 0]], [[0.3, 0, 2], [-0.3, 0, 2]]], np.float32)
    candidates = Candidates(positions, np.array([1, 2]))
    chosen = best_candidates(structure, joints, pairs, candidates, no_priors(candidates))
    assert chosen.tolist() == [0, 1]


@pytest.mark.parametrize(('apart', 'expected'), [(0.12, [0, 1]), (0.0, [0, 0])])
def test_legs_that_are_too_close_take_the_next_best_candidate(
    apart: float, expected: list[int]
) -> None:
    """Most votes for either ankle are at one position; fewer for the right one are at another."""
    positions = np.array([[0, 0, 2], [0.02, 0, 2], [0.3, 0, 2]])
    joints = gather_votes([0, 1, 3], positions, np.array([1, 1, 0.4]))
    nothing = gather_votes([0], np.empty((0, 3)), np.empty(0))
    structure = Structure(
        np.empty((0, 2), np.int32),
        np.empty(0, np.float32),
        0.07,
        1.0,
        np.array([[0, 1]], np.int32),
        apart,
    )
    spots = np.array([[[0, 0, 2], [0, 0, 0]], [[0.02, 0, 2], [0.3, 0, 2]]], np.float32)
    candidates = Candidates(spots, np.array([1, 2]))
    chosen = best_candidates(structure, joints, nothing, candidates, no_priors(candidates))
    assert chosen.tolist() == expected
