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

from lsc_pose_ros.evaluation.evaluate import Evaluation, Summary
from lsc_pose_ros.files.kinds import HTML
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.viz.drawing.canvas import (
    CHART_WIDTH,
    house_style,
    make_directory,
    new_figure,
)
from lsc_pose_ros.viz.drawing.colours import curve_look
from lsc_pose_ros.viz.drawing.svg import Chart
from lsc_pose_ros.viz.report import PAGE_NAME
from lsc_pose_ros.viz.report.page_parts import charts, facts_list, folded_facts, html_page, table
from lsc_pose_ros.viz.report.plots import curve_entry, draw_curves
from lsc_pose_ros.viz.report.report import CURVES_CAPTION


class ComparedModel(NamedTuple):
    """One model: its name, its scores, all errors, and how it was made."""

    name: str
    summary: Summary
    evaluation: Evaluation
    provenance: dict[str, str]


def write_comparison(
    directory: Path,
    models: Sequence[ComparedModel],
    tolerance: float,
    facts: dict[str, str],
    origin: str,
) -> Path:
    """Write the page into `directory`, which is made if it does not exist; return its path.

    Args:
        directory: the folder.
        models: what is compared.
        tolerance: a joint counts as found up to this error, metres.
        facts: other facts by name.
        origin: when and by what the page is made.

    Raises:
        InputError: it cannot be written.
    """
    make_directory(directory)
    path = directory / PAGE_NAME
    title = ' and '.join(model.name for model in models)
    curves = [curve_entry(curve_look(number), each.name) for number, each in enumerate(models)]
    bars = [curve_entry(curve_look(number).solid, each.name) for number, each in enumerate(models)]
    made = '\n'.join(
        folded_facts(f'How {model.name} was made', model.provenance) for model in models
    )
    body = f"""\
{facts_list(facts)}
{_table(models, tolerance)}
{made}
<h2>Joint by joint</h2>
{charts([comparison_bars(models, tolerance)], _BARS, bars)}
<h2>All errors</h2>
{charts([comparison_curves(models, tolerance)], CURVES_CAPTION, curves)}"""
    write_output(path, HTML, html_page(title, body, origin).encode())
    return path


_BARS = (
    'The fraction of the estimates of each joint within the tolerance, a bar for each model: the '
    'longer the better.'
)


def _table(models: Sequence[ComparedModel], tolerance: float) -> str:
    rows = ''.join(
        f'<tr><td>{escape(model.name)}</td><td>{100 * model.summary.mean_error_m:.1f}</td>'
        f'<td>{100 * model.summary.map:.1f}</td></tr>\n'
        for model in models
    )
    head = ('model', 'mean error, cm', f'within {100 * tolerance:g} cm, %')
    return table('Scores of each model', head, rows)


def comparison_curves(models: Sequence[ComparedModel], tolerance: float) -> Chart:
    """Return the cumulative error curve of each model over all its joints."""
    # Two models may have the same name, so the curves are numbered.
    curves = {
        str(number): (model.evaluation.errors.ravel(), curve_look(number))
        for number, model in enumerate(models)
    }
    seen = f'A rising curve of the joints within an error for each model. {_means(models)}'
    return Chart(draw_curves(curves, tolerance), seen)


@house_style()
def comparison_bars(models: Sequence[ComparedModel], tolerance: float) -> Chart:
    """Return for each joint the fraction within `tolerance` metres, a bar for each model."""
    joints = list(dict.fromkeys(name for model in models for name in model.summary.joints))
    figure = new_figure(CHART_WIDTH, 0.9 + 0.12 * len(joints) * (len(models) + 1))
    axes = figure.subplots()
    height = 1 / (len(models) + 1)
    for number, model in enumerate(models):
        rows = [row for row, name in enumerate(joints) if name in model.summary.joints]
        values = [100 * model.summary.joints[joints[row]].ap for row in rows]
        places = [row + height * (number - (len(models) - 1) / 2) for row in rows]
        axes.barh(places, values, height=height, color=curve_look(number).colour)
    axes.set_yticks(range(len(joints)), joints)
    axes.tick_params(axis='y', length=0)
    axes.set_ylim(len(joints) - 0.4, -0.6)
    axes.set_xlim(0, 100)
    axes.set_xlabel(f'within {100 * tolerance:g} cm, %')
    seen = f'Bars of {len(joints)} joints, one for each model. {_means(models)}'
    return Chart(figure, seen)


def _means(models: Sequence[ComparedModel]) -> str:
    """Return the mean scores of all models as a sentence."""
    each = ', '.join(
        f'{model.name} {100 * model.summary.map:.1f} % and '
        f'{100 * model.summary.mean_error_m:.1f} cm'
        for model in models
    )
    return f'Within the tolerance, and mean error: {each}.'
