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

"""Draws the figures: curves, or dots for each joint; numbers of the paper are hollow."""

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from lsc_pose_experiments.experiment import MEAN, SIZES, Experiment, Row, points_of
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.viz.drawing.canvas import house_style, new_figure
from lsc_pose_ros.viz.drawing.colours import BORDER, CURVES
from lsc_pose_ros.viz.drawing.legend import add_legend_entries

_MARKERS = 'osD^v'
# The curves and their dashes; the paper draws the mean of all joints.
_PARTS: dict[str, tuple[float, ...]] = {
    MEAN: (),
    'elbows': (5, 1.5),
    'wrists': (2, 1.2),
    'hands': (6, 1.5, 1.5, 1.5),
}

_Value = Callable[[Row], float | None]


@house_style()
def draw_experiment(experiment: Experiment, rows: list[Row]) -> Figure:
    """Return the figure of `experiment`.

    Args:
        experiment: the experiment.
        rows: all its scores.
    """
    if experiment.axis:
        figure = new_figure(8.4, 3.6)
        errors, fractions = figure.subplots(1, 2)
        rows = points_of(experiment, rows)
        _draw_curves(errors, rows, _error, _paper_error)
        _draw_curves(fractions, rows, _fraction, _paper_fraction)
        for axes in (errors, fractions):
            axes.set_xlabel(experiment.axis.name)
            if experiment.axis.logarithmic:
                axes.set_xscale('log')
            axes.grid(color=BORDER, linewidth=0.4)
        _finish(figure, (errors, fractions), experiment, _curve_legend(rows))
        return figure
    parts = _parts_of(experiment, rows)
    figure = new_figure(8.4, 1.2 + 0.21 * len(parts))
    errors, fractions = figure.subplots(1, 2, sharey=True)
    _draw_dots(errors, rows, parts, (_error, _paper_error))
    _draw_dots(fractions, rows, parts, (_fraction, _paper_fraction))
    errors.set_yticks(range(len(parts)), parts)
    errors.set_ylim(len(parts) - 0.4, -0.6)
    _finish(figure, (errors, fractions), experiment, _dot_legend(rows))
    return figure


def _finish(
    figure: Figure, pair: tuple[Axes, Axes], experiment: Experiment, legend: list[Line2D]
) -> None:
    pair[0].set_title('mean error, cm')
    pair[1].set_title(f'within {100 * experiment.tolerance:g} cm, %')
    add_legend_entries(figure, legend)


def _draw_curves(axes: Axes, rows: list[Row], value: _Value, paper: _Value) -> None:
    for (part, dashes), colour in zip(_PARTS.items(), CURVES, strict=False):
        mine = [row for row in rows if row.part == part]
        axes.plot(
            [row.x for row in mine],
            _numbers(mine, value),
            dashes=dashes,
            color=colour,
            marker='o',
            markersize=3,
        )
    known = [row for row in rows if paper(row) is not None]
    axes.plot(
        [row.x for row in known], _numbers(known, paper), linestyle='', marker='o', markersize=7,
        markerfacecolor='none', color=CURVES[0],
    )  # fmt: skip


def _draw_dots(
    axes: Axes, rows: list[Row], parts: list[str], values: tuple[_Value, _Value]
) -> None:
    for place in range(len(parts)):
        axes.axhline(place, color=BORDER, linewidth=0.4)
    labels = _labels(rows)
    rows = [row for row in rows if row.part in parts]
    for number, label in enumerate(labels):
        colour, marker = CURVES[number % len(CURVES)], _MARKERS[number % len(_MARKERS)]
        for value, face in zip(values, (colour, 'none'), strict=True):
            mine = [row for row in rows if row.variant == label and value(row) is not None]
            shift = 0.12 * (number - 0.5 * (len(labels) - 1))
            axes.plot(
                _numbers(mine, value),
                [parts.index(row.part) + shift for row in mine],
                linestyle='', marker=marker, markersize=4 if face == colour else 6,
                markerfacecolor=face, color=colour,
            )  # fmt: skip
    axes.tick_params(axis='y', length=0)


def _parts_of(experiment: Experiment, rows: list[Row]) -> list[str]:
    """Return the parts, top down: the mean, those that the paper names, sizes, each joint."""
    named = {row.part for row in rows}
    paper = {row.part for row in rows if _paper_error(row) or _paper_fraction(row)}
    several = [part for part in sorted(paper) if part != MEAN and part not in JOINT_NAMES]
    sizes = [size for size in SIZES if size in named and size in experiment.parts]
    return [MEAN, *several, *sizes, *(name for name in JOINT_NAMES if name in named)]


def _labels(rows: list[Row]) -> list[str]:
    return list(dict.fromkeys(row.variant for row in rows))


def _curve_legend(rows: list[Row]) -> list[Line2D]:
    lines = [
        Line2D([], [], color=colour, dashes=dashes, label='all joints' if p == MEAN else p)
        for (p, dashes), colour in zip(_PARTS.items(), CURVES, strict=False)
        if any(row.part == p for row in rows)
    ]
    return [*lines, _paper_entry()]


def _dot_legend(rows: list[Row]) -> list[Line2D]:
    dots = [
        Line2D(
            [], [], color=CURVES[n % len(CURVES)], marker=_MARKERS[n % len(_MARKERS)],
            linestyle='', markersize=4, label=label,
        )
        for n, label in enumerate(_labels(rows))
    ]  # fmt: skip
    return [*dots, _paper_entry()]


def _paper_entry() -> Line2D:
    return Line2D(
        [], [], linestyle='', marker='o', markersize=6, markerfacecolor='none', color=CURVES[0],
        label='hollow: the paper',
    )  # fmt: skip


def _numbers(rows: list[Row], value: _Value) -> list[float]:
    return [np.nan if value(row) is None else 100 * float(value(row) or 0) for row in rows]


def _error(row: Row) -> float | None:
    return row.mean_error_m


def _fraction(row: Row) -> float | None:
    return row.ap


def _paper_error(row: Row) -> float | None:
    return row.paper_mean_error_m


def _paper_fraction(row: Row) -> float | None:
    return row.paper_ap
