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

import itertools
import math

import numpy as np
import pytest

from lsc_pose_ros.training.criterion import (
    JointStatistics,
    add_statistics,
    contributions,
    cost_of,
    offset_moments,
    select_statistics,
)
from lsc_pose_ros.training.splitter import partition, try_feature
from lsc_pose_ros.training.tree_growth import BRANCH_SAMPLES, GrowthSettings, find_split, grow_tree


def contributions_twin(points, person, joints):
    """Compute equation 10 sample by sample."""
    result = np.zeros((len(points), joints.shape[1]))
    for s, point in enumerate(points.astype(float)):
        for j, joint in enumerate(joints[person[s]]):
            distance = np.linalg.norm(joint - point)
            if distance <= 1:
                result[s, j] = math.exp(-(distance**2))
        if result[s].sum() > 0:
            result[s] /= result[s].sum()
    return result


def offset_moments_twin(points, person, joints, reach):
    """w = exp(-||o||^2 / reach^2) within the reach, and w o, for each sample and joint."""
    result = np.zeros((len(points), joints.shape[1], 4))
    for s, point in enumerate(points.astype(float)):
        for j, joint in enumerate(joints[person[s]]):
            offset = joint - point
            if np.linalg.norm(offset) <= reach:
                weight = math.exp(-(offset @ offset) / reach**2)
                result[s, j] = [weight, *(weight * offset)]
    return result


def dense(statistics):
    """Return statistics as one array, shape (S, J, 4) or (S, J, 1)."""
    result = np.zeros((len(statistics.start) - 1, *statistics.zeros.shape))
    for s in range(len(result)):
        some = slice(statistics.start[s], statistics.start[s + 1])
        result[s, statistics.joint[some]] = statistics.value[some]
    return result


def sparse(values):
    """Return statistics from an array of that shape; zeros are left out."""
    said = (values != 0).any(axis=2)
    return JointStatistics(
        np.concatenate([[0], np.cumsum(said.sum(axis=1))]),
        np.nonzero(said)[1].astype(np.uint8),
        values[said].astype(np.float32),
        np.zeros(values.shape[1:], np.float32),
    )


def squares_about_the_mean(offsets, weights):
    """Return the sum over j of sum w ||o - mean_j||^2; offsets (n, J, 3), weights (n, J)."""
    total = 0.0
    for j in range(weights.shape[1]):
        some = weights[:, j] > 0
        if some.any():
            mean = np.average(offsets[some, j], axis=0, weights=weights[some, j])
            total += weights[some, j] @ ((offsets[some, j] - mean) ** 2).sum(axis=1)
    return total


def weighted_entropy(weights):
    """|S| H(S) of equation 9, in bits."""
    fractions = weights.astype(float).sum(axis=0) / max(len(weights), 1)
    fractions = fractions[fractions > 0]
    return -len(weights) * float((fractions * np.log2(fractions)).sum())


def random_samples(seed, count=300, joints=4, quantised=30):
    rng = np.random.default_rng(seed)
    weights = rng.random((count, joints)).astype(np.float32)
    weights /= weights.sum(axis=1, keepdims=True)
    weights[rng.random((count, joints)) < 0.3] = 0
    return rng.integers(0, quantised, (360, count)).astype(np.uint8), weights


