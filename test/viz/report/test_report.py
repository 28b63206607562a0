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

"""The page of an evaluation."""

import base64
import io
import re
from datetime import datetime, timezone
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from lsc_pose_ros.evaluation.confidence_reliability import measure_reliability
from lsc_pose_ros.evaluation.evaluate import Evaluation, summarise
from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame, caption, description
from lsc_pose_ros.viz.report.page_parts import origin_of
from lsc_pose_ros.viz.report.report import Report, write_report

TOLERANCE = 0.1


@pytest.fixture(scope='module')
def report(evaluation: Evaluation, drawn: list[DrawnFrame]) -> Report:
    return Report(
        'Mine & <others>',
        origin_of('1.2.3', datetime(2026, 5, 4, 3, 2, tzinfo=timezone.utc)),
        summarise(evaluation, TOLERANCE),
        evaluation,
        TOLERANCE,
        {'model': 'a<b>.npz', 'time a frame': '11 ms'},
        {'seed': '20 & 1'},
        drawn[:2],
        drawn[2:],
    )


class Page(HTMLParser):
    """The images, references and words of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.images: list[str] = []
        self.charts = 0
        self.references: list[str] = []
        self.identifiers: list[str] = []
        self.words: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or '' for name, value in attrs}
        if tag == 'img':
            assert values['alt']
            self.images.append(values['src'])
        elif tag == 'svg':
            assert values.get('aria-label') or values.get('aria-hidden') == 'true'
            self.charts += 'aria-label' in values
            self.open.append(tag)
        elif tag != 'meta':
            self.open.append(tag)
        self.references += [values[name] for name in ('href', 'src') if name in values]
        self.identifiers += [values['id']] if 'id' in values else []

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)


@pytest.fixture(scope='module')
def text(report: Report, tmp_path_factory: pytest.TempPathFactory) -> str:
    path = write_report(tmp_path_factory.mktemp('report') / 'new', report)
    assert [each.name for each in path.parent.iterdir()] == ['index.html']
    return path.read_text(encoding='utf-8')


def test_page_contains_its_figures_and_refers_to_nothing_else(text: str) -> None:
    page = Page(text)
    assert page.open == []
    inside = [reference for reference in page.references if reference.startswith('#')]
    assert {reference[1:] for reference in inside} <= set(page.identifiers)
    assert [each for each in page.references if each not in inside] == page.images
    assert (len(page.images), page.charts) == (3, 4)
    prose = re.sub(r'base64,[\w+/=]+', '', text)
    assert not re.search(r'https?:|//|@import|url\((?!#)', prose)
    for source in page.images:
        data = base64.b64decode(source.removeprefix('data:image/png;base64,'), validate=True)
        with Image.open(io.BytesIO(data)) as image:
            assert np.asarray(image.convert('L')).std() > 5


def test_page_has_the_scores_and_the_facts(text: str, report: Report) -> None:
    words = ' '.join(Page(text).words)
    assert 'Mine & <others>' in words
    assert 'a<b>.npz' in words
    assert '20 & 1' in words
    assert f'{100 * report.summary.mean_error_m:.1f} cm' in words
    assert f'{100 * report.summary.map:.1f} %' in words
    score = report.summary.joints['r_hand']
    row = f'<td>r_hand</td><td>{100 * score.mean_error_m:.1f}</td><td>{100 * score.ap:.1f}</td>'
    assert f'{row}<td>{score.n}</td>' in text
    assert text.count('<tr><td>') == len(report.summary.joints) + 1


def test_same_report_is_the_same_page(text: str, report: Report, tmp_path: Path) -> None:
    assert write_report(tmp_path, report).read_text(encoding='utf-8') == text


def test_report_without_frames_omits_their_headings(report: Report, tmp_path: Path) -> None:
    text = write_report(tmp_path, report._replace(best=[], worst=[])).read_text(encoding='utf-8')
    assert 'frames</h2>' not in text
    assert (len(Page(text).images), Page(text).charts) == (0, 4)


def test_page_says_when_and_by_what_it_was_made(text: str) -> None:
    assert 'Made on 2026-05-04 at 03:02 UTC by lsc_pose_ros 1.2.3.' in text


def test_charts_have_no_colour_of_their_own(text: str) -> None:
    """Colours are variables of the page, so that a dark scheme can change them."""
    charts = re.findall(r'<svg class="chart".*?</svg>', text)
    assert len(charts) == 4
    for chart in charts:
        assert 'var(--' in chart
        assert not re.search(
            r'#[0-9a-fA-F]{6}\b(?!-)', re.sub(r'url\(#[^)]*\)|"#[^"]*"', '', chart)
        )


def test_alternative_text_of_a_frame_names_its_error(text: str, drawn: list[DrawnFrame]) -> None:
    assert f'alt="{description(drawn[0])}"' in text
    assert description(drawn[0]).startswith(caption(drawn[0]) + '. 1 person in grey depth')
    assert 'farthest off is' in description(drawn[0])


def test_page_has_the_expected_calibration_error(evaluation: Evaluation, text: str) -> None:
    assert f'off by {100 * measure_reliability(evaluation).ece:.1f} %' in text
