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

import numpy as np
import pytest

from lsc_pose_ros.training.leaves import (
    LeafSettings,
    fit_joint_votes,
    fit_pair_votes,
    largest_clusters,
)
from lsc_pose_ros.training.samples import Samples
from lsc_pose_ros.training.tree_growth import Tree

SETTINGS = LeafSettings()


def clusters_twin(offsets, bandwidth, wanted):
    """Mean-shift from every offset, then groups of arrivals, the largest first."""
    offsets = offsets.astype(float)
    centres, sizes = [], []
    for position in offsets:
        for _ in range(500):
            pull = np.exp(-((offsets - position) ** 2).sum(axis=1) / bandwidth**2)
            position = (pull[:, None] * offsets).sum(axis=0) / pull.sum()  # noqa: PLW2901
        near = [k for k, c in enumerate(centres) if np.linalg.norm(c - position) <= bandwidth / 2]
        if near:
            sizes[near[0]] += 1
        else:
            centres.append(position)
            sizes.append(1)
    order = sorted(range(len(sizes)), key=lambda k: -sizes[k])[:wanted]
    return np.array(centres)[order], np.array(sizes)[order]


@pytest.mark.parametrize('seed', range(6))
def test_clusters_of_random_offsets(seed):
    rng = np.random.default_rng(seed)
    centres = np.array([[0, 0, 0], [0.4, 0, 0], [0, 0.5, 0.1]])
    which = rng.choice(3, 60, p=[0.6, 0.3, 0.1])
    offsets = (centres[which] + rng.normal(0, 0.02, (60, 3))).astype(np.float32)
    found, sizes = largest_clusters(offsets, SETTINGS)
    expected, counts = clusters_twin(offsets, SETTINGS.bandwidth, SETTINGS.clusters)
    np.testing.assert_allclose(found, expected, atol=1e-3)
    np.testing.assert_array_equal(sizes, counts)


def test_equal_offsets_are_one_cluster():
    found, sizes = largest_clusters(np.full((25, 3), 0.2, np.float32), SETTINGS)
    np.testing.assert_allclose(found, [[0.2, 0.2, 0.2]], atol=1e-6)
    assert sizes.tolist() == [25]


def test_large_leaf_is_thinned_but_keeps_its_weight():
    offsets = np.random.default_rng(0).normal(0, 0.01, (1000, 3)).astype(np.float32)
    found, sizes = largest_clusters(offsets, SETTINGS)
    np.testing.assert_allclose(found[0], 0, atol=0.01)
    assert sizes[0] == pytest.approx(1000)


def two_leaves():
    """Three people with two joints each; leaf 0 holds points near joint 0, leaf 1 near joint 1."""
    rng = np.random.default_rng(0)
    joints = np.zeros((3, 2, 3), np.float32)
    joints[:, 1, 0] = 0.8
    points = rng.normal(0, 0.01, (60, 3)).astype(np.float32)
    points[30:, 0] += np.float32(0.8)
    person = np.tile(np.arange(3, dtype=np.int32), 20)
    samples = Samples(
        np.zeros((360, 60), np.uint8), points, person, joints, np.ones(3, np.float32)
    )
    tree = Tree(
        np.array([0, -1, -1], np.int16),
        np.array([1, 0, 0], np.uint8),
        np.array([1, 0, 1], np.int32),
        np.arange(60, dtype=np.int32),
        np.array([0, 30, 60]),
    )
    return samples, tree


def test_leaf_votes_only_for_joints_in_reach():
    samples, tree = two_leaves()
    votes = fit_joint_votes(samples, tree, SETTINGS)
    assert votes.start.tolist() == [0, 1, 2]
    assert votes.target.tolist() == [0, 1]
    np.testing.assert_allclose(votes.offset, 0, atol=0.01)
    np.testing.assert_allclose(votes.weight, 1)


def test_pair_votes_are_limbs_in_units_of_rho_bar():
    samples, tree = two_leaves()
    edges = np.array([[0, 1]], np.int32)
    votes = fit_pair_votes(samples, tree, edges, SETTINGS)
    assert votes.target.tolist() == [0, 0]
    np.testing.assert_allclose(votes.offset, [[0.8, 0, 0]] * 2, atol=1e-6)
    near = SETTINGS._replace(pair_reach=0.001)
    assert len(fit_pair_votes(samples, tree, edges, near).target) == 0


def test_weight_is_the_fraction_of_the_leaf_and_unlabelled_joints_have_none():
    samples, tree = two_leaves()
    samples.joints[0, 0] = np.nan  # one person of three
    votes = fit_joint_votes(samples, tree, SETTINGS)
    assert votes.weight[votes.target == 0].tolist() == pytest.approx([2 / 3])
    samples.joints[:, 0] = np.nan
    assert fit_joint_votes(samples, tree, SETTINGS).target.tolist() == [1]


def test_small_clusters_of_pairs_are_not_kept():
    samples, tree = two_leaves()
    joints = samples.joints.copy()
    joints[2, 1] = (0, 0.8, 0)  # the third person's limb points elsewhere: a third of each leaf
    samples = samples._replace(joints=joints)
    edges = np.array([[0, 1]], np.int32)
    kept = {
        fraction: fit_pair_votes(samples, tree, edges, SETTINGS._replace(pair_fraction=fraction))
        for fraction in (0.0, 0.3, 0.4)
    }
    np.testing.assert_allclose(kept[0.0].weight[:2], [2 / 3, 1 / 3], atol=1e-6)
    for ours, expected in zip(kept[0.3], kept[0.0], strict=True):
        np.testing.assert_array_equal(ours, expected)
    np.testing.assert_allclose(kept[0.4].weight[0], 2 / 3, atol=1e-6)
    assert kept[0.4].start[1] == 1


def test_small_clusters_of_joints_are_not_kept():
    samples, tree = two_leaves()
    joints = samples.joints.copy()
    joints[2, 0] = (0, 0.2, 0)  # the third person's joint lies elsewhere: a third of its leaf
    samples = samples._replace(joints=joints)
    kept = {
        fraction: fit_joint_votes(samples, tree, SETTINGS._replace(joint_fraction=fraction))
        for fraction in (0.0, 0.3, 0.4)
    }
    np.testing.assert_allclose(kept[0.0].weight[:2], [2 / 3, 1 / 3], atol=1e-6)
    for ours, expected in zip(kept[0.3], kept[0.0], strict=True):
        np.testing.assert_array_equal(ours, expected)
    np.testing.assert_allclose(kept[0.4].weight[0], 2 / 3, atol=1e-6)
    assert kept[0.4].start.tolist() == [0, 1, 2]


def test_modes_farther_apart_than_half_a_bandwidth_are_two_clusters():
    """Two groups of offsets, 1.5 bandwidths apart, have modes 0.8 bandwidths apart.

    The modes are at +-x with x = a tanh(2 a x / h^2), a = 0.75 h: x = 0.405 h. A climb stops
    when it is nearly flat, a little before.
    """
    bandwidth = SETTINGS.bandwidth
    offsets = np.zeros((20, 3), np.float32)
    offsets[:10, 0] = -0.75 * bandwidth
    offsets[10:, 0] = 0.75 * bandwidth
    found, sizes = largest_clusters(offsets, SETTINGS)
    assert sizes.tolist() == [10, 10]
    np.testing.assert_allclose(
        found, np.array([[-0.405, 0, 0], [0.405, 0, 0]]) * bandwidth, atol=0.05 * bandwidth
    )
