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

"""Depth images in grey."""

import io
import itertools

import numpy as np
import pytest
from PIL import Image
from two_bodies import frame

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.viz.drawing.canvas import house_style, new_figure, png_bytes
from lsc_pose_ros.viz.drawing.crop import Box
from lsc_pose_ros.viz.drawing.depth_image import draw_depth, greys


def test_greys_show_near_lighter_the_scene_faint_and_nothing_white() -> None:
    image = greys(frame())
    near, far, wall, nothing = image[30, 15], image[30, 65], image[30, 40], image[0, 0]
    assert far < near < wall < nothing == 1


@house_style()
def test_picture_has_no_line_but_what_is_beyond_the_image_is_grey() -> None:
    figure = new_figure(2, 2)
    axes = figure.subplots()
    draw_depth(axes, frame(), Box(-0.5, -20.5, 99.5, 79.5))
    with Image.open(io.BytesIO(png_bytes(figure))) as image:
        column = np.array(image.convert('L'))[10:-10, 100].tolist()
    # Beyond the image, its first row without depth, and the wall.
    runs = [grey for grey, _ in itertools.groupby(column)]
    assert runs[0] == 0xC8
    assert runs[-1] == column[-1]
    assert 0xC8 not in runs[1:]
    # One pixel between two greys may have something of both.
    assert len(runs) <= 5


def test_greys_of_one_body_leave_the_other_faint() -> None:
    image = greys(frame(), 7)
    assert image[30, 65] < 0.89
    assert image[30, 15] > 0.895


def test_without_a_mask_the_whole_scene_is_clear() -> None:
    unmasked = frame()._replace(labels=np.full((80, 100), NO_BODY, np.int32))
    image = greys(unmasked)
    assert image[30, 40] == pytest.approx(0.5)
    assert image[0, 0] == 1


def test_image_without_any_depth_is_white() -> None:
    blind = frame()._replace(depth=np.zeros((80, 100), np.float32))
    assert (greys(blind) == 1).all()
