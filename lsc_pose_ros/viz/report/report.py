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

"""The HTML page of `evaluate --report`, one file with its figures inside."""

from html import escape
from pathlib import Path
from typing import NamedTuple

from lsc_pose_ros.evaluation.confidence_reliability import Reliability, measure_reliability
from lsc_pose_ros.evaluation.evaluate import Evaluation, Summary
from lsc_pose_ros.files.kinds import HTML
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.viz.drawing.canvas import make_directory
from lsc_pose_ros.viz.report import PAGE_NAME
from lsc_pose_ros.viz.report.contact_sheet import contact_sheet
from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame
from lsc_pose_ros.viz.report.page_parts import facts_list, html_page, image
from lsc_pose_ros.viz.report.plots import error_curves, joint_bars, reliability_plot


class Report(NamedTuple):
    """The content of the page.

    Attributes:
        title: the title.
        summary: the scores.
        evaluation: all errors.
        tolerance: a joint counts as correct up to this error, metres.
        facts: other facts by name: the model, the recordings, the time per frame.
        best: the frames with the smallest errors, with their estimates.
        worst: the frames with the largest errors, likewise.
    """

    title: str
    summary: Summary
    evaluation: Evaluation
    tolerance: float
    facts: dict[str, str]
    best: list[DrawnFrame]
    worst: list[DrawnFrame]


def write_report(directory: Path, report: Report) -> Path:
    """Write the page into `directory`, which is made if it does not exist; return its path.

    The page needs neither other files nor a network.

    Raises:
        InputError: it cannot be written.
    """
    make_directory(directory)
    path = directory / PAGE_NAME
    write_output(path, HTML, page(report).encode())
    return path


def page(report: Report) -> str:
    """Return the page as HTML."""
    body = f"""\
{_headline(report)}
{facts_list(report.facts)}
<h2>Joint by joint</h2>
{image(joint_bars(report.summary, report.tolerance), 'Mean error and precision of each joint')}
{_table(report)}
<h2>All errors</h2>
<p>The fraction of the joints whose error is at most the value on the axis.</p>
{image(error_curves(report.evaluation, report.tolerance), 'Cumulative error curves')}
{_confidence(measure_reliability(report.evaluation))}
{_frames('Best frames', report.best)}
{_frames('Worst frames', report.worst)}"""
    return html_page(report.title, body)


def _headline(report: Report) -> str:
    summary = report.summary
    people = len(report.evaluation.errors)
    numbers = {
        f'{100 * summary.mean_error_m:.1f} cm': 'mean error of a joint',
        f'{100 * summary.map:.1f} %': f'of the joints within {100 * report.tolerance:g} cm (mAP)',
        f'{people}': f'labelled people in {len(report.evaluation.seconds)} frames',
    }
    parts = ''.join(
        f'<div><b>{number}</b><span>{meaning}</span></div>' for number, meaning in numbers.items()
    )
    return f'<div class="headline">{parts}</div>'


def _table(report: Report) -> str:
    summary = report.summary
    rows = ''.join(
        f'<tr><td>{escape(name)}</td><td>{100 * score.mean_error_m:.1f}</td>'
        f'<td>{100 * score.ap:.1f}</td><td>{score.n}</td></tr>\n'
        for name, score in summary.joints.items()
    )
    return (
        '<table>\n<thead><tr><th>joint</th><th>mean error, cm</th>'
        f'<th>within {100 * report.tolerance:g} cm, %</th><th>labelled</th></tr></thead>\n'
        f'<tbody>\n{rows}</tbody>\n'
        f'<tfoot><tr><td>mean</td><td>{100 * summary.mean_error_m:.1f}</td>'
        f'<td>{100 * summary.map:.1f}</td><td></td></tr></tfoot>\n</table>'
    )


def _confidence(reliability: Reliability) -> str:
    plot = image(reliability_plot(reliability), 'Fraction of joints that are near, by confidence')
    return (
        f'<h2>Confidence</h2>\n<p>Of the joints with a confidence of 80 %, about 80 % should lie '
        f'within {100 * reliability.within_m:g} cm of the ground truth. On average over all '
        f'joints, confidence is off by {100 * reliability.ece:.1f} % (expected calibration '
        f'error).</p>\n{plot}'
    )


def _frames(heading: str, frames: list[DrawnFrame]) -> str:
    if not frames:
        return ''
    return f'<h2>{heading}</h2>\n{image(contact_sheet(frames), heading)}'
