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

"""`lsc_pose experiments`."""

import base64
import csv
import json
import re
from html.parser import HTMLParser

import pytest
from lsc_pose_experiments.defaults import full_defaults, quick_defaults
from lsc_pose_experiments.paper import EXPERIMENTS
from lsc_pose_experiments.publishing import Publisher
from PIL import Image

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.main import main

NAMES = [
    'table1', 'table2', 'fig6', 'fig7', 'fig8', 'fig9', 'fig11', 'fig12', 'fig13', 'fig14',
    'fig15', 'systems',
]  # fmt: skip


@pytest.fixture(scope='module')
def recordings(people, tmp_path_factory):
    """Two recordings of similar people."""
    paths = []
    for name, frames in (('one', people[:60]), ('two', people[60:120])):
        paths.append(str(tmp_path_factory.mktemp('recordings') / f'{name}.mcap'))
        with RecordingWriter(paths[-1]) as writer:
            for frame in frames:
                writer.write_frame(frame)
    return paths


def experiments(folder, recordings, *words):
    return main(['experiments', str(folder), '--recordings', *recordings, '--quick', *words])


@pytest.fixture(scope='module')
def measured(recordings, tmp_path_factory):
    """The folder and the results of all experiments, with --quick."""
    folder = tmp_path_factory.mktemp('experiments') / 'out'
    path = folder.parent / 'results.json'
    assert experiments(folder, recordings, '--json', str(path)) == 0
    return folder, json.loads(path.read_text())


class Tags(HTMLParser):
    """Collects sections, figures and links of a page, and checks that all tags are closed."""

    def __init__(self):
        super().__init__()
        self.sections, self.links, self.open, self.charts = [], [], [], 0

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        if tag == 'section':
            self.sections.append(given['id'])
        self.links += [given['href']] if tag == 'a' else []
        self.charts += given.get('role') == 'img'
        if tag not in {'meta', 'img'}:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def read_page(folder):
    tags = Tags()
    text = (folder / 'index.html').read_text()
    tags.feed(text)
    assert tags.open == []
    return text, tags


def test_page_has_all_sections_and_their_tables(measured):
    folder, _ = measured
    text, tags = read_page(folder)
    assert tags.sections == list(EXPERIMENTS) == NAMES
    assert 'Not measured yet' not in text
    assert 'A quick run' in text
    inside = [link for link in tags.links if link.startswith('#')]
    assert {link[1:] for link in inside} <= set(NAMES)
    tables = [
        base64.b64decode(link.rpartition(',')[2]) for link in tags.links if link not in inside
    ]
    assert tables == [(folder / f'{name}.csv').read_bytes() for name in NAMES]
    assert tags.charts == 2 * len(NAMES)
    for name in NAMES:
        with Image.open(folder / f'{name}.png') as picture:
            picture.load()
            assert min(picture.size) > 100
    assert not list(folder.glob('.*'))


def test_page_has_measured_numbers_and_those_of_the_paper(measured):
    folder, results = measured
    text, _ = read_page(folder)
    section = text[text.index('<section id="table2">') :].partition('</section>')[0]
    found = {
        row['variant']: row
        for row in results['experiments']['table2']['rows']
        if row['part'] == 'mean'
    }
    for label, paper in (('3DLSC', 98.2), ('DCF', 97.6), ('2DSC', 87.6)):
        ours = f'{100 * found[label]["ap"]:.1f}'
        line = re.search(rf'<td>{label}</td><td>all joints</td>.*', section).group()
        assert f'<td>{ours}</td><td class="muted">{paper}</td>' in line
        assert '<td class="muted">not in the text</td>' in line
    assert re.search(r'<b>(holds|does not hold|undecided)</b>', section)


def test_rival_is_measured_beside_the_method(measured):
    folder, results = measured
    text, _ = read_page(folder)
    section = text[text.index('<section id="fig8">') :].partition('</section>')[0]
    found = {
        row['variant']: row
        for row in results['experiments']['fig8']['rows']
        if row['part'] == 'mean'
    }
    assert list(found) == ['ours (3DLSC + graph)', 'Shotton et al.']
    assert found['Shotton et al.']['training_frames'] == 60
    assert 0.1 < found['Shotton et al.']['ap'] < 1
    for label, row in found.items():
        line = re.search(rf'<td>{re.escape(label)}</td><td>all joints</td>.*', section).group()
        assert f'<td>{100 * row["ap"]:.1f}</td>' in line
        assert line.endswith(f'<td>{row["frame_ms"]:.1f}</td></tr>')


def test_csv_and_json_have_the_same_numbers(measured):
    folder, results = measured
    for name, found in results['experiments'].items():
        with (folder / f'{name}.csv').open(newline='') as file:
            rows = list(csv.DictReader(file))
        assert len(rows) == len(found['rows']) > 10
        for row, same in zip(rows, found['rows'], strict=True):
            for column, value in same.items():
                assert row[column] == ('' if value is None else str(value))
        assert {claim['holds'] for claim in found['claims']} <= {True, False, None}


def test_equal_trials_have_equal_numbers_everywhere(measured):
    _, results = measured
    means = {
        (name, row['variant']): row['ap']
        for name, found in results['experiments'].items()
        for row in found['rows']
        if row['part'] == 'mean'
    }
    ours = means['fig9', 'ours (3DLSC + graph)']
    assert ours == means['table2', '3DLSC'] == means['fig12', '80'] == means['fig14', '200']
    assert ours == means['fig13', 'normalised (each body its own)'] == means['fig15', '60 frames']
    assert means['fig9', 'without the graph'] != ours
    assert means['fig11', 'without multi-binning'] != ours


