"""What the lines and dots over an image mean, below the figure."""

from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D

from lsc_pose_ros.viz.drawing.colours import EDGE
from lsc_pose_ros.viz.drawing.skeleton_overlay import legend_lines

LEGEND_HEIGHT = 0.3
"""What the legend takes of the figure's height, inches."""


def add_legend(figure: Figure, *, skeletons: bool, ground_truth: bool) -> None:
    """Explain below `figure` the silhouette points and, where drawn, skeletons and truth."""
    entries = [
        Line2D([], [], color=EDGE, linestyle='', marker='.', markersize=4, label='silhouette')
    ]
    if skeletons:
        entries = legend_lines(ground_truth=ground_truth) + entries
    place_legend(figure, entries)


def place_legend(figure: Figure, entries: list[Line2D]) -> None:
    """Put `entries` in one line below all that is in `figure`."""
    figure.legend(
        handles=entries, loc='lower center', ncol=len(entries), handletextpad=0.6,
        columnspacing=1.5, borderaxespad=0.2,
    )  # fmt: skip
    share = LEGEND_HEIGHT / figure.get_figheight()
    engine = figure.get_layout_engine()
    if isinstance(engine, ConstrainedLayoutEngine):
        engine.set(rect=(0, share, 1, 1 - share))
