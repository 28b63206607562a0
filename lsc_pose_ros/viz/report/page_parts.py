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

"""The parts that the HTML pages share."""

import base64
from collections.abc import Mapping, Sequence
from datetime import datetime, timezone
from html import escape
from typing import NamedTuple

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from lsc_pose_ros.viz.drawing.canvas import house_style, new_figure, png_bytes
from lsc_pose_ros.viz.drawing.colours import PAGE
from lsc_pose_ros.viz.drawing.readable_text import readable
from lsc_pose_ros.viz.drawing.svg import Chart, chart_element, swatch_element
from lsc_pose_ros.viz.report.page_style import style_sheet

# The resolution of pictures relative to their size on the page: for dense screens and paper.
_SCALE = 2.0

_SWATCH = (0.36, 0.16)  # inches


class Picture(NamedTuple):
    """A picture on paper, its alternative text, and its caption."""

    figure: Figure
    seen: str
    caption: str


def html_page(title: str, body: str, origin: str) -> str:
    """Return a page as HTML, which needs no other file.

    Args:
        title: plain text.
        body: what follows the title, HTML.
        origin: when and with what the page was made, plain text, for its end.
    """
    title = escape(title)
    text = f"""\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>{style_sheet()}</style>
</head>
<body>
<h1>{title}</h1>
{body}
<footer><p>{escape(origin)}</p></footer>
</body>
</html>
"""
    return readable(text)


def origin_of(version: str, made: datetime | None = None) -> str:
    """Return the sentence on when and by what a page was made.

    Args:
        version: of the package.
        made: when; None for now.
    """
    moment = (made or datetime.now(timezone.utc)).astimezone(timezone.utc)
    return f'Made on {moment:%Y-%m-%d at %H:%M} UTC by lsc_pose_ros {version}.'


def facts_list(facts: Mapping[str, str]) -> str:
    """Return facts by name as a list of HTML, '' if there are none."""
    lines = ''.join(
        f'<dt>{escape(name)}</dt><dd>{escape(value)}</dd>' for name, value in facts.items()
    )
    return f'<dl>{lines}</dl>' if lines else ''


def folded_facts(heading: str, facts: Mapping[str, str]) -> str:
    """Return facts below a heading that opens them, '' if there are none."""
    if not facts:
        return ''
    return f'<details><summary>{escape(heading)}</summary>{facts_list(facts)}</details>'


def charts(shown: Sequence[Chart], caption: str, entries: Sequence[Line2D] = ()) -> str:
    """Return charts side by side, or one below the other where the page is narrow.

    Args:
        shown: the charts.
        caption: what is seen in them, plain text.
        entries: of their legend.
    """
    pictures = '\n'.join(map(chart_element, shown))
    return (
        f'<figure>\n<div class="charts">\n{pictures}\n</div>\n{_legend(entries, themed=True)}'
        f'<figcaption>{escape(caption)}</figcaption>\n</figure>'
    )


def frames(pictures: Sequence[Picture], entries: Sequence[Line2D], *, large: bool = False) -> str:
    """Return pictures of frames in as many columns as there is room for, below their legend.

    Args:
        pictures: the pictures.
        entries: of their legend.
        large: whether single joints must be seen.
    """
    panels = '\n'.join(map(_panel, pictures))
    look = 'frames large' if large else 'frames'
    return f'{_legend(entries, themed=False)}<div class="{look}">\n{panels}\n</div>'


def table(name: str, head: Sequence[str], rows: str, foot: str = '') -> str:
    """Return a table of numbers, which scrolls on its own if the page is narrower.

    Args:
        name: what the table has, for screen readers.
        head: the titles of the columns, plain text.
        rows: of the body, HTML.
        foot: the last row, HTML.
    """
    titles = ''.join(f'<th scope="col">{escape(title)}</th>' for title in head)
    end = f'<tfoot>{foot}</tfoot>\n' if foot else ''
    return (
        f'<div class="scroll" role="region" tabindex="0" aria-label="{escape(name)}">\n<table>\n'
        f'<thead><tr>{titles}</tr></thead>\n<tbody>\n{rows}</tbody>\n{end}</table>\n</div>'
    )


def _panel(picture: Picture) -> str:
    data = base64.b64encode(png_bytes(picture.figure, scale=_SCALE)).decode()
    width, height = picture.figure.get_size_inches() * picture.figure.dpi
    return (
        f'<figure><img width="{width:.0f}" height="{height:.0f}" alt="{escape(picture.seen)}" '
        f'src="data:image/png;base64,{data}"><figcaption>{escape(picture.caption)}</figcaption>'
        '</figure>'
    )


def _legend(entries: Sequence[Line2D], *, themed: bool) -> str:
    if not entries:
        return ''
    items = ''.join(
        f'<li>{swatch_element(_swatch(entry), themed=themed)}{escape(str(entry.get_label()))}</li>'
        for entry in entries
    )
    return f'<ul class="legend{"" if themed else " paper"}">{items}</ul>\n'


@house_style()
def _swatch(entry: Line2D) -> Figure:
    """Return a small figure of the line or the marker of `entry`."""
    figure = new_figure(*_SWATCH)
    figure.set_facecolor(PAGE)
    is_line = entry.get_linestyle() not in {'None', ''}
    line = Line2D([0.06, 0.94] if is_line else [0.5], [0.5, 0.5] if is_line else [0.5])
    line.update_from(entry)
    if is_line:
        line.set_marker('')
    figure.add_artist(line)
    return figure
