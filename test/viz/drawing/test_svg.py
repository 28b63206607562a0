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

"""Figures as elements of a page."""

import re
from xml.etree import ElementTree as ET

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from lsc_pose_ros.viz.drawing.canvas import house_style, new_figure
from lsc_pose_ros.viz.drawing.colours import LEFT, MIDDLE
from lsc_pose_ros.viz.drawing.svg import Chart, chart_element, swatch_element


@house_style()
def figure(colour: str) -> Figure:
    drawn = new_figure(2, 1)
    axes = drawn.subplots()
    axes.plot([0, 1, 2], [0, 4, 1], color=colour, marker='o')
    axes.set_xlabel('5 < 6')
    return drawn


def test_chart_is_an_image_with_its_alternative_text() -> None:
    text = chart_element(Chart(figure(LEFT), 'a "zigzag" < 5'))
    root = ET.fromstring(text)  # noqa: S314  # our own
    assert (root.tag, root.attrib['role']) == ('svg', 'img')
    assert root.attrib['aria-label'] == 'a "zigzag" < 5'
    assert root.attrib['viewBox'] == '0 0 144 72'  # points
    assert (root.attrib['width'], root.attrib['height']) == ('192', '96')  # pixels of CSS
    assert '5 < 6' in [text.text for text in root.iter('text')]


def test_chart_has_the_colours_of_the_page() -> None:
    text = chart_element(Chart(figure(LEFT), ''))
    assert 'var(--left)' in text
    assert not re.search(f'{LEFT}|{MIDDLE}', text)


def test_legend_of_a_picture_has_the_colours_of_paper_and_is_not_read_aloud() -> None:
    text = swatch_element(figure(LEFT), themed=False)
    assert LEFT in text
    assert 'var(' not in text
    assert 'aria-hidden="true"' in text


def test_figures_on_one_page_do_not_refer_to_each_other() -> None:
    elements = [chart_element(Chart(figure(colour), '')) for colour in (LEFT, MIDDLE)]
    first, second = ({*re.findall(r'id="([^"]+)"', text)} for text in elements)
    assert first
    assert not first & second
    for text, own in zip(elements, (first, second), strict=True):
        references = re.findall(r'(?:url\(|href=")#([^)"]+)', text)
        assert references
        assert set(references) <= own


def test_same_figure_gives_the_same_element() -> None:
    chart = Chart(figure(LEFT), 'same')
    assert chart_element(chart) == chart_element(Chart(figure(LEFT), 'same'))


def test_dashes_of_a_legend_are_those_of_the_curve() -> None:
    drawn = new_figure(1, 1)
    drawn.add_artist(Line2D([0, 1], [0, 1], dashes=(5, 2), linewidth=1))
    assert 'stroke-dasharray' in swatch_element(drawn, themed=True)
