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

"""Boxes around bodies."""

import numpy as np
import pytest
from two_bodies import frame

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.viz.drawing.crop import Box, box_around


def centre(box: Box) -> tuple[float, float]:
    return (box.left + box.right) / 2, (box.top + box.bottom) / 2


@pytest.mark.parametrize('aspect', [0.5, 0.8, 1.5])
def test_box_has_the_aspect_and_holds_the_body_in_its_middle(aspect: float) -> None:
    box = box_around(frame(), 7, aspect)
    assert (box.right - box.left) / (box.bottom - box.top) == pytest.approx(aspect)
    assert centre(box) == (64.5, 34.5)
    assert box.left < 60
    assert box.right > 69
    assert box.top < 20
    assert box.bottom > 49


def test_box_is_moved_into_the_image() -> None:
    """Around the middle of the body, it would end 2 pixels beyond the right border."""
    box = box_around(frame(), 7, 2.0)
    assert box == Box(25.5, 16.0, 99.5, 53.0)


def test_box_that_is_larger_than_the_image_keeps_the_body_in_its_middle() -> None:
    assert centre(box_around(frame(), 7, 3.0)) == (64.5, 34.5)


def test_box_goes_beyond_the_image_for_joints() -> None:
    positions = np.array([[[1.2, 0.0, 2.0]]], np.float32)  # column 110 of 100
    joints = np.array([0], np.uint16)
    truth = Skeletons(np.array([7], np.uint16), joints, positions, np.ones((1, 1), np.float32))
    assert box_around(frame(truth), 7).right > 110


def test_without_a_body_named_the_box_holds_all() -> None:
    box = box_around(frame())
    assert box.left < 10
    assert box.right > 69


def test_true_joints_widen_the_box_and_unlabelled_ones_do_not() -> None:
    positions = np.full((1, 2, 3), np.nan, np.float32)
    positions[0, 0] = 0.8, 0.0, 2.0  # column 90
    ground_truth = Skeletons(
        np.array([7], np.uint16),
        np.array([0, 1], np.uint16),
        positions,
        np.ones((1, 2), np.float32),
    )
    assert box_around(frame(ground_truth), 7).right > 90
    assert box_around(frame(ground_truth), 1).right < 60


def test_without_bodies_the_box_is_the_image() -> None:
    empty = frame()._replace(labels=np.full((80, 100), NO_BODY, np.int32))
    assert box_around(empty) == Box(-0.5, -0.5, 99.5, 79.5)
