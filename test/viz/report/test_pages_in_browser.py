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

"""The pages in a real browser: on a phone and a desk, in a light and a dark scheme."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import PATIENCE
from lsc_pose_experiments.defaults import full_defaults
from lsc_pose_experiments.experiment import Experiment, rows_of
from lsc_pose_experiments.page import Page, Section, write_page
from lsc_pose_experiments.paper import EXPERIMENTS
from lsc_pose_experiments.trial import TrialResult

from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.evaluation.evaluate import Evaluation, summarise
from lsc_pose_ros.evaluation.video_scores import VideoFrame
from lsc_pose_ros.viz.drawing.svg import Chart
from lsc_pose_ros.viz.report.comparison_page import ComparedModel, write_comparison
from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame
from lsc_pose_ros.viz.report.label_page import write_label_page
from lsc_pose_ros.viz.report.report import Report, VideoSection, write_report
from lsc_pose_ros.viz.report.time_plot import joint_over_time, way_entries

PHONE, DESK = 390, 1400
TOLERANCE = 0.1
FACTS = {'model': 'default.npz', 'recordings': 'a_long_name_of_a_recording' * 4 + '.mcap'}
PROVENANCE = {'recordings': ', '.join(f'kinect_{number}.mcap' for number in range(30))}
ORIGIN = 'Made on 2026-05-04 at 03:02 UTC by lsc_pose_ros 1.2.3.'
LEAST_TEXT, LEAST_CONTRAST = 10, 4.5  # pixels of CSS; WCAG 2.1, level AA

# What a browser can tell: each function returns the texts for which it is not so.
PROBLEMS = """
() => {
  const visible = element => element.getClientRects().length > 0;
  const name = element => element.outerHTML.slice(0, 120);
  const numbers = colour => (colour.match(/[\\d.]+/g) || []).map(Number);
  const channel = value => value <= 10.31475 ? value / 3294.6
    : ((value / 255 + 0.055) / 1.055) ** 2.4;
  const luminance = ([red, green, blue]) =>
    0.2126 * channel(red) + 0.7152 * channel(green) + 0.0722 * channel(blue);
  const contrast = (first, second) => {
    const [low, high] = [luminance(first), luminance(second)].sort((a, b) => a - b);
    return (high + 0.05) / (low + 0.05);
  };
  const background = element => {
    for (let each = element; each; each = each.parentElement) {
      const colour = numbers(getComputedStyle(each).backgroundColor);
      if (colour.length === 3 || colour[3] > 0) return colour;
    }
    return [255, 255, 255];
  };
  const written = [...document.body.querySelectorAll('*')].filter(element => visible(element)
    && [...element.childNodes].some(node => node.nodeType === 3 && node.data.trim()));
  const texts = [...document.querySelectorAll('svg.chart text')];
  const size = text => {
    const matrix = text.getScreenCTM();
    return parseFloat(getComputedStyle(text).fontSize) * Math.hypot(matrix.a, matrix.b);
  };
  const inside = text => {
    const own = text.getBoundingClientRect();
    const all = text.ownerSVGElement.getBoundingClientRect();
    return own.left >= all.left - 1 && own.right <= all.right + 1
      && own.top >= all.top - 1 && own.bottom <= all.bottom + 1;
  };
  const page = document.documentElement;
  return {
    written: written.length,
    texts: texts.length,
    images: document.querySelectorAll('img, svg[role=img]').length,
    wider: [...document.querySelectorAll('body *')].filter(element => visible(element)
      && !element.closest('.scroll') && !element.closest('svg')
      && element.getBoundingClientRect().right > page.clientWidth + 1).map(name),
    overflow: page.scrollWidth - page.clientWidth,
    nameless: [...document.querySelectorAll('img, svg')].filter(image =>
      !image.getAttribute('alt') && !image.getAttribute('aria-label')
      && image.getAttribute('aria-hidden') !== 'true').map(name),
    broken: [...document.images].filter(image => !image.naturalWidth).map(name),
    tiny: texts.filter(text => size(text) < LEAST_TEXT).map(text =>
      `${text.textContent}: ${size(text)}`),
    cut: texts.filter(text => !inside(text)).map(text => text.textContent),
    faint: written.map(element => {
      const style = getComputedStyle(element);
      const colour = element instanceof SVGElement ? style.fill : style.color;
      return [contrast(numbers(colour), background(element)), name(element)];
    }).filter(([value]) => !(value >= LEAST_CONTRAST)),
    light: luminance(background(document.body)) > 0.5,
  };
}
""".replace('LEAST_TEXT', str(LEAST_TEXT)).replace('LEAST_CONTRAST', str(LEAST_CONTRAST))


def video_section() -> VideoSection:
    """A wave, and estimates that are off by a centimetre and less."""
    joints = numbers_of(('r_wrist',))

    def skeletons(x: float) -> Skeletons:
        position = np.array([[[x, 0.1, 2.5]]], np.float32)
        return Skeletons(np.ones(1, np.uint16), joints, position, np.ones((1, 1), np.float32))

    ways = {
        name: [
            VideoFrame(
                number * 33_000_000,
                skeletons(0.3 * np.sin(number / 9) + noise * (number % 3 - 1)),
                skeletons(0.3 * np.sin(number / 9)),
            )
            for number in range(90)
        ]
        for name, noise in (('frame by frame', 0.01), ('over time', 0.003))
    }
    rows = [
        ('mean error', ['0.7 cm', '0.2 cm']),
        ("95 % of the errors' changes", ['1 cm', '0 cm']),
    ]
    plot = Chart(joint_over_time(ways, 'r_wrist'), 'Three curves of a wave.')
    return VideoSection(list(ways), rows, plot, way_entries(ways), 'The position of r_wrist.')


def experiment_page() -> str:
    """The page of a figure with dots, one with a curve, and one that is not measured."""
    joints = numbers_of(DEFAULT_JOINTS)
    rng = np.random.default_rng(3)

    def section(experiment: Experiment) -> Section:
        results = {
            variant.label: TrialResult(
                joints,
                rng.gamma(2, 0.03, (60, len(joints))).astype(np.float32),
                np.linspace(0.8, 1.2, 60, dtype=np.float32),
                int(variant.x) or 100,
                1.0,
                3.2,
            )
            for variant in experiment.variants
            if variant.trial
        }
        verdicts = [claim.judge(results) for claim in experiment.claims]
        return Section(experiment, rows_of(experiment, results), verdicts)

    experiments = {name: make(full_defaults(0)) for name, make in EXPERIMENTS.items()}
    sections = [section(experiments[name]) for name in ('fig8', 'fig15')]
    unmeasured = Section(experiments['table1'], [], [])
    command = 'lsc_pose experiments OUT --recordings ' + 'a_long_name' * 9 + '.mcap'
    return write_page(Page(FACTS, ORIGIN, 'A quick run.', command, [*sections, unmeasured]))


@pytest.fixture(scope='module')
def pages(
    evaluation: Evaluation, drawn: list[DrawnFrame], tmp_path_factory: pytest.TempPathFactory
) -> dict[str, Path]:
    """Each kind of page."""
    folder = tmp_path_factory.mktemp('pages')
    summary = summarise(evaluation, TOLERANCE)
    report = Report(
        'How good default.npz is', ORIGIN, summary, evaluation, TOLERANCE, FACTS, PROVENANCE,
        drawn[:2], drawn[2:], video_section(),
    )  # fmt: skip
    models = [
        ComparedModel(name, summary, evaluation, PROVENANCE)
        for name in ('default', 'a/long/way/to/another_model_with_a_long_name', 'front')
    ]
    experiments = folder / 'experiments.html'
    experiments.write_text(experiment_page(), encoding='utf-8')
    worst = [each._replace(label=f'{each.label}: outside 3, length 2') for each in drawn]
    return {
        'evaluation': write_report(folder / 'evaluation', report),
        'comparison': write_comparison(folder / 'models', models, TOLERANCE, FACTS, ORIGIN),
        'labels': write_label_page(
            folder / 'labels', 'Labels of people.mcap', ORIGIN, FACTS, ['label again'], worst
        ),
        'experiments': experiments,
    }


@pytest.mark.parametrize('scheme', ['light', 'dark'])
@pytest.mark.parametrize('width', [PHONE, DESK])
@pytest.mark.parametrize('kind', ['evaluation', 'comparison', 'labels', 'experiments'])
def test_page_reads_well(
    browser: Any, pages: dict[str, Path], kind: str, width: int, scheme: str, tmp_path: Path
) -> None:
    page = browser.new_page(viewport={'width': width, 'height': 900}, color_scheme=scheme)
    page.set_default_timeout(PATIENCE)
    requests: list[str] = []
    page.on('request', lambda request: requests.append(request.url))
    page.goto(pages[kind].as_uri())
    found = page.evaluate(PROBLEMS)
    # Pytest keeps the folders of the last runs: to look at the pages.
    page.screenshot(path=tmp_path / f'{kind}_{width}_{scheme}.png', full_page=True)
    page.close()
    assert found.pop('written') > 10
    assert found.pop('images') > 1
    assert (found.pop('texts') > 10) == (kind != 'labels')
    assert found.pop('light') == (scheme == 'light')
    assert found.pop('overflow') == 0
    assert {name: texts for name, texts in found.items() if texts} == {}
    assert [url for url in requests if not url.startswith('data:')] == [pages[kind].as_uri()]


def test_page_of_a_wide_chart_is_found_out(browser: Any, tmp_path: Path) -> None:
    """The checks find what they look for."""
    path = tmp_path / 'bad.html'
    path.write_text(
        '<!DOCTYPE html><body style="background: #fff"><p style="color: #aaa">faint</p>'
        '<img src="gone.png"><svg class="chart" role="img" aria-label="a chart" width="700" '
        'viewBox="0 0 1400 100"><text x="1390" y="50" font-size="9">cut off</text></svg>',
        encoding='utf-8',
    )
    page = browser.new_page(viewport={'width': PHONE, 'height': 900})
    page.goto(path.as_uri())
    found = page.evaluate(PROBLEMS)
    page.close()
    assert found['overflow'] > 0
    for name in ('nameless', 'broken', 'tiny', 'cut', 'faint'):
        assert len(found[name]) == 1, name
