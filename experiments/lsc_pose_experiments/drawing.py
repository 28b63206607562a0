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
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from lsc_pose_experiments.experiment import MEAN, SIZES, Experiment, Row, points_of
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.viz.drawing.canvas import CHART_WIDTH, house_style, new_figure
from lsc_pose_ros.viz.drawing.colours import ALL_JOINTS, BORDER, CURVES, PARTS, curve_look
from lsc_pose_ros.viz.drawing.legend import add_legend_entries
from lsc_pose_ros.viz.drawing.svg import Chart
from lsc_pose_ros.viz.report.plots import curve_entry

# The curves; the paper draws the mean of all joints.
_CURVES = {MEAN if part == ALL_JOINTS else part: look for part, look in PARTS.items()}
_MARKERS = 'osD^vX'
_ENTRIES_OF_A_LINE = 6

_Value = Callable[[Row], float | None]


class _Quantity(NamedTuple):
    """What one of the two panels of a figure shows."""

    title: str
    value: _Value
    paper: _Value


@house_style()
def draw_experiment(experiment: Experiment, rows: list[Row]) -> Figure:
    """Return the figure of `experiment`: the errors, and beside them the fractions within.

    Args:
        experiment: the experiment.
        rows: all its scores.
    """
    height = 3.6 if experiment.axis else 1.2 + 0.21 * len(_parts_of(experiment, rows))
    figure = new_figure(8.4, height)
    pair = figure.subplots(1, 2, sharey=experiment.axis is None)
    for axes, quantity in zip(pair, _quantities(experiment), strict=True):
        _draw_panel(axes, experiment, rows, quantity)
    entries = experiment_entries(experiment, rows)
    add_legend_entries(figure, entries, lines=1 if len(entries) <= _ENTRIES_OF_A_LINE else 2)
    return figure


@house_style()
def experiment_charts(experiment: Experiment, rows: list[Row]) -> list[Chart]:
    """Return the panels of `draw_experiment` as charts of a page."""
    height = 2.8 if experiment.axis else 0.9 + 0.24 * len(_parts_of(experiment, rows))
    charts: list[Chart] = []
    for quantity in _quantities(experiment):
        figure = new_figure(CHART_WIDTH, height)
        _draw_panel(figure.subplots(), experiment, rows, quantity)
        charts.append(Chart(figure, _seen(experiment, rows, quantity)))
    return charts


def experiment_entries(experiment: Experiment, rows: list[Row]) -> list[Line2D]:
    """Return the legend of both panels."""
    return _curve_entries(rows) if experiment.axis else _dot_entries(rows)


def _quantities(experiment: Experiment) -> tuple[_Quantity, _Quantity]:
    within = f'within {100 * experiment.tolerance:g} cm, %'
    return (
        _Quantity('mean error, cm', _error, _paper_error),
        _Quantity(within, _fraction, _paper_fraction),
    )


def _seen(experiment: Experiment, rows: list[Row], quantity: _Quantity) -> str:
    """Return the alternative text of a panel: the number of each variant for all joints."""
    means = [row for row in rows if row.part == MEAN]
    words = [
        row.variant
        + ''.join(
            f' {100 * value:.1f}{source}'
            for value, source in ((quantity.value(row), ''), (quantity.paper(row), ' (paper)'))
            if value is not None
        )
        for row in means
        if quantity.value(row) is not None or quantity.paper(row) is not None
    ]
    kind = 'Curves' if experiment.axis else 'Dots for each joint'
    return f'{kind}: {quantity.title}. All joints: {", ".join(words)}.'


def _draw_panel(axes: Axes, experiment: Experiment, rows: list[Row], quantity: _Quantity) -> None:
    axes.set_title(quantity.title)
    if experiment.axis:
        _draw_curves(axes, points_of(experiment, rows), quantity)
        axes.set_xlabel(experiment.axis.name)
        if experiment.axis.logarithmic:
            axes.set_xscale('log')
        axes.grid(color=BORDER, linewidth=0.4)
        return
    parts = _parts_of(experiment, rows)
    _draw_dots(axes, rows, parts, quantity)
    axes.set_yticks(range(len(parts)), parts)
    axes.set_ylim(len(parts) - 0.4, -0.6)


def _draw_curves(axes: Axes, rows: list[Row], quantity: _Quantity) -> None:
    for part, look in _CURVES.items():
        mine = [row for row in rows if row.part == part]
        axes.plot(
            [row.x for row in mine],
            _numbers(mine, quantity.value),
            dashes=look.dashes,
            color=look.colour,
            marker='o',
            markersize=3,
        )
    known = [row for row in rows if quantity.paper(row) is not None]
    axes.plot(
        [row.x for row in known], _numbers(known, quantity.paper), linestyle='', marker='o',
        markersize=7, markerfacecolor='none', color=CURVES[0],
    )  # fmt: skip


def _draw_dots(axes: Axes, rows: list[Row], parts: list[str], quantity: _Quantity) -> None:
    for place in range(len(parts)):
        axes.axhline(place, color=BORDER, linewidth=0.4)
    labels = _labels(rows)
    rows = [row for row in rows if row.part in parts]
    for number, label in enumerate(labels):
        colour, marker = curve_look(number).colour, _MARKERS[number % len(_MARKERS)]
        for value, face in ((quantity.value, colour), (quantity.paper, 'none')):
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


def _curve_entries(rows: list[Row]) -> list[Line2D]:
    named = {row.part for row in rows}
    lines = [
        curve_entry(look, ALL_JOINTS if part == MEAN else part)
        for part, look in _CURVES.items()
        if part in named
    ]
    return [*lines, _paper_entry()]


def _dot_entries(rows: list[Row]) -> list[Line2D]:
    dots = [
        Line2D(
            [], [], color=curve_look(number).colour, marker=_MARKERS[number % len(_MARKERS)],
            linestyle='', markersize=4, label=label,
        )
        for number, label in enumerate(_labels(rows))
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
