"""One body through every stage of the method: a picture each, and all on one sheet."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lsc_pose_ros.viz.drawing.canvas import (
    hide_axes,
    house_style,
    make_directory,
    new_figure,
    save_png,
)
from lsc_pose_ros.viz.stages.density_picture import densities_figure, draw_densities
from lsc_pose_ros.viz.stages.descriptor_picture import descriptor_figure, draw_feature
from lsc_pose_ros.viz.stages.seen_body import Estimated, SeenBody
from lsc_pose_ros.viz.stages.silhouette_picture import (
    draw_metres,
    draw_silhouette,
    draw_smoothing,
)
from lsc_pose_ros.viz.stages.skeleton_picture import draw_answer, skeleton_figure
from lsc_pose_ros.viz.stages.votes_picture import draw_joint_votes, draw_pair_votes

SHEET_NAME = 'stages'
_COLUMNS = 4
_PANEL_WIDTH, _PANEL_HEIGHT = 2.3, 3.45

Draw = Callable[[Axes], None]


class Stage(NamedTuple):
    """One stage's picture.

    Attributes:
        name: of its file, without the suffix.
        draw: draws it into a place on the sheet.
        figure: makes its own picture; None where that shows the same.
    """

    name: str
    draw: Draw
    figure: Callable[[], Figure] | None = None


def stages_of(seen: SeenBody) -> list[Stage]:
    """Return the stages that can be drawn: without a model, the first four."""
    own = seen.settings.feature == '3dlsc'
    stages = [
        Stage('1_depth', lambda axes: draw_metres(axes, seen)),
        Stage('2_smoothing', lambda axes: draw_smoothing(axes, seen)),
        Stage('3_silhouette', lambda axes: draw_silhouette(axes, seen)),
        Stage(
            '4_descriptor',
            lambda axes: draw_feature(axes, seen),
            (lambda: descriptor_figure(seen)) if own else None,
        ),
    ]
    if seen.estimated is not None:
        stages += _estimated_stages(seen, seen.estimated)
    return stages


def _estimated_stages(seen: SeenBody, estimated: Estimated) -> list[Stage]:
    return [
        Stage('5_votes', lambda axes: draw_joint_votes(axes, seen, estimated)),
        Stage(
            '6_densities',
            lambda axes: draw_densities(axes, seen, estimated),
            lambda: densities_figure(seen, estimated),
        ),
        Stage('7_pairs', lambda axes: draw_pair_votes(axes, seen, estimated)),
        Stage(
            '8_skeleton',
            lambda axes: draw_answer(axes, seen, estimated),
            lambda: skeleton_figure(seen, estimated),
        ),
    ]


@house_style()
def stage_sheet(seen: SeenBody) -> Figure:
    """Return one page with all stages."""
    stages = stages_of(seen)
    rows = math.ceil(len(stages) / _COLUMNS)
    figure = new_figure(_COLUMNS * _PANEL_WIDTH, rows * _PANEL_HEIGHT + 0.3)
    figure.suptitle(f'{seen.label}, body {seen.body}', fontsize=11)
    grid = figure.subplots(rows, _COLUMNS, squeeze=False).ravel()
    for number, (axes, stage) in enumerate(zip(grid, stages, strict=False), 1):
        stage.draw(axes)
        axes.set_title(f'{number}. {axes.get_title()}')
    for axes in grid[len(stages) :]:
        hide_axes(axes)
    return figure


@house_style()
def stage_figures(seen: SeenBody) -> dict[str, Figure]:
    """Return a picture for each stage, by the name of its file, and the sheet of all."""
    figures: dict[str, Figure] = {}
    for stage in stages_of(seen):
        if stage.figure is not None:
            figures[stage.name] = stage.figure()
        else:
            figures[stage.name] = new_figure(1.6 * _PANEL_WIDTH, 1.6 * _PANEL_HEIGHT)
            stage.draw(figures[stage.name].subplots())
    return figures | {SHEET_NAME: stage_sheet(seen)}


def write_stages(directory: Path, seen: SeenBody) -> list[Path]:
    """Write a PNG for each stage and one of all into `directory`; return their paths.

    Raises:
        InputError: a file cannot be written.
    """
    make_directory(directory)
    paths: list[Path] = []
    for name, figure in stage_figures(seen).items():
        paths.append(directory / f'{name}.png')
        save_png(figure, paths[-1])
    return paths
