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

"""The numbers and names of the joints and the trees that connect them."""

import pytest

from lsc_pose_ros.data_types.joints import (
    DEFAULT_JOINTS,
    JOINT_NAMES,
    JOINT_NUMBERS,
    default_edges,
    drawn_edges,
    leg_pairs,
    names_of,
    numbers_of,
)
from lsc_pose_ros.errors import InputError


def test_joints_have_their_published_numbers():
    assert [JOINT_NUMBERS[name] for name in ('head', 'neck', 'torso', 'pelvis')] == [0, 1, 2, 3]
    assert names_of(range(4, 12)) == [
        f'l_{part}'
        for part in ('shoulder', 'elbow', 'wrist', 'hand', 'hip', 'knee', 'ankle', 'foot')
    ]
    assert names_of(range(12, 20)) == [
        name.replace('l_', 'r_', 1) for name in names_of(range(4, 12))
    ]
    assert len(DEFAULT_JOINTS) == 17


def named_edges(names):
    numbers = numbers_of(names)
    return {tuple(names_of(numbers[edge])) for edge in default_edges(numbers)}


def test_drawn_edges_connect_the_trunk_and_the_pelvis():
    def spine(names):
        numbers = numbers_of(names)
        kept = {tuple(edge) for edge in default_edges(numbers).tolist()}
        drawn = {tuple(edge) for edge in drawn_edges(numbers).tolist()}
        return {tuple(names_of(numbers[list(edge)])) for edge in drawn - kept}

    assert spine(JOINT_NAMES) == {('torso', 'pelvis')}
    assert spine(['neck', 'pelvis', 'l_hip']) == {('neck', 'pelvis')}
    assert spine(DEFAULT_JOINTS) == set()
    assert spine(['pelvis', 'l_hip']) == set()


def test_default_edges_form_two_trees():
    edges = default_edges(range(20))
    assert len(edges) == 18
    assert {0, 3, 1} - set(edges[:, 1].tolist()) == {1, 3}  # only neck and pelvis have no parent
    parents_first = [parent in {1, 3, *edges[:n, 1]} for n, (parent, _) in enumerate(edges)]
    assert all(parents_first)


def test_without_pelvis_the_hips_are_connected():
    edges = named_edges(DEFAULT_JOINTS)
    assert ('l_hip', 'r_hip') in edges
    assert ('l_hip', 'l_knee') in edges
    assert len(edges) == 15


def test_missing_joint_is_bridged():
    assert ('l_shoulder', 'l_hand') in named_edges(['neck', 'l_shoulder', 'l_hand'])
    assert named_edges(['head', 'l_foot']) == set()
    assert named_edges(['l_hand', 'r_hand', 'head']) == {('head', 'l_hand'), ('head', 'r_hand')}


def test_legs_are_paired_if_both_sides_are_known():
    numbers = numbers_of(['head', 'l_hip', 'r_hip', 'l_knee', 'r_knee', 'l_ankle', 'r_foot'])
    names = names_of(numbers)
    assert [(names[left], names[right]) for left, right in leg_pairs(numbers)] == [
        ('l_knee', 'r_knee')
    ]
    assert leg_pairs(range(20)).tolist() == [[9, 17], [10, 18], [11, 19]]
    assert leg_pairs(numbers_of(['head'])).shape == (0, 2)


def test_numbers_are_sorted_and_unknown_names_are_refused():
    assert numbers_of(['r_foot', 'head', 'head']).tolist() == [0, 19]
    with pytest.raises(InputError, match='unknown joint elbow; the joints are head'):
        numbers_of(['head', 'elbow'])
    with pytest.raises(InputError, match='name at least one'):
        numbers_of([])
    assert names_of(numbers_of(JOINT_NAMES)) == list(JOINT_NAMES)