@pytest.mark.parametrize('seed', range(3))
def test_contributions_are_equation_10(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(0, 0.6, (100, 3)).astype(np.float32)
    joints = rng.normal(0, 0.6, (5, 6, 3)).astype(np.float32)
    joints[2, 3] = np.nan
    points[0] = 100  # no joint in reach
    person = rng.integers(0, 5, 100).astype(np.int32)
    found = dense(contributions(points, person, joints))[..., 0]
    np.testing.assert_allclose(found, contributions_twin(points, person, joints), atol=1e-6)
    assert found[0].sum() == 0


@pytest.mark.parametrize('reach', [0.3, 1.0])
def test_offset_moments(reach):
    rng = np.random.default_rng(0)
    points = rng.normal(0, 0.4, (100, 3)).astype(np.float32)
    joints = rng.normal(0, 0.4, (5, 6, 3)).astype(np.float32)
    joints[2, 3] = np.nan
    points[0] = 100
    person = rng.integers(0, 5, 100).astype(np.int32)
    found = dense(offset_moments(points, person, joints, reach))
    expected = offset_moments_twin(points, person, joints, reach)
    np.testing.assert_allclose(found, expected, atol=1e-6)
    assert 0 < (expected[..., 0] > 0).mean() < 1


@pytest.mark.parametrize('numbers', [1, 4])
def test_statistics_of_some_samples(numbers):
    rng = np.random.default_rng(numbers)
    values = rng.random((50, 3, numbers)) * (rng.random((50, 3, 1)) < 0.5)
    members = rng.permutation(50)[:20].astype(np.int32)
    some = select_statistics(sparse(values), members)
    np.testing.assert_allclose(dense(some), values[members], rtol=1e-6)
    sums = np.zeros((3, numbers), np.float32)
    for sample in range(20):
        add_statistics(sums, some, sample)
    np.testing.assert_allclose(sums, values[members].sum(axis=0), rtol=1e-5)
    assert len(select_statistics(some, members[:0]).joint) == 0


@pytest.mark.parametrize('seed', range(3))
def test_entropy_is_equation_9(seed):
    weights = np.random.default_rng(seed).random((50, 5)).astype(np.float32)
    weights[:, 2] = 0
    weights /= weights.sum(axis=1, keepdims=True)
    found = cost_of(weights.sum(axis=0)[:, None].copy(), 50)
    assert found == pytest.approx(weighted_entropy(weights), abs=2e-5 * 50)


@pytest.mark.parametrize('seed', range(3))
def test_spread_differs_from_the_squares_about_the_mean_by_what_no_split_changes(seed):
    rng = np.random.default_rng(seed)
    offsets, weights = rng.normal(0, 0.2, (60, 5, 3)), rng.random((60, 5))
    weights[:, 2] = 0
    weights[:50, 3] = 0
    moments = np.concatenate([weights[..., None], weights[..., None] * offsets], axis=2)
    for members in (slice(None), slice(0, 17), slice(17, 60), slice(5, 6)):
        found = cost_of(moments[members].sum(axis=0).astype(np.float32), 1)
        unchanged = (weights[members] * (offsets[members] ** 2).sum(axis=2)).sum()
        expected = squares_about_the_mean(offsets[members], weights[members])
        assert found + unchanged == pytest.approx(expected, abs=1e-4)


def test_set_without_statistics_costs_nothing():
    assert cost_of(np.zeros((4, 4), np.float32), 7) == 0
    assert cost_of(np.zeros((4, 1), np.float32), 7) == 0


@pytest.mark.parametrize('seed', range(8))
@pytest.mark.parametrize('leaf_samples', [1, 20, 149])
def test_best_threshold_is_the_best_of_those_drawn(seed, leaf_samples):
    quantised, weights = random_samples(seed)
    rng = np.random.default_rng(seed)
    members = rng.permutation(300)[:200].astype(np.int32)
    draws = rng.random(12)
    statistics = select_statistics(sparse(weights[..., None]), members)
    cost, threshold = try_feature(quantised[5], statistics, members, draws, leaf_samples)
    mine = quantised[5][members]
    costs = {}
    for draw in draws:
        eta = int(mine.min()) + 1 + int(draw * (int(mine.max()) - int(mine.min())))
        left, right = weights[members][mine < eta], weights[members][mine >= eta]
        if min(len(left), len(right)) >= leaf_samples:
            costs[eta] = weighted_entropy(left) + weighted_entropy(right)
    if not costs:
        assert cost == np.inf
    else:
        assert cost == pytest.approx(min(costs.values()), abs=1e-4 * len(members))
        split = [eta for eta in costs if (mine < eta).sum() == (mine < threshold).sum()]
        assert costs[split[0]] == pytest.approx(cost, abs=1e-4 * len(members))


def test_feature_that_is_the_same_everywhere_splits_nothing():
    statistics = sparse(np.full((50, 3, 1), 1 / 3))
    quantised = np.full(50, 9, np.uint8)
    cost, _ = try_feature(
        quantised, statistics, np.arange(50, dtype=np.int32), np.array([0.1, 0.9]), 1
    )
    assert cost == np.inf


def test_feature_that_separates_is_found_among_those_drawn():
    quantised, weights = random_samples(0, 300)
    quantised[77] = np.where(np.arange(300) % 2, 200, 10)
    weights[::2] = [1, 0, 0, 0]
    weights[1::2] = [0, 0, 0, 1]
    settings = GrowthSettings(features=360)
    members = np.arange(300, dtype=np.int32)
    split = find_split(
        quantised, sparse(weights[..., None]), members, settings, np.random.default_rng(0)
    )
    assert split.feature == 77
    assert 10 < split.threshold <= 200
    assert split.cost == pytest.approx(0, abs=2e-5 * 300)
    tree = grow_tree(quantised, sparse(weights[..., None]), settings, np.random.default_rng(0))
    assert tree.feature[0] == 77


@pytest.mark.parametrize('size', [1, 5, 60, 1000])
def test_trees_grow_on_any_number_of_features(size):
    """The number may be below that of tried features, or above that of a descriptor's bins."""
    rng = np.random.default_rng(size)
    weights = rng.dirichlet(np.ones(4), BRANCH_SAMPLES + 500).astype(np.float32)
    quantised = rng.integers(0, 256, (size, len(weights)), np.uint8)
    tree = grow_tree(quantised, sparse(weights[..., None]), GrowthSettings(leaf_samples=200), rng)
    used = np.unique(tree.feature[tree.feature >= 0])
    assert used.max() >= 0.9 * (size - 1)
    assert len(used) > min(size, 40) / 2


def test_spread_finds_the_feature_that_depends_on_a_joint():
    """All samples are at the same distance from the joint, on either side of it."""
    quantised, _ = random_samples(0, 300)
    quantised[77] = np.where(np.arange(300) % 2, 200, 10)
    points = np.zeros((300, 3), np.float32)
    points[:, 0] = np.where(np.arange(300) % 2, 0.2, -0.2)
    joints = np.zeros((1, 1, 3), np.float32)
    statistics = offset_moments(points, np.zeros(300, np.int32), joints, 0.5)
    members = np.arange(300, dtype=np.int32)
    settings = GrowthSettings(features=360)
    split = find_split(quantised, statistics, members, settings, np.random.default_rng(0))
    assert split.feature == 77


def test_partition_keeps_orders():
    quantised, _ = random_samples(1)
    members = np.random.default_rng(1).permutation(300)[:100].astype(np.int32)
    before = members.copy()
    below = partition(quantised[0], members, 12)
    low = quantised[0][before] < 12
    assert below == low.sum()
    np.testing.assert_array_equal(members, [*before[low], *before[~low]])


@pytest.mark.parametrize('branch', [100, BRANCH_SAMPLES])  # by find_split, or in a branch
@pytest.mark.parametrize('always', [1, 2])
def test_last_features_are_tried_at_every_node(always, branch, monkeypatch):
    """Only they separate the samples; a node tries one of 300 others."""
    monkeypatch.setattr('lsc_pose_ros.training.tree_growth.BRANCH_SAMPLES', branch)
    rng = np.random.default_rng(always)
    corner = rng.integers(0, 4, 1600)
    quantised = rng.integers(0, 256, (302, 1600)).astype(np.uint8)
    # The first bit and the second bit of the group; a single feature has both.
    quantised[-1] = 60 * corner if always == 1 else 100 * (corner // 2)
    quantised[-2] = 100 * (corner % 2) if always == 2 else 0
    statistics = sparse(np.eye(4)[corner][..., None])
    settings = GrowthSettings(depth=2, features=1, always=always)
    tree = grow_tree(quantised, statistics, settings, np.random.default_rng(0))
    assert set(tree.feature.tolist()) == {-1, *range(302 - always, 302)}
    corners = [set(corner[leaf]) for leaf in np.split(tree.order, tree.leaf_start[1:-1])]
    assert sorted(corners) == [{0}, {1}, {2}, {3}]


@pytest.mark.parametrize('branch', [100, BRANCH_SAMPLES])
def test_beside_the_last_features_others_are_drawn(branch, monkeypatch):
    monkeypatch.setattr('lsc_pose_ros.training.tree_growth.BRANCH_SAMPLES', branch)
    rng = np.random.default_rng(0)
    quantised, weights = random_samples(0, 2000)
    quantised[-2:] = 7  # constant, so they split nothing
    settings = GrowthSettings(features=3, leaf_samples=10, always=2)
    tree = grow_tree(quantised, sparse(weights[..., None]), settings, rng)
    used = np.unique(tree.feature[tree.feature >= 0])
    assert len(used) > 30
    assert used.max() < 358


@pytest.mark.parametrize('branch', [100, BRANCH_SAMPLES])
def test_all_features_can_be_tried_always(branch, monkeypatch):
    monkeypatch.setattr('lsc_pose_ros.training.tree_growth.BRANCH_SAMPLES', branch)
    rng = np.random.default_rng(0)
    weights = rng.dirichlet(np.ones(4), 500).astype(np.float32)
    quantised = rng.integers(0, 256, (2, 500), np.uint8)
    settings = GrowthSettings(depth=3, always=2)
    tree = grow_tree(quantised, sparse(weights[..., None]), settings, rng)
    assert set(tree.feature.tolist()) <= {-1, 0, 1}
    assert len(tree.leaf_start) > 3


def walk(tree, node=0, depth=0):
    """Yield the number and the depth of each leaf."""
    if tree.feature[node] < 0:
        yield int(tree.left[node]), depth
    else:
        yield from walk(tree, tree.left[node], depth + 1)
        yield from walk(tree, tree.left[node] + 1, depth + 1)


@pytest.mark.parametrize('settings', [GrowthSettings(depth=4), GrowthSettings(leaf_samples=7)])
@pytest.mark.parametrize('branch', [100, BRANCH_SAMPLES])  # with a trunk, or in one branch
def test_tree_sorts_every_sample_into_the_leaf_that_its_splits_lead_to(
    settings, branch, monkeypatch
):
    monkeypatch.setattr('lsc_pose_ros.training.tree_growth.BRANCH_SAMPLES', branch)
    quantised, weights = random_samples(2, 500)
    tree = grow_tree(quantised, sparse(weights[..., None]), settings, np.random.default_rng(0))
    assert (tree.left[tree.feature >= 0] > np.flatnonzero(tree.feature >= 0)).all()
    sizes = np.diff(tree.leaf_start)
    assert sorted(tree.order.tolist()) == list(range(500))
    assert len(sizes) > 5
    assert sizes.min() >= settings.leaf_samples
    depths = dict(walk(tree))
    assert sorted(depths) == list(range(len(sizes)))
    assert max(depths.values()) <= settings.depth
    for leaf, (start, end) in enumerate(itertools.pairwise(tree.leaf_start)):
        for sample in tree.order[start:end]:
            node = 0
            while tree.feature[node] >= 0:
                right = quantised[tree.feature[node], sample] >= tree.threshold[node]
                node = tree.left[node] + int(right)
            assert tree.left[node] == leaf


def test_growth_is_repeatable_and_the_seed_matters(monkeypatch):
    monkeypatch.setattr('lsc_pose_ros.training.tree_growth.BRANCH_SAMPLES', 200)
    quantised, weights = random_samples(3, 500)
    settings = GrowthSettings(leaf_samples=10)
    first, again, other = (
        grow_tree(quantised, sparse(weights[..., None]), settings, np.random.default_rng(seed))
        for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first.feature, again.feature)
    np.testing.assert_array_equal(first.threshold, again.threshold)
    assert first.feature.tolist() != other.feature.tolist()


def test_too_few_samples_make_a_single_leaf():
    quantised, weights = random_samples(4, 15)
    tree = grow_tree(
        quantised, sparse(weights[..., None]), GrowthSettings(), np.random.default_rng(0)
    )
    assert tree.feature.tolist() == [-1]
    assert tree.leaf_start.tolist() == [0, 15]
