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
from html import escape

from matplotlib.figure import Figure

from lsc_pose_ros.viz.drawing.canvas import png_bytes

# The resolution of figures relative to their size on the page: for dense screens and paper.
_SCALE = 2.0

_STYLE = """
:root { color-scheme: light }
body { font: 16px/1.5 system-ui, sans-serif; color: #1a1a1a; background: #fff;
  max-width: 68rem; margin: 2rem auto; padding: 0 1rem }
h1 { font-size: 1.6rem } h2 { font-size: 1.2rem; margin-top: 2.5rem }
img { max-width: 100%; height: auto; display: block }
.headline { display: flex; gap: 3rem; flex-wrap: wrap }
.headline b { display: block; font-size: 2rem; line-height: 1.2 }
.headline span { color: #555 }
table { border-collapse: collapse; font-variant-numeric: tabular-nums }
th, td { padding: .15rem 1.2rem .15rem 0; text-align: right; border-bottom: 1px solid #ddd }
th:first-child, td:first-child { text-align: left }
tfoot td { font-weight: bold }
dl { display: grid; grid-template-columns: max-content auto; gap: .2rem 1.5rem }
dt { color: #555 } dd { margin: 0; overflow-wrap: anywhere }
"""


def html_page(title: str, body: str) -> str:
    """Return a page as HTML.

    Args:
        title: plain text.
        body: what follows the title, HTML.
    """
    title = escape(title)
    return f"""\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>{_STYLE}</style>
</head>
<body>
<h1>{title}</h1>
{body}
</body>
</html>
"""


def facts_list(facts: dict[str, str]) -> str:
    """Return facts by name as a list of HTML, '' if there are none."""
    lines = ''.join(
        f'<dt>{escape(name)}</dt><dd>{escape(value)}</dd>' for name, value in facts.items()
    )
    return f'<dl>{lines}</dl>' if lines else ''


def image(figure: Figure, description: str) -> str:
    """Return a figure as an image inside of the page, with `description` for screen readers."""
    data = base64.b64encode(png_bytes(figure, scale=_SCALE)).decode()
    width = round(figure.get_figwidth() * figure.dpi)
    return f'<img width="{width}" alt="{escape(description)}" src="data:image/png;base64,{data}">'
