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

"""Forests packed for a model file keep their trees, and their votes within half a step."""

import numpy as np
import pytest

from lsc_pose_ros.model_io.forest_packing import ARRAYS, pack_forest, unpack_forest
from lsc_pose_ros.model_io.unusable_model import UnusableModelError
from lsc_pose_ros.pose.forest.forest import Forest, LeafVotes, find_leaves

FEATURES, TARGETS = 12, 5


def random_votes(rng, leaves, most=4, reach=0.3, heaviest=1.0):
    count = rng.integers(0, most, leaves)
    start = np.concatenate([[0], np.cumsum(count)]).astype(np.int32)
    total = int(start[-1])
    return LeafVotes(
        start,
        rng.integers(0, TARGETS, total).astype(np.uint8),
        rng.uniform(-reach, reach, (total, 3)).astype(np.float32),
        rng.uniform(0, heaviest, total).astype(np.float32),
    )


def random_forest(rng, splits, **votes):
    """Return trees with these numbers of splits; nodes in the order of their growth."""
    feature, threshold, left, roots = [], [], [], []
    for count in splits:
        roots.append(len(feature))
        free = [len(feature)]
        feature, threshold, left = [*feature, -1], [*threshold, 0], [*left, 0]
        for _ in range(count):
            node = free.pop(int(rng.integers(len(free))))
            feature[node] = int(rng.integers(FEATURES))
            threshold[node] = int(rng.integers(256))
            left[node] = len(feature)
            free += [len(feature), len(feature) + 1]
            feature, threshold, left = [*feature, -1, -1], [*threshold, 0, 0], [*left, 0, 0]
    nodes = np.array(feature, np.int16)
    children = np.array(left, np.int32)
    leaves = int((nodes < 0).sum())
    children[nodes < 0] = rng.permutation(leaves)
    return Forest(
        np.array(roots, np.int32),
        nodes,
        np.array(threshold, np.uint8),
        children,
        random_votes(rng, leaves, **votes),
        random_votes(rng, leaves, **votes),
    )


def votes_of(votes, leaf):
    """Return the votes of a leaf, ordered by target."""
    rows = np.arange(votes.start[leaf], votes.start[leaf + 1])
    rows = rows[np.argsort(votes.target[rows], kind='stable')]
    return votes.target[rows], votes.offset[rows], votes.weight[rows]


@pytest.mark.parametrize('splits', [[0], [1], [0, 3, 0], [40, 7], [300, 250, 280]])
def test_points_find_the_same_votes_in_the_same_order(splits):
    rng = np.random.default_rng(len(splits))
    forest = random_forest(rng, splits)
    again = unpack_forest(pack_forest(forest))
    quantised = rng.integers(0, 256, (200, FEATURES)).astype(np.uint8)
    for one, two in zip(
        find_leaves(forest, quantised).ravel(), find_leaves(again, quantised).ravel(), strict=True
    ):
        for name, step in (('joint_votes', 0.02), ('pair_votes', 0.04)):
            before, after = getattr(forest, name), getattr(again, name)
            first, last = before.start[one], after.start[two]
            count = before.start[one + 1] - first
            assert after.start[two + 1] - last == count
            here, there = slice(first, first + count), slice(last, last + count)
            np.testing.assert_array_equal(after.target[there], before.target[here])
            assert np.abs(after.offset[there] - before.offset[here]).max(initial=0) <= step * 0.501
            assert (np.abs(after.weight[there] - before.weight[here]) <= 1 / 15).all()
            assert (after.weight[there] > 0).all()


def test_arrays_have_the_documented_forms():
    packed = pack_forest(random_forest(np.random.default_rng(1), [20, 30]))
    assert packed.keys() == ARRAYS.keys()
    for name, (kind, dimensions) in ARRAYS.items():
        assert packed[name].dtype == kind
        assert packed[name].ndim == dimensions
    again = unpack_forest(packed)
    reference = random_forest(np.random.default_rng(1), [20, 30])
    for name in ('roots', 'feature', 'threshold', 'left'):
        assert getattr(again, name).dtype == getattr(reference, name).dtype
    for name in LeafVotes._fields:
        one, two = getattr(again.joint_votes, name), getattr(reference.joint_votes, name)
        assert one.dtype == two.dtype
        assert one.flags.c_contiguous


@pytest.mark.parametrize(('reach', 'heaviest'), [(0.3, 1.0), (2.6, 30.0), (40.0, 5000.0), (0, 0)])
def test_steps_grow_with_the_largest_value_and_packing_again_changes_nothing(reach, heaviest):
    forest = random_forest(np.random.default_rng(2), [60, 70], reach=reach, heaviest=heaviest)
    packed = pack_forest(forest)
    twice = pack_forest(unpack_forest(packed))
    for name, part in packed.items():
        np.testing.assert_array_equal(part, twice[name])
    offset_step, weight_step = packed['pair_steps']
    assert reach / 127 <= offset_step <= max(0.0401, 2.01 * reach / 127)
    assert heaviest / 256 <= weight_step <= max(0.067, 2.02 * heaviest / 255)


def test_nodes_are_ordered_by_level():
    """Compare with a breadth-first walk through the tree."""
    forest = random_forest(np.random.default_rng(3), [50])
    queue, features = [0], []
    for node in queue:
        features.append(forest.feature[node])
        if forest.feature[node] >= 0:
            queue += [forest.left[node], forest.left[node] + 1]
    np.testing.assert_array_equal(pack_forest(forest)['feature'], features)


def test_votes_are_ordered_by_target():
    forest = random_forest(np.random.default_rng(4), [9])
    packed = pack_forest(forest)
    votes = unpack_forest(packed).joint_votes
    rows = [row for target in range(TARGETS) for row in np.flatnonzero(votes.target == target)]
    np.testing.assert_array_equal(
        packed['joint_offset'] * packed['joint_steps'][0], votes.offset[rows].T
    )


def test_arrays_that_do_not_fit_are_refused():
    packed = pack_forest(random_forest(np.random.default_rng(5), [9, 4]))
    with pytest.raises(UnusableModelError, match='trees are incomplete'):
        unpack_forest(packed | {'nodes': packed['nodes'] + 2})
    with pytest.raises(UnusableModelError, match='thresholds do not fit'):
        unpack_forest(packed | {'threshold': packed['threshold'][1:]})
    with pytest.raises(UnusableModelError, match='votes do not fit'):
        unpack_forest(packed | {'pair_weight': packed['pair_weight'][1:]})
    with pytest.raises(UnusableModelError, match='steps'):
        unpack_forest(packed | {'pair_steps': np.array([-0.04, 1 / 15], np.float32)})
