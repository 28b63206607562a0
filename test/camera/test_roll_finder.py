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

"""The roll of a camera by the tree of frames."""

import numpy as np
import pytest
from rolled_frame import ROLLS, mounting

from lsc_pose_ros.camera.roll_finder import RollFinder
from lsc_pose_ros.camera.transform_tree import FrameTransform, Rotation, TransformTree

OPTICAL = 'camera_depth_optical_frame'
LEVEL = Rotation(0, 0, 0, 1)


def finder_with(transforms: list[FrameTransform], gravity_frame: str = '') -> RollFinder:
    finder = RollFinder(None, gravity_frame)
    for each in transforms:
        finder.tree.add(each)
    return finder


@pytest.mark.parametrize('roll', ROLLS)
@pytest.mark.parametrize('pitch', [-50.0, 0.0, 30.0])
@pytest.mark.parametrize('slant', [-20.0, 0.0, 20.0])
def test_roll_is_that_of_the_mounting(roll: int, pitch: float, slant: float) -> None:
    finder = finder_with(mounting(OPTICAL, roll + slant, pitch))
    assert finder.find(OPTICAL) == roll
    expected = f'camera_roll auto: {roll}, by the transform from {OPTICAL} to base_link'
    assert finder.choice == expected
    assert finder.warning == ''
    assert finder.way == (OPTICAL, 'camera_link', 'base_link')


@pytest.mark.parametrize(('roll', 'pitch'), [(45, 0), (135, 10), (0, 88), (90, -85)])
def test_ambiguous_roll_is_a_warning_and_keeps_the_last(roll: float, pitch: float) -> None:
    finder = finder_with(mounting(OPTICAL, 180))
    assert finder.find(OPTICAL) == 180
    for each in mounting(OPTICAL, roll, pitch):
        finder.tree.add(each)
    assert finder.find(OPTICAL) == 180
    assert 'Set camera_roll' in finder.warning


def test_without_a_way_to_gravity_it_is_0() -> None:
    finder = RollFinder(None)
    assert finder.find(OPTICAL) == 0
    assert 'no transform from camera_depth_optical_frame to a gravity-aligned' in finder.choice
    finder.tree.add(mounting(OPTICAL, 90)[1])  # from camera_link only
    assert finder.find(OPTICAL) == 0
    finder.tree.add(mounting(OPTICAL, 90)[0])
    assert finder.find(OPTICAL) == 90


def test_prefixes_and_leading_slashes_are_understood() -> None:
    transforms = [
        FrameTransform(f'/robot1/{each.parent}', f'robot1/{each.child}', each.rotation)
        for each in mounting(OPTICAL, 270)
    ]
    assert finder_with(transforms).find(f'/robot1/{OPTICAL}') == 270


def test_only_the_given_gravity_frame_counts() -> None:
    transforms = [
        FrameTransform('ceiling', 'base_link', Rotation(1, 0, 0, 0)),
        *mounting(OPTICAL, 0),
    ]
    assert finder_with(transforms).find(OPTICAL) == 0
    assert finder_with(transforms, '/ceiling').find(OPTICAL) == 180
    other = finder_with(transforms, 'floor')
    assert other.find(OPTICAL) == 0
    assert 'no transform' in other.choice


@pytest.mark.parametrize('roll', ROLLS)
def test_given_roll_needs_no_transforms(roll: int) -> None:
    finder = RollFinder(roll)
    for each in mounting(OPTICAL, 90):
        finder.tree.add(each)
    assert finder.find(OPTICAL) == roll
    assert finder.choice == f'camera_roll {roll}'


def test_cycles_and_useless_quaternions_do_no_harm() -> None:
    tree = TransformTree()
    tree.add(FrameTransform('a', 'b', Rotation(0, 0, 0, 0)))
    tree.add(FrameTransform('b', 'a', Rotation(float('nan'), 0, 0, 1)))
    rotations = [rotation for _, rotation in tree.ancestors('a')]
    assert len(rotations) == 100
    np.testing.assert_array_equal(rotations[-1], np.eye(3))


def test_version_counts_changes_only() -> None:
    tree = TransformTree()
    tree.add(FrameTransform('a', 'b', LEVEL))
    tree.add(FrameTransform('/a', '/b', LEVEL))
    assert tree.version == 1
    tree.add(FrameTransform('c', 'b', LEVEL))
    assert tree.version == 2
