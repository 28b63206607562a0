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

"""The HTML page of `label --report`: what a check of labels has found, and the worst frames."""

from collections.abc import Sequence
from html import escape
from pathlib import Path

from lsc_pose_ros.files.kinds import HTML
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.viz.drawing.canvas import make_directory
from lsc_pose_ros.viz.report import PAGE_NAME
from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame, frame_entries, frame_picture
from lsc_pose_ros.viz.report.page_parts import facts_list, frames, html_page


def write_label_page(
    directory: Path,
    title: str,
    origin: str,
    facts: dict[str, str],
    advice: Sequence[str],
    worst: Sequence[DrawnFrame],
) -> Path:
    """Write the page into `directory`, which is made if it does not exist; return its path.

    Args:
        directory: the folder.
        title: the title.
        origin: when and by what the page is made.
        facts: what was found, by name.
        advice: a sentence for each thing to do.
        worst: the worst frames, each with its problems as the label.

    Raises:
        InputError: it cannot be written.
    """
    make_directory(directory)
    path = directory / PAGE_NAME
    todo = ''.join(f'<li>{escape(sentence)}</li>' for sentence in advice)
    pictures = ''
    if worst:
        panels = frames([frame_picture(each) for each in worst], frame_entries(worst), large=True)
        pictures = f'<h2>Worst frames</h2>\n<p>{_LEGEND}</p>\n{panels}'
    body = f"""\
{facts_list(facts)}
<h2>What to do</h2>
<ul>{todo or '<li>Nothing stands out.</li>'}</ul>
{pictures}"""
    write_output(path, HTML, html_page(title, body, origin).encode())
    return path


_LEGEND = (
    'The yellow band is the label. Where the model was run, the thin skeleton is its estimate; '
    'elsewhere the thin skeleton is the label. The distance is the mean over the joints, from the '
    'label to the estimate. Of frames within half a second, only the worst is shown.'
)
