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

"""Figures as SVG elements inside of an HTML page, in the colours of the page's scheme."""

import hashlib
import io
import re
from html import escape
from typing import NamedTuple
from xml.etree import ElementTree as ET

from matplotlib.figure import Figure

from lsc_pose_ros.viz.drawing.canvas import house_style
from lsc_pose_ros.viz.drawing.colours import PALETTE

_PIXELS_PER_INCH = 96  # of CSS
_VARIABLES = {shades.light: f'var(--{name})' for name, shades in PALETTE.items()}
_LEFT_OUT = {'metadata', 'style'}  # the style sheet of the page has its rules


class Chart(NamedTuple):
    """A figure and its alternative text: what a reader sees in it."""

    figure: Figure
    seen: str


def chart_element(chart: Chart) -> str:
    """Return `chart` as an element that has the colours of the page's scheme."""
    label = f'class="chart" role="img" aria-label="{escape(chart.seen)}"'
    return _element(chart.figure, label, themed=True)


def swatch_element(figure: Figure, *, themed: bool) -> str:
    """Return `figure` as an element that screen readers leave out.

    Args:
        figure: the figure.
        themed: whether it has the colours of the page's scheme; otherwise those of paper.
    """
    return _element(figure, 'class="swatch" aria-hidden="true"', themed=themed)


def _element(figure: Figure, attributes: str, *, themed: bool) -> str:
    root = _tree(figure)
    width, height = figure.get_size_inches()
    text = ''.join(ET.tostring(child, encoding='unicode') for child in root)
    if themed:
        text = re.sub('#[0-9a-f]{6}', lambda found: _VARIABLES.get(found[0], found[0]), text)
    size = f'viewBox="{root.attrib["viewBox"]}" width="{width * _PIXELS_PER_INCH:.0f}"'
    return f'<svg {attributes} {size} height="{height * _PIXELS_PER_INCH:.0f}">{text}</svg>'


@house_style()
def _tree(figure: Figure) -> ET.Element:
    """Return `figure` as SVG without namespaces and metadata; its identifiers are its own."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format='svg', metadata={'Date': None})
    root = ET.fromstring(buffer.getvalue())  # noqa: S314  # matplotlib wrote it
    digest = hashlib.sha256(buffer.getvalue()).hexdigest()[:8]
    for parent in root.iter():
        parent.tag = _local(parent.tag)
        for child in list(parent):
            if _local(child.tag) in _LEFT_OUT:
                parent.remove(child)
        attributes = {_local(name): value for name, value in parent.attrib.items()}
        parent.attrib = {
            name: _own_reference(name, value, digest) for name, value in attributes.items()
        }
        parent.text, parent.tail = (parent.text or '').strip(), None
    return root


def _local(name: str) -> str:
    """Return `name` without its namespace."""
    return name.rpartition('}')[2]


def _own_reference(name: str, value: str, digest: str) -> str:
    """Return an attribute's value in which identifiers are those of one figure of a page."""
    if name == 'id':
        return f'{digest}-{value}'
    if name == 'href':
        return value.replace('#', f'#{digest}-', 1)
    return value.replace('url(#', f'url(#{digest}-')
