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

"""The contact sheet."""

import io

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from numpy.typing import NDArray
from PIL import Image

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.viz.drawing.canvas import png_bytes
from lsc_pose_ros.viz.drawing.colours import EDGE, GROUND_TRUTH, LEFT, RIGHT
from lsc_pose_ros.viz.report.contact_sheet import contact_sheet
from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame


def pixels(frames: list[DrawnFrame]) -> NDArray[np.uint8]:
    """The sheet's pixels above its legend, shape (rows, columns, 3)."""
    data = png_bytes(contact_sheet(frames, 'a title'))
    with Image.open(io.BytesIO(data)) as image:
        return np.asarray(image.convert('RGB'))[:-40]


def count(image: NDArray[np.uint8], colour: str) -> int:
    wanted = np.round(255 * np.array(to_rgb(colour)))
    return int((np.abs(image - wanted).max(axis=-1) < 8).sum())


def test_estimate_ground_truth_and_silhouette_have_their_colours(
    drawn: list[DrawnFrame],
) -> None:
    image = pixels(drawn[:1])
    assert min(count(image, colour) for colour in (GROUND_TRUTH, LEFT, RIGHT, EDGE)) > 10


def test_without_an_estimate_the_ground_truth_has_the_colours_of_the_sides(
    drawn: list[DrawnFrame],
) -> None:
    image = pixels([drawn[0]._replace(estimate=None)])
    assert count(image, GROUND_TRUTH) == 0
    assert min(count(image, LEFT), count(image, RIGHT)) > 10


def test_without_ground_truth_only_the_estimate_is_drawn(drawn: list[DrawnFrame]) -> None:
    image = pixels([drawn[0]._replace(frame=drawn[0].frame._replace(ground_truth=None))])
    assert count(image, GROUND_TRUTH) == 0
    assert count(image, LEFT) > 10


def test_same_frames_give_the_same_file(drawn: list[DrawnFrame]) -> None:
    assert png_bytes(contact_sheet(drawn)) == png_bytes(contact_sheet(drawn))


@pytest.mark.parametrize(
    ('frames', 'shape'), [(1, (1, 1)), (5, (1, 5)), (8, (2, 4)), (13, (3, 5))]
)
def test_each_frame_has_a_panel(
    drawn: list[DrawnFrame], frames: int, shape: tuple[int, int]
) -> None:
    figure = contact_sheet([drawn[number % 3] for number in range(frames)])
    grid = figure.axes[0].get_gridspec()
    assert (grid.nrows, grid.ncols) == shape
    assert sum(bool(axes.get_title()) for axes in figure.axes) == frames


@pytest.mark.parametrize('frames', [1, 2, 3, 4, 8])
def test_whole_legend_is_within_the_sheet(drawn: list[DrawnFrame], frames: int) -> None:
    figure = contact_sheet([drawn[number % 3] for number in range(frames)], 'a title')
    png_bytes(figure)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "person's left", "person's right", 'middle', 'ground truth', 'silhouette'
    ]  # fmt: skip
    box = legend.get_window_extent()
    assert 0 <= box.x0 < box.x1 <= figure.bbox.width
    lowest = min(axes.get_window_extent().y0 for axes in figure.axes)
    assert 0 <= box.y0 < box.y1 <= lowest


def test_frame_without_bodies_is_drawn_whole(drawn: list[DrawnFrame]) -> None:
    frame = drawn[0].frame
    empty = frame._replace(labels=np.full_like(frame.labels, NO_BODY), ground_truth=None)
    axes = contact_sheet([DrawnFrame('frame 0', empty)]).axes[0]
    assert axes.get_xlim() == (-0.5, 159.5)


def test_title_with_bytes_that_are_no_text_is_drawn(drawn: list[DrawnFrame]) -> None:
    name = b'\xff\xfe.mcap'.decode('utf-8', 'surrogateescape')
    sheets = [png_bytes(contact_sheet(drawn[:1], title)) for title in (name, '??.mcap')]
    assert sheets[0] == sheets[1]
