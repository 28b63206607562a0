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

"""Figures of all stages of the method for one body: one for each stage, and a sheet of all."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.viz.drawing.canvas import (
    hide_axes,
    house_style,
    make_directory,
    new_figure,
    save_png,
)
from lsc_pose_ros.viz.stages.density_figure import densities_figure, draw_densities
from lsc_pose_ros.viz.stages.descriptor_figure import descriptor_figure, draw_feature
from lsc_pose_ros.viz.stages.shown_body import ShownBody
from lsc_pose_ros.viz.stages.silhouette_panels import (
    draw_metres,
    draw_silhouette,
    draw_smoothing,
)
from lsc_pose_ros.viz.stages.skeleton_figure import draw_joints, skeleton_figure
from lsc_pose_ros.viz.stages.stage_numbers import write_numbers
from lsc_pose_ros.viz.stages.vote_panels import draw_joint_votes, draw_pair_votes

SHEET_NAME = 'stages'
_COLUMNS = 4
_PANEL_WIDTH, _PANEL_HEIGHT = 2.3, 3.45

Draw = Callable[[Axes], None]


class StagePanel(NamedTuple):
    """The drawing of one stage.

    Attributes:
        name: the name of its file, without the suffix.
        draw: draws it into axes, for the sheet.
        figure: returns a figure that shows more; None if there is none.
    """

    name: str
    draw: Draw
    figure: Callable[[], Figure] | None = None


def stage_panels(shown: ShownBody) -> list[StagePanel]:
    """Return the panels of all stages; without a model, of the first four."""
    paper = shown.settings.feature == '3dlsc'
    panels = [
        StagePanel('1_depth', lambda axes: draw_metres(axes, shown)),
        StagePanel('2_smoothing', lambda axes: draw_smoothing(axes, shown)),
        StagePanel('3_silhouette', lambda axes: draw_silhouette(axes, shown)),
        StagePanel(
            '4_descriptor',
            lambda axes: draw_feature(axes, shown),
            (lambda: descriptor_figure(shown)) if paper else None,
        ),
    ]
    if shown.model is not None:
        panels += _joint_panels(shown, shown.model)
    return panels


def _joint_panels(shown: ShownBody, model: Model) -> list[StagePanel]:
    return [
        StagePanel('5_votes', lambda axes: draw_joint_votes(axes, shown, model)),
        StagePanel(
            '6_densities',
            lambda axes: draw_densities(axes, shown, model),
            lambda: densities_figure(shown, model),
        ),
        StagePanel('7_pairs', lambda axes: draw_pair_votes(axes, shown, model)),
        StagePanel(
            '8_skeleton',
            lambda axes: draw_joints(axes, shown, model),
            lambda: skeleton_figure(shown, model),
        ),
    ]


@house_style()
def stage_sheet(shown: ShownBody) -> Figure:
    """Return a figure with the panels of all stages."""
    panels = stage_panels(shown)
    rows = math.ceil(len(panels) / _COLUMNS)
    figure = new_figure(_COLUMNS * _PANEL_WIDTH, rows * _PANEL_HEIGHT + 0.3)
    figure.suptitle(f'{shown.label}, body {shown.number}', fontsize=11)
    grid = figure.subplots(rows, _COLUMNS, squeeze=False).ravel()
    for number, (axes, panel) in enumerate(zip(grid, panels, strict=False), 1):
        panel.draw(axes)
        axes.set_title(f'{number}. {axes.get_title()}')
    for axes in grid[len(panels) :]:
        hide_axes(axes)
    return figure


@house_style()
def stage_figures(shown: ShownBody) -> dict[str, Figure]:
    """Return a figure for each stage, by the name of its file, and the sheet of all."""
    figures: dict[str, Figure] = {}
    for panel in stage_panels(shown):
        if panel.figure is not None:
            figures[panel.name] = panel.figure()
        else:
            figures[panel.name] = new_figure(1.6 * _PANEL_WIDTH, 1.6 * _PANEL_HEIGHT)
            panel.draw(figures[panel.name].subplots())
    return figures | {SHEET_NAME: stage_sheet(shown)}


def write_stages(directory: Path, shown: ShownBody) -> list[Path]:
    """Write a PNG file for each stage and one of all into `directory`; return all paths.

    The numbers that they show are written beside them, as JSON.

    Raises:
        InputError: a file cannot be written.
    """
    make_directory(directory)
    paths: list[Path] = []
    for name, figure in stage_figures(shown).items():
        paths.append(directory / f'{name}.png')
        save_png(figure, paths[-1])
    return [*paths, write_numbers(directory, shown)]
