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

"""The HTML page with the measured numbers beside those of the paper."""

import base64
from html import escape
from typing import NamedTuple

from lsc_pose_experiments.drawing import experiment_charts, experiment_entries
from lsc_pose_experiments.experiment import MEAN, Experiment, Row, Verdict, csv_of
from lsc_pose_ros.viz.report.page_parts import charts, facts_list, html_page, table

PAGE_NAME = 'index.html'
NOT_IN_TEXT = 'not in the text'

_VERDICTS = {True: 'holds', False: 'does not hold', None: 'undecided'}


class Section(NamedTuple):
    """One experiment on the page; rows and verdicts are empty if it is not finished."""

    experiment: Experiment
    rows: list[Row]
    verdicts: list[Verdict]


class Page(NamedTuple):
    """The contents of the page.

    Attributes:
        facts: properties of the measurement, by name.
        origin: when and by what the page is made.
        warning: text at the top; '' for none.
        command: the command line that measures missing experiments, without --only.
        sections: all experiments, in the order of the paper.
    """

    facts: dict[str, str]
    origin: str
    warning: str
    command: str
    sections: list[Section]


def write_page(page: Page) -> str:
    """Return the page as HTML, which needs no other file."""
    warning = f'<p class="warning">{escape(page.warning)}</p>' if page.warning else ''
    sections = '\n'.join(_section(section, page.command) for section in page.sections)
    body = f"""\
<p>He, Wang, Liao, Xue: <em>Depth-images-based pose estimation using regression forests and
graphical models</em>, Neurocomputing 164 (2015). Its data sets THU and Stanford are not public, so
its tables and figures are measured on other recordings. Numbers that the paper shows only in a
figure are “{NOT_IN_TEXT}”.</p>
{warning}
{facts_list(page.facts)}
{_overview(page.sections)}
{sections}"""
    return html_page("The paper's experiments on these recordings", body, page.origin)


def _overview(sections: list[Section]) -> str:
    """Return all claims in one table."""
    rows = ''.join(
        f'<tr><td><a href="#{section.experiment.name}">{section.experiment.name}</a></td>'
        f'<td>{escape(claim.words)}</td><td class="answer">{_VERDICTS[verdict.holds]}</td></tr>\n'
        for section in sections
        for claim, verdict in zip(section.experiment.claims, section.verdicts, strict=False)
    )
    if not rows:
        return ''
    return (
        '<h2>Summary of the claims</h2>\n<table class="words">\n<thead><tr><th></th>'
        f'<th>claim</th><th>here</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n'
        '<p>Two variants are tested on the same people and compared person by person. A claim is '
        '“undecided” if the difference is below two standard errors (given after ±). Frames of '
        'one motion are similar, so the standard errors are rather too small.</p>'
    )


def _section(section: Section, command: str) -> str:
    experiment = section.experiment
    head = (
        f'<section id="{experiment.name}">\n<h2>{escape(experiment.title)}</h2>\n'
        f'<p>{escape(experiment.what)}</p>\n'
    )
    if not section.rows:
        words = f'{command} --only {experiment.name}'
        return (
            f'{head}<p class="muted">Not measured yet: <code>{escape(words)}</code></p>\n'
            '</section>'
        )
    pictures = charts(
        experiment_charts(experiment, section.rows),
        f'{_CAPTION} {_AXIS_CAPTION if experiment.axis else _DOTS_CAPTION}',
        experiment_entries(experiment, section.rows),
    )
    data = base64.b64encode(csv_of(section.rows).encode()).decode()
    name = f'{experiment.name}.csv'
    return (
        f'{head}{_claims(section)}\n{_table(section)}\n{pictures}\n'
        f'<p>All numbers: <a download="{name}" href="data:text/csv;base64,{data}">{name}</a></p>\n'
        '</section>'
    )


_CAPTION = 'The mean error, the lower the better, and the fraction within, the higher the better.'
_AXIS_CAPTION = 'Hollow circles are numbers of the paper for all joints.'
_DOTS_CAPTION = 'A row for each part of the body; hollow marks are numbers of the paper.'


def _claims(section: Section) -> str:
    rows = ''.join(
        f'<tr><td>{escape(claim.words)}</td>'
        f'<td class="answer"><b>{_VERDICTS[verdict.holds]}</b></td>'
        f'<td>{escape(verdict.words)}</td></tr>\n'
        for claim, verdict in zip(section.experiment.claims, section.verdicts, strict=True)
    )
    return (
        '<table class="words">\n<thead><tr><th>claim of the paper</th><th>here</th><th>reason'
        f'</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table>'
    )


def _table(section: Section) -> str:
    shown = (MEAN, *section.experiment.parts)
    tolerance = f'{100 * section.experiment.tolerance:g} cm'
    rows = ''.join(_row(row) for row in section.rows if row.part in shown)
    head = (
        'variant', 'part', 'training frames', 'error, cm', 'paper', f'within {tolerance}, %',
        'paper', 'ms per frame',
    )  # fmt: skip
    return table(f'Scores of {section.experiment.title}', head, rows)


def _row(row: Row) -> str:
    part = 'all joints' if row.part == MEAN else row.part
    return (
        f'<tr><td>{escape(row.variant)}</td><td>{escape(part)}</td>'
        f'<td>{row.training_frames or "-"}</td>'
        f'<td>{_number(row.mean_error_m, "-")}</td>'
        f'<td class="muted">{_number(row.paper_mean_error_m, NOT_IN_TEXT)}</td>'
        f'<td>{_number(row.ap, "-")}</td>'
        f'<td class="muted">{_number(row.paper_ap, NOT_IN_TEXT)}</td>'
        f'<td>{"-" if row.frame_ms is None else f"{row.frame_ms:.1f}"}</td></tr>\n'
    )


def _number(value: float | None, otherwise: str) -> str:
    return otherwise if value is None else f'{100 * value:.1f}'
