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

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.viz.drawing.crop import Box, box_around
from lsc_pose_ros.viz.drawing.depth_image import greys

CAMERA = Intrinsics(100.0, 100.0, 50.0, 40.0)


def frame(ground_truth: Skeletons | None = None) -> Frame:
    """Two bodies of 10 x 20 and 10 x 30 pixels before a wall."""
    depth = np.full((80, 100), 5.0, np.float32)
    labels = np.full((80, 100), NO_BODY, np.int32)
    depth[20:40, 10:20], labels[20:40, 10:20] = 2.0, 1
    depth[20:50, 60:70], labels[20:50, 60:70] = 3.0, 7
    depth[0] = 0
    return Frame(0, '', depth, labels, CAMERA, ground_truth)


def centre(box: Box) -> tuple[float, float]:
    return (box.left + box.right) / 2, (box.top + box.bottom) / 2


@pytest.mark.parametrize('aspect', [0.5, 0.8, 2.0])
def test_the_box_has_the_aspect_and_holds_the_body_in_its_middle(aspect: float) -> None:
    box = box_around(frame(), 7, aspect)
    assert (box.right - box.left) / (box.bottom - box.top) == pytest.approx(aspect)
    assert centre(box) == (64.5, 34.5)
    assert box.left < 60
    assert box.right > 69
    assert box.top < 20
    assert box.bottom > 49


def test_without_a_body_named_the_box_holds_all() -> None:
    box = box_around(frame())
    assert box.left < 10
    assert box.right > 69


def test_true_joints_widen_the_box_and_unlabelled_ones_do_not() -> None:
    places = np.full((1, 2, 3), np.nan, np.float32)
    places[0, 0] = 0.8, 0.0, 2.0  # column 90
    ground_truth = Skeletons(
        np.array([7], np.uint16),
        np.array([0, 1], np.uint16),
        places,
        np.ones((1, 2), np.float32),
    )
    assert box_around(frame(ground_truth), 7).right > 90
    assert box_around(frame(ground_truth), 1).right < 60


def test_without_bodies_the_box_is_the_image() -> None:
    empty = frame()._replace(labels=np.full((80, 100), NO_BODY, np.int32))
    assert box_around(empty) == Box(-0.5, -0.5, 99.5, 79.5)


def test_greys_show_near_lighter_the_scene_faint_and_nothing_white() -> None:
    image = greys(frame())
    near, far, wall, nothing = image[30, 15], image[30, 65], image[30, 40], image[0, 0]
    assert far < near < wall < nothing == 1


def test_greys_of_one_body_leave_the_other_faint() -> None:
    image = greys(frame(), 7)
    assert image[30, 65] < 0.89
    assert image[30, 15] > 0.895


def test_without_a_mask_the_whole_scene_is_clear() -> None:
    unmasked = frame()._replace(labels=np.full((80, 100), NO_BODY, np.int32))
    image = greys(unmasked)
    assert image[30, 40] == pytest.approx(0.5)
    assert image[0, 0] == 1


def test_an_image_without_any_depth_is_white() -> None:
    blind = frame()._replace(depth=np.zeros((80, 100), np.float32))
    assert (greys(blind) == 1).all()
