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

import base64
import io
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from matplotlib.artist import getp
from matplotlib.axes import Axes
from PIL import Image

from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.evaluation.confidence_reliability import measure_reliability
from lsc_pose_ros.evaluation.evaluate import Evaluation, JointScore, Summary, summarise
from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame
from lsc_pose_ros.viz.report.plots import cumulative, error_curves, joint_bars, reliability_plot
from lsc_pose_ros.viz.report.report import Report, write_report

TOLERANCE = 0.1


@pytest.fixture(scope='module')
def evaluation() -> Evaluation:
    rng = np.random.default_rng(5)
    errors = rng.gamma(2, 0.03, (40, len(DEFAULT_JOINTS))).astype(np.float32)
    errors[0, 3] = np.inf
    errors[:9, 5] = np.nan
    return Evaluation(
        numbers_of(DEFAULT_JOINTS),
        errors,
        np.arange(40),
        np.ones(40, np.uint16),
        np.full(40, 0.01),
        rng.random(errors.shape, np.float32),
        np.full((*errors.shape, 3), np.nan, np.float32),
    )


@pytest.fixture(scope='module')
def report(evaluation: Evaluation, drawn: list[DrawnFrame]) -> Report:
    return Report(
        'Mine & <others>',
        summarise(evaluation, TOLERANCE),
        evaluation,
        TOLERANCE,
        {'model': 'a<b>.npz', 'time a frame': '11 ms'},
        drawn[:2],
        drawn[2:],
    )


class Page(HTMLParser):
    """What a page shows and what it refers to."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.images: list[str] = []
        self.references: list[str] = []
        self.words: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or '' for name, value in attrs}
        if tag == 'img':
            assert values['alt']
            self.images.append(values['src'])
        elif tag != 'meta':
            self.open.append(tag)
        self.references += [values[name] for name in ('href', 'src') if name in values]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)


@pytest.fixture(scope='module')
def text(report: Report, tmp_path_factory: pytest.TempPathFactory) -> str:
    path = write_report(tmp_path_factory.mktemp('report') / 'new', report)
    assert [each.name for each in path.parent.iterdir()] == ['index.html']
    return path.read_text(encoding='utf-8')


def test_the_page_holds_its_pictures_and_refers_to_nothing_else(text: str) -> None:
    page = Page(text)
    assert page.open == []
    assert page.references == page.images
    assert len(page.images) == 5
    assert not re.search(r'https?:|//|@import|url\(', re.sub(r'base64,[\w+/=]+', '', text))
    for source in page.images:
        data = base64.b64decode(source.removeprefix('data:image/png;base64,'), validate=True)
        with Image.open(io.BytesIO(data)) as image:
            assert np.asarray(image.convert('L')).std() > 5


def test_the_page_tells_the_scores_and_the_facts(text: str, report: Report) -> None:
    words = ' '.join(Page(text).words)
    assert 'Mine & <others>' in words
    assert 'a<b>.npz' in words
    assert f'{100 * report.summary.mean_error_m:.1f} cm' in words
    assert f'{100 * report.summary.map:.1f} %' in words
    score = report.summary.joints['r_hand']
    row = f'<td>r_hand</td><td>{100 * score.mean_error_m:.1f}</td><td>{100 * score.ap:.1f}</td>'
    assert f'{row}<td>{score.n}</td>' in text
    assert text.count('<tr><td>') == len(report.summary.joints) + 1


def test_the_same_report_is_the_same_page(text: str, report: Report, tmp_path: Path) -> None:
    assert write_report(tmp_path, report).read_text(encoding='utf-8') == text


def test_a_report_without_frames_leaves_their_headings_out(report: Report, tmp_path: Path) -> None:
    text = write_report(tmp_path, report._replace(best=[], worst=[])).read_text(encoding='utf-8')
    assert 'frames</h2>' not in text
    assert len(Page(text).images) == 3


def test_cumulative_counts_what_is_within() -> None:
    rng = np.random.default_rng(1)
    errors = rng.gamma(2, 0.05, 200).astype(np.float32)
    errors[:20], errors[20:40] = np.nan, np.inf
    curve = cumulative(errors)
    labelled = errors[~np.isnan(errors)]
    wanted = [(labelled <= limit / 100).mean() * 100 for limit in curve.centimetres]
    np.testing.assert_allclose(curve.percent, wanted)
    assert curve.percent[-1] < 90


def test_cumulative_of_nothing_is_flat() -> None:
    assert (cumulative(np.full(3, np.nan, np.float32)).percent == 0).all()


def bar_sizes(axes: Axes, size: str) -> list[float]:
    """Return the width or height of each bar."""
    return [getp(bar, size) for bar in axes.patches]


def test_bars_are_as_long_as_the_scores_and_say_what_is_missing() -> None:
    summary = Summary(
        0.04,
        0.5,
        {
            'neck': JointScore(0.03, 0.75, 8),
            'l_hand': JointScore(0.05, 0.25, 8),
            'r_hand': JointScore(float('nan'), 0.0, 8),
        },
    )
    errors, shares = joint_bars(summary, TOLERANCE).axes
    assert bar_sizes(errors, 'width') == pytest.approx([3, 5, 0])
    assert bar_sizes(shares, 'width') == pytest.approx([75, 25, 0])
    assert 'no estimate' in [text.get_text() for text in errors.texts]
    assert [label.get_text() for label in errors.get_yticklabels()] == ['neck', 'hand']


def test_curves_show_the_limb_ends_that_are_labelled(evaluation: Evaluation) -> None:
    without_hands = evaluation._replace(
        joints=evaluation.joints[:6], errors=evaluation.errors[:, :6]
    )
    axes = error_curves(without_hands, TOLERANCE).axes[0]
    legend = axes.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ['all joints', 'elbows', 'wrists']


def test_reliability_is_drawn_bin_by_bin(evaluation: Evaluation, text: str) -> None:
    reliability = measure_reliability(evaluation)
    shares, counts = reliability_plot(reliability).axes
    drawn = shares.lines[1].get_xydata()
    wanted = [(100 * each.confidence, 100 * each.fraction) for each in reliability.bins]
    np.testing.assert_allclose(drawn, wanted)
    assert sum(bar_sizes(counts, 'height')) == pytest.approx(100)
    assert f'off by {100 * reliability.ece:.1f} %' in text
