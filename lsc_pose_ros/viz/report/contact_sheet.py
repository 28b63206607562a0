"""The contact sheet: a figure with a panel for each of many frames."""

import math
from collections.abc import Sequence

from matplotlib.figure import Figure

from lsc_pose_ros.viz.drawing.canvas import hide_axes, house_style, new_figure
from lsc_pose_ros.viz.drawing.legend import LEGEND_HEIGHT, add_legend
from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame, draw_frame

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
        figure.suptitle(title, fontsize=11)
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, drawn in zip(grid, frames, strict=False):
        draw_frame(axes, drawn)
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
