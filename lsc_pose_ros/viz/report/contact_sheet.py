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

"""The contact sheet: a figure with a panel for each of many frames."""

import math
from collections.abc import Sequence

from matplotlib.figure import Figure

from lsc_pose_ros.viz.drawing.canvas import hide_axes, house_style, new_figure
from lsc_pose_ros.viz.drawing.legend import LEGEND_HEIGHT, add_legend
from lsc_pose_ros.viz.drawing.readable_text import readable
from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame, caption, draw_frame

_MOST_COLUMNS = 6
_PANEL_WIDTH, _PANEL_HEIGHT = 1.75, 2.35
_TITLE_HEIGHT = 0.35


@house_style()
def contact_sheet(frames: Sequence[DrawnFrame], title: str = '') -> Figure:
    """Return a figure with a panel for each frame.

    Args:
        frames: at least one.
        title: the title of the figure; '' for none.
    """
    columns = _columns(len(frames))
    rows = math.ceil(len(frames) / columns)
    height = rows * _PANEL_HEIGHT + LEGEND_HEIGHT + (_TITLE_HEIGHT if title else 0)
    figure = new_figure(max(columns, 2) * _PANEL_WIDTH, height)
    if title:
        figure.suptitle(readable(title), fontsize=11)
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, drawn in zip(grid, frames, strict=False):
        draw_frame(axes, drawn)
        axes.set_title(caption(drawn), pad=3)
    for axes in grid[len(frames) :]:
        hide_axes(axes)
    add_legend(
        figure,
        skeletons=any(drawn.estimate or drawn.frame.ground_truth for drawn in frames),
        ground_truth=any(drawn.estimate and drawn.frame.ground_truth for drawn in frames),
    )
    return figure


def _columns(count: int) -> int:
    """Return the number of columns for `count` frames that leaves the fewest gaps."""
    most = min(count, _MOST_COLUMNS)
    fewest = min(count, 4)
    return min(range(most, fewest - 1, -1), key=lambda columns: -count % columns)
