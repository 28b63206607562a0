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

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import NamedTuple

from matplotlib.lines import Line2D

from lsc_pose_ros.evaluation.confidence_reliability import Reliability, measure_reliability
from lsc_pose_ros.evaluation.evaluate import Evaluation, Summary
from lsc_pose_ros.files.kinds import HTML
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.viz.drawing.canvas import make_directory
from lsc_pose_ros.viz.drawing.svg import Chart
from lsc_pose_ros.viz.report import PAGE_NAME
from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame, frame_entries, frame_picture
from lsc_pose_ros.viz.report.page_parts import (
    charts,
    facts_list,
    folded_facts,
    frames,
    html_page,
    table,
)
from lsc_pose_ros.viz.report.plots import (
    error_curves,
    joint_bars,
    part_entries,
    reliability_plot,
    side_entries,
)


class VideoSection(NamedTuple):
    """What the page says of a video.

    Attributes:
        ways: the names of the ways of estimation, which are the columns of the table.
        rows: a name and a value for each way.
        plot: one joint over time.
        entries: the legend of the plot.
        caption: what the plot shows.
    """

    ways: Sequence[str]
    rows: Sequence[tuple[str, Sequence[str]]]
    plot: Chart
    entries: Sequence[Line2D]
    caption: str


class Report(NamedTuple):
    """The content of the page.

    Attributes:
        title: the title.
        origin: when and by what it was made.
        summary: the scores.
        evaluation: all errors.
        tolerance: a joint counts as correct up to this error, metres.
        facts: other facts by name: the model, the recordings, the time per frame.
        provenance: how the model was made, by name.
        best: the frames with the smallest errors, with their estimates.
        worst: the frames with the largest errors, likewise.
        video: the estimation over time; None if it was not measured.
    """

    title: str
    origin: str
    summary: Summary
    evaluation: Evaluation
    tolerance: float
    facts: dict[str, str]
    provenance: dict[str, str]
    best: list[DrawnFrame]
    worst: list[DrawnFrame]
    video: VideoSection | None = None


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
    bars = joint_bars(report.summary, report.tolerance)
    body = f"""\
{_headline(report)}
{facts_list(report.facts)}
{folded_facts('How the model was made', report.provenance)}
<h2>Joint by joint</h2>
{charts(bars, _BARS, side_entries(report.summary.joints))}
{_table(report)}
<h2>All errors</h2>
{
        charts(
            [error_curves(report.evaluation, report.tolerance)],
            CURVES_CAPTION,
            part_entries(report.evaluation),
        )
    }
{_confidence(measure_reliability(report.evaluation))}
{_video(report.video)}
{_frames('Best frames', report.best)}
{_frames('Worst frames', report.worst)}"""
    return html_page(report.title, body, report.origin)


CURVES_CAPTION = (
    'The fraction of the joints whose error is at most the value on the axis: the higher a curve, '
    'the better.'
)

_BARS = (
    'Bars of the mean error of each joint, the shorter the better, and of the fraction of its '
    'estimates within the tolerance, the longer the better.'
)

_FRAMES = (
    'Depth is grey, the nearer the lighter; the estimated skeleton lies over the band of the '
    'ground truth. The number is the mean error of the labelled joints.'
)


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
    within = f'within {100 * report.tolerance:g} cm, %'
    foot = (
        f'<tr><td>mean</td><td>{100 * summary.mean_error_m:.1f}</td>'
        f'<td>{100 * summary.map:.1f}</td><td></td></tr>'
    )
    head = ('joint', 'mean error, cm', within, 'labelled')
    return table('Scores of each joint', head, rows, foot)


def _confidence(reliability: Reliability) -> str:
    caption = (
        f'Of the joints with a confidence of 80 %, about 80 % should lie within '
        f'{100 * reliability.within_m:g} cm of the ground truth: dots on the grey diagonal. On '
        f'average over all joints, confidence is off by {100 * reliability.ece:.1f} % (expected '
        f'calibration error). The bars below count the joints of each confidence.'
    )
    return f'<h2>Confidence</h2>\n{charts([reliability_plot(reliability)], caption)}'


def _video(video: VideoSection | None) -> str:
    if video is None:
        return ''
    rows = ''.join(
        f'<tr><td>{escape(name)}</td>{"".join(f"<td>{escape(value)}</td>" for value in values)}'
        '</tr>\n'
        for name, values in video.rows
    )
    scores = table('Scores of the video', ('', *video.ways), rows)
    return f'<h2>Over time</h2>\n{scores}\n{charts([video.plot], video.caption, video.entries)}'


def _frames(heading: str, drawn: list[DrawnFrame]) -> str:
    if not drawn:
        return ''
    pictures = [frame_picture(each) for each in drawn]
    return f'<h2>{heading}</h2>\n<p>{_FRAMES}</p>\n{frames(pictures, frame_entries(drawn))}'
