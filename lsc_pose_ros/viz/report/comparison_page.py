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

"""The HTML page of `evaluate --report` for several models, side by side."""

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from lsc_pose_ros.evaluation.evaluate import Evaluation, Summary
from lsc_pose_ros.files.kinds import HTML
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.viz.drawing.canvas import (
    house_style,
    make_directory,
    new_figure,
)
from lsc_pose_ros.viz.drawing.colours import CURVES, FAINT
from lsc_pose_ros.viz.drawing.legend import add_legend_entries
from lsc_pose_ros.viz.report import PAGE_NAME
from lsc_pose_ros.viz.report.page_parts import facts_list, html_page, image
from lsc_pose_ros.viz.report.plots import FARTHEST_CM, cumulative


class ComparedModel(NamedTuple):
    """One model: its name, its scores and all errors."""

    name: str
    summary: Summary
    evaluation: Evaluation


def write_comparison(
    directory: Path, models: Sequence[ComparedModel], tolerance: float, facts: dict[str, str]
) -> Path:
    """Write the page into `directory`, which is made if it does not exist; return its path.

    Raises:
        InputError: it cannot be written.
    """
    make_directory(directory)
    path = directory / PAGE_NAME
    title = ' and '.join(model.name for model in models)
    curves = image(comparison_curves(models, tolerance), 'Cumulative errors of all joints')
    bars = image(comparison_bars(models, tolerance), 'Each joint of each model')
    body = f"""\
{facts_list(facts)}
{_table(models, tolerance)}
<h2>Joint by joint</h2>
{bars}
<h2>All errors</h2>
<p>The fraction of the joints whose error is at most the value on the axis.</p>
{curves}"""
    write_output(path, HTML, html_page(title, body).encode())
    return path


def _table(models: Sequence[ComparedModel], tolerance: float) -> str:
    rows = ''.join(
        f'<tr><td>{escape(model.name)}</td><td>{100 * model.summary.mean_error_m:.1f}</td>'
        f'<td>{100 * model.summary.map:.1f}</td></tr>'
        for model in models
    )
    head = f'<th>model</th><th>mean error, cm</th><th>within {100 * tolerance:g} cm, %</th>'
    return f'<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>'


@house_style()
def comparison_curves(models: Sequence[ComparedModel], tolerance: float) -> Figure:
    """Return the cumulative error curve of each model over all its joints."""
    figure = new_figure(8.4, 4.0)
    axes = figure.subplots()
    for number, model in enumerate(models):
        curve = cumulative(model.evaluation.errors)
        axes.plot(*curve, color=CURVES[number % len(CURVES)], linewidth=2)
    axes.axvline(100 * tolerance, color=FAINT, linewidth=0.8, linestyle='--')
    axes.set_xlim(0, FARTHEST_CM)
    axes.set_ylim(0, 101)
    axes.set_xlabel('error, cm')
    axes.set_ylabel('joints within, %')
    add_legend_entries(figure, _entries(models))
    return figure


@house_style()
def comparison_bars(models: Sequence[ComparedModel], tolerance: float) -> Figure:
    """Return for each joint the fraction within `tolerance` metres, a bar for each model."""
    joints = list(dict.fromkeys(name for model in models for name in model.summary.joints))
    figure = new_figure(8.4, 0.9 + 0.12 * len(joints) * (len(models) + 1))
    axes = figure.subplots()
    height = 1 / (len(models) + 1)
    for number, model in enumerate(models):
        rows = [row for row, name in enumerate(joints) if name in model.summary.joints]
        values = [100 * model.summary.joints[joints[row]].ap for row in rows]
        places = [row + height * (number - (len(models) - 1) / 2) for row in rows]
        axes.barh(places, values, height=height, color=CURVES[number % len(CURVES)])
    axes.set_yticks(range(len(joints)), joints)
    axes.set_ylim(len(joints) - 0.4, -0.6)
    axes.set_xlim(0, 100)
    axes.set_xlabel(f'within {100 * tolerance:g} cm, %')
    add_legend_entries(figure, _entries(models))
    return figure


def _entries(models: Sequence[ComparedModel]) -> list[Line2D]:
    return [
        Line2D([], [], color=CURVES[number % len(CURVES)], linewidth=4, label=model.name)
        for number, model in enumerate(models)
    ]
