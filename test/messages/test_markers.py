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

"""Skeletons as shapes to draw."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.messages.markers import MarkerUpdater, skeleton_markers
from lsc_pose_ros.settings.table import DrawingSettings

EDGES = np.array([[0, 1], [1, 2]], np.int32)


@pytest.fixture
def skeletons():
    positions = np.arange(18, dtype=np.float32).reshape(2, 3, 3)
    positions[1, 2] = np.nan
    confidence = np.array([[1.0, 0.5, 0.0], [0.9, 0.8, 0.0]], np.float32)
    return Skeletons(
        np.array([3, 7], np.uint16), np.array([0, 1, 4], np.uint16), positions, confidence
    )


def test_each_body_has_its_joints_and_its_bones(skeletons):
    shapes = skeleton_markers(skeletons, EDGES)
    assert [(s.identifier, s.kind, s.action, len(s.points)) for s in shapes] == [
        (3, 'spheres', 'add', 3),
        (3, 'lines', 'add', 4),
        (7, 'spheres', 'add', 2),
        (7, 'lines', 'add', 2),
    ]
    assert np.array_equal(shapes[1].points, skeletons.positions[0][[0, 1, 1, 2]])
    assert all(s.colours.shape == (len(s.points), 4) and s.lifetime_ns > 0 for s in shapes)
    assert all(np.isfinite(s.points).all() for s in shapes)


def test_names_are_unique_and_colours_tell_bodies_apart(skeletons):
    shapes = skeleton_markers(skeletons, EDGES)
    assert len({(s.namespace, s.identifier) for s in shapes}) == len(shapes)
    assert not np.array_equal(shapes[0].colours[0, :3], shapes[2].colours[0, :3])


def test_joints_with_less_confidence_are_fainter(skeletons):
    alpha = skeleton_markers(skeletons, EDGES)[0].colours[:, 3]
    assert alpha[0] == pytest.approx(1)
    assert alpha[0] > alpha[1] > alpha[2] > 0


def test_unsure_joints_and_their_bones_are_left_out(skeletons):
    shapes = skeleton_markers(skeletons, EDGES, minimum_confidence=0.4)
    assert [len(s.points) for s in shapes] == [2, 2, 2, 2]
    nothing = skeleton_markers(skeletons, EDGES, minimum_confidence=2.0)
    assert {s.action for s in nothing} == {'delete'}


def test_bodies_that_left_are_deleted(skeletons):
    shapes = skeleton_markers(skeletons, EDGES, gone={5})
    deleted = [s for s in shapes if s.action == 'delete']
    assert {(s.namespace, s.identifier) for s in deleted} == {('joints', 5), ('bones', 5)}
    drawn = {s.namespace for s in shapes if s.action == 'add'}
    assert {s.namespace for s in deleted} == drawn


def test_skeleton_without_bones(skeletons):
    shapes = skeleton_markers(skeletons, np.zeros((0, 2), np.int32))
    assert [s.action for s in shapes] == ['add', 'delete', 'add', 'delete']


def of_bodies(skeletons, *rows):
    return skeletons._replace(
        bodies=skeletons.bodies[list(rows)],
        positions=skeletons.positions[list(rows)],
        confidence=skeletons.confidence[list(rows)],
    )


def test_drawing_deletes_each_body_that_left_once(skeletons):
    marker_updater = MarkerUpdater(EDGES)
    told = [
        {(s.identifier, s.action) for s in marker_updater.update(each, DrawingSettings())}
        for each in (
            skeletons,
            of_bodies(skeletons, 1),
            of_bodies(skeletons),
            of_bodies(skeletons),
            of_bodies(skeletons, 0),
        )
    ]
    both = {(3, 'add'), (7, 'add')}
    assert told == [both, {(3, 'delete'), (7, 'add')}, {(7, 'delete')}, set(), {(3, 'add')}]


def test_style_of_the_markers(skeletons):
    style = DrawingSettings(minimum_confidence=0.4, marker_lifetime=1.5)
    shapes = MarkerUpdater(EDGES).update(skeletons, style)
    assert [len(s.points) for s in shapes] == [2, 2, 2, 2]
    assert {s.lifetime_ns for s in shapes} == {1_500_000_000}
