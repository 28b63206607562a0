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

"""The legend below a figure."""

from collections.abc import Sequence

from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D

from lsc_pose_ros.viz.drawing.colours import EDGE
from lsc_pose_ros.viz.drawing.dots import RING
from lsc_pose_ros.viz.drawing.skeleton_overlay import legend_lines

LEGEND_HEIGHT = 0.3
"""The height of one line of the legend in a figure, inches."""


def add_legend(figure: Figure, *, skeletons: bool, ground_truth: bool) -> None:
    """Add the legend of silhouette points and, if drawn, of skeletons and ground truth."""
    add_legend_entries(figure, frame_legend(skeletons=skeletons, ground_truth=ground_truth))


def frame_legend(*, skeletons: bool, ground_truth: bool) -> list[Line2D]:
    """Return the entries of silhouette points and, if drawn, of skeletons and ground truth."""
    entries = [
        Line2D([], [], color=EDGE, linestyle='', marker='.', markersize=4, label='silhouette')
    ]
    return legend_lines(ground_truth=ground_truth) + entries if skeletons else entries


def ring_entry(label: str) -> Line2D:
    """Return the entry of the rings around joints."""
    return Line2D(
        [], [], linestyle='', marker=RING.marker, markersize=7, markerfacecolor='none',
        markeredgecolor=RING.rim, markeredgewidth=RING.rim_width, label=label,
    )  # fmt: skip


def add_legend_entries(figure: Figure, entries: Sequence[Artist], lines: int = 1) -> None:
    """Add `entries` below the axes of `figure`.

    Args:
        figure: the figure; its height includes that of `lines` lines.
        entries: the entries.
        lines: how many lines they take. If their width needs more, the figure becomes higher.
    """
    for needed in range(lines, max(lines, len(entries)) + 1):
        legend = figure.legend(
            handles=entries, loc='lower center', ncol=-(-len(entries) // needed),
            handletextpad=0.6, columnspacing=1.5, borderaxespad=0.2,
        )  # fmt: skip
        if needed >= len(entries) or legend.get_window_extent().width <= figure.bbox.width:
            break
        legend.remove()
    height = figure.get_figheight() + (needed - lines) * LEGEND_HEIGHT
    figure.set_figheight(height)
    fraction = needed * LEGEND_HEIGHT / height
    engine = figure.get_layout_engine()
    if isinstance(engine, ConstrainedLayoutEngine):
        engine.set(rect=(0, fraction, 1, 1 - fraction))