def test_nothing_is_measured_twice(measured, recordings, monkeypatch):
    folder, _ = measured
    before = {path: path.stat().st_mtime_ns for path in (folder / 'trials').iterdir()}
    assert len(before) == 22
    for name in ('train_on', 'RIVALS'):
        monkeypatch.setattr(f'lsc_pose_experiments.running.{name}', None)
    assert experiments(folder, recordings) == 0
    assert before == {path: path.stat().st_mtime_ns for path in (folder / 'trials').iterdir()}


def test_single_experiment_can_be_measured(recordings, tmp_path, capsys):
    out = tmp_path / 'out'
    assert experiments(out, recordings, '--only', 'fig9', '--seed', '2') == 0
    printed = capsys.readouterr().out
    assert 'Fig. 9' in printed
    assert 'Table 1' not in printed
    files = sorted(path.name for path in out.iterdir())
    assert files == ['fig9.csv', 'fig9.png', 'index.html', 'trials']
    assert len(list((out / 'trials').iterdir())) == 2
    text, tags = read_page(out)
    assert tags.sections == NAMES
    assert text.count('Not measured yet') == len(NAMES) - 1
    command = re.search(r'<code>(lsc_pose experiments .* --only table1)</code>', text).group(1)
    assert '--quick' in command
    assert '--seed 2' in command


@pytest.mark.parametrize('protocol', ['recordings', 'leave-one-out'])
def test_other_protocols(protocol, recordings, tmp_path):
    path = tmp_path / 'results.json'
    words = ['--protocol', protocol, '--only', 'fig8', '--json', str(path)]
    words += ['--training-frames', '30', '--test-frames', '10']
    given = recordings
    if protocol == 'recordings':
        given = recordings[:1]
        words = [*words[2:], '--test', recordings[1]]  # implies the protocol
    assert experiments(tmp_path / 'out', given, *words) == 0
    results = json.loads(path.read_text())
    assert results['protocol'].startswith(protocol)
    row = results['experiments']['fig8']['rows'][0]
    assert row['people'] == (10 if protocol == 'recordings' else 20)
    assert row['training_frames'] == 30


def complaint(capsys, *words):
    """Return the single line of the error that `words` end with."""
    assert main([str(word) for word in words]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    return line


def test_bad_input_is_reported_before_any_work(recordings, people, tmp_path, capsys):
    out = tmp_path / 'out'
    start = 'experiments', out, '--recordings'
    missing = tmp_path / 'gone.mcap'
    assert 'gone.mcap' in complaint(capsys, *start, missing)
    assert 'needs --test' in complaint(capsys, *start, recordings[0], '--protocol', 'recordings')
    line = complaint(capsys, *start, recordings[0], '--protocol', 'leave-one-out')
    assert 'two --recordings or more' in line
    line = complaint(capsys, *start, recordings[0], '--test', recordings[0])
    assert 'named twice' in line
    assert '--seed -1' in complaint(capsys, *start, recordings[0], '--seed', '-1')
    bare = tmp_path / 'bare.mcap'
    with RecordingWriter(bare) as writer:
        writer.write_frame(people[0]._replace(ground_truth=None))
    assert 'has no ground truth' in complaint(capsys, *start, bare)
    assert not out.exists()
    (tmp_path / 'file').write_text('')
    line = complaint(capsys, 'experiments', tmp_path / 'file', '--recordings', recordings[0])
    assert 'file is no folder; choose another name' in line


def test_unknown_experiment_lists_the_known_ones(recordings, tmp_path, capsys):
    with pytest.raises(SystemExit) as end:
        experiments(tmp_path, recordings, '--only', 'fig10')
    assert end.value.code == 2
    assert 'fig15' in capsys.readouterr().err


@pytest.mark.parametrize('defaults', [full_defaults(0), quick_defaults(0)])
def test_all_definitions_are_consistent(defaults):
    for name, make in EXPERIMENTS.items():
        experiment = make(defaults)
        labels = [variant.label for variant in experiment.variants]
        assert experiment.name == name
        assert experiment.claims
        assert len(set(labels)) == len(labels)
        assert any(variant.trial for variant in experiment.variants)


def test_full_defaults_are_those_of_the_paper():
    made = {name: make(full_defaults(0)) for name, make in EXPERIMENTS.items()}
    assert [v.x for v in made['fig12'].variants] == list(range(100, 901, 100))
    assert [v.trial.frames for v in made['fig15'].variants] == [450, 900, 1800, 3600, 7200, 10000]
    scales = [v.trial.training.settings.fixed_scale for v in made['fig13'].variants]
    assert scales == [0, 0.3, 0.5, 0.8]
    votes = [v.trial.training.settings.heaviest_votes for v in made['fig14'].variants]
    assert (votes[0], votes[-1]) == (1, 500)
    for variant in made['fig12'].variants:
        settings = variant.trial.training.settings
        assert settings.points == settings.query_points == variant.x


def test_finished_experiments_are_written_immediately(recordings, tmp_path, monkeypatch):
    written = []

    def spy(publisher, context, _original=Publisher.publish):
        page = _original(publisher, context)
        written.append([s.experiment.name for s in page.sections if s.rows])
        return page

    monkeypatch.setattr(Publisher, 'publish', spy)
    assert experiments(tmp_path / 'out', recordings, '--only', 'fig8', 'fig9') == 0
    # The rival of Fig. 8 is measured last.
    assert written == [[], ['fig9'], ['fig8', 'fig9'], ['fig8', 'fig9']]
