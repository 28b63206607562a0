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

from html import escape
from typing import NamedTuple

from lsc_pose_experiments.experiment import MEAN, Experiment, Row, Verdict

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
        warning: text at the top; '' for none.
        command: the command line that measures missing experiments, without --only.
        sections: all experiments, in the order of the paper.
    """

    facts: dict[str, str]
    warning: str
    command: str
    sections: list[Section]


def write_page(page: Page) -> str:
    """Return the page as HTML; it refers to the figures in the same folder."""
    warning = f'<p class="warning">{escape(page.warning)}</p>' if page.warning else ''
    facts = ''.join(
        f'<dt>{escape(name)}</dt><dd>{escape(value)}</dd>' for name, value in page.facts.items()
    )
    sections = '\n'.join(_section(section, page.command) for section in page.sections)
    return f"""\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>The paper's experiments</title>
<style>{_STYLE}</style>
</head>
<body>
<h1>The paper's experiments on these recordings</h1>
<p>He, Wang, Liao, Xue: <em>Depth-images-based pose estimation using regression forests and
graphical models</em>, Neurocomputing 164 (2015). Its data sets THU and Stanford are not public, so
its tables and figures are measured on other recordings. Numbers that the paper shows only in a
figure are “{NOT_IN_TEXT}”.</p>
{warning}
<dl>{facts}</dl>
{_overview(page.sections)}
{sections}
</body>
</html>
"""


_STYLE = """
:root { color-scheme: light }
body { font: 16px/1.5 system-ui, sans-serif; color: #1a1a1a; background: #fff;
  max-width: 68rem; margin: 2rem auto; padding: 0 1rem }
h1 { font-size: 1.6rem } h2 { font-size: 1.2rem; margin-top: 2.5rem }
img { max-width: 100%; height: auto; display: block }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: 1rem 0 }
th, td { padding: .15rem 1.2rem .15rem 0; text-align: right; border-bottom: 1px solid #ddd;
  vertical-align: top }
th:first-child, td:first-child, .words td, .words th { text-align: left }
td.paper { color: #555 }
.answer { white-space: nowrap }
.warning { border: 1px solid #d55e00; padding: .5rem 1rem }
.missing { color: #555 }
dl { display: grid; grid-template-columns: max-content auto; gap: .2rem 1.5rem }
dt { color: #555 } dd { margin: 0; overflow-wrap: anywhere }
"""


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
            f'{head}<p class="missing">Not measured yet: <code>{escape(words)}</code></p>\n'
            '</section>'
        )
    return (
        f'{head}{_claims(section)}\n{_table(section)}\n'
        f'<img src="{experiment.name}.png" alt="{escape(experiment.title)}">\n'
        f'<p>All numbers: <a href="{experiment.name}.csv">{experiment.name}.csv</a></p>\n'
        '</section>'
    )


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
    return (
        '<table>\n<thead><tr><th>variant</th><th>part</th><th>training frames</th>'
        '<th>error, cm</th><th>paper</th>'
        f'<th>within {tolerance}, %</th><th>paper</th><th>ms per frame</th></tr></thead>\n'
        f'<tbody>\n{rows}</tbody>\n</table>'
    )


def _row(row: Row) -> str:
    part = 'all joints' if row.part == MEAN else row.part
    return (
        f'<tr><td>{escape(row.variant)}</td><td>{escape(part)}</td>'
        f'<td>{row.training_frames or "-"}</td>'
        f'<td>{_number(row.mean_error_m, "-")}</td>'
        f'<td class="paper">{_number(row.paper_mean_error_m, NOT_IN_TEXT)}</td>'
        f'<td>{_number(row.ap, "-")}</td>'
        f'<td class="paper">{_number(row.paper_ap, NOT_IN_TEXT)}</td>'
        f'<td>{"-" if row.frame_ms is None else f"{row.frame_ms:.1f}"}</td></tr>\n'
    )


def _number(value: float | None, otherwise: str) -> str:
    return otherwise if value is None else f'{100 * value:.1f}'
