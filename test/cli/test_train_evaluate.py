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

"""`lsc_pose train` and `lsc_pose evaluate`, and what they say of bad input."""

import argparse
import json
import re
from datetime import datetime, timedelta, timezone
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros import __version__
from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.commands import train_command
from lsc_pose_ros.cli.input.labelled_frames import add_recording_arguments
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.model_io.model_file import load_model


def record(path, frames):
    with RecordingWriter(path) as writer:
        for frame in frames:
            writer.write_frame(frame)
    return str(path)


@pytest.fixture(scope='module')
def recordings(people, tmp_path_factory):
    """Two recordings of the same kind of people: to learn from, and to be tested on."""
    folder = tmp_path_factory.mktemp('recordings')
    learn = record(folder / 'learn.mcap', people[:150])
    return learn, record(folder / 'bag', people[150:180])


SMALL = ['--points', '120', '--trees', '2', '--depth', '10', '--joints', 'head', 'neck', 'l_knee']


@pytest.fixture(scope='module')
def model(recordings, tmp_path_factory):
    path = tmp_path_factory.mktemp('trained') / 'me.npz'
    assert main(['train', recordings[0], '-o', str(path), *SMALL]) == 0
    return str(path)


def complaint(capsys, words, status=2):
    """Run `words`, which must fail, and return its single line on stderr."""
    assert main([str(word) for word in words]) == status
    captured = capsys.readouterr()
    lines = captured.err.strip().splitlines()
    assert len(lines) == 1, captured.err
    assert lines[0].startswith('lsc_pose: error: ')
    return lines[0]


def test_train_writes_a_model_and_its_figures(recordings, tmp_path, capsys):
    path, figures = tmp_path / 'me.npz', tmp_path / 'figures.json'
    words = ['train', *recordings, '-o', str(path), *SMALL, '--seed', '7', '--json', str(figures)]
    assert main(words) == 0
    captured = capsys.readouterr()
    assert re.match(
        r'.*me\.npz: 170 labelled bodies in all frames, 2 trees, \d+ leaves', captured.out
    )
    assert '\r' not in captured.err  # no progress bar where there is no terminal
    found = load_model(path)
    assert found.settings.points == 120
    assert found.joints.tolist() == [0, 1, 9]
    assert found.provenance['recordings'] == 'learn.mcap, bag'
    assert found.provenance['seed'] == '7'
    assert_made_as_told(found.provenance)
    results = json.loads(figures.read_text())
    assert results['people'] == 170
    assert results['points'] == 170 * 120
    assert results['calibrated'] is True
    assert results['bytes'] == path.stat().st_size
    assert sorted(p.name for p in tmp_path.iterdir()) == ['figures.json', 'me.npz']


def assert_made_as_told(provenance):
    """The model knows all that its training was told, and with which software, and when."""
    age = datetime.now(timezone.utc) - datetime.fromisoformat(provenance['date'])
    assert timedelta(0) <= age < timedelta(hours=1)
    for package in ('numpy', 'numba'):
        assert f'{package} {version(package)}' in provenance['packages']
    parser = argparse.ArgumentParser()
    train_command.add_arguments(parser)
    words = provenance['training settings'].split()
    again = vars(parser.parse_args(['learn.mcap', '-o', 'me.npz', *words]))
    told = vars(parser.parse_args(['learn.mcap', '-o', 'me.npz', *SMALL, '--seed', '7']))
    assert again == told
    # Also those that the training was not told: the defaults of a later program may differ.
    named = {word.removeprefix('--').replace('-', '_') for word in words if word[:2] == '--'}
    others = {
        'recordings',
        'output',
        'json',
        'calibrate',
        'settings',
        'mirror',
        'body_yaw',
        'resume',
    }
    frames = {action.dest for action in frame_options()}
    assert {*told} - others - frames == named


def frame_options():
    parser = argparse.ArgumentParser()
    add_recording_arguments(parser)
    return parser._actions


def test_the_same_date_makes_the_same_model(recordings, tmp_path, monkeypatch):
    monkeypatch.setenv('SOURCE_DATE_EPOCH', '1700000000')
    made = []
    for name in ('one.npz', 'other.npz'):
        words = ['train', recordings[1], '-o', str(tmp_path / name), *SMALL]
        assert main(words) == 0
        made.append((tmp_path / name).read_bytes())
    assert made[0] == made[1]
    date = load_model(tmp_path / 'one.npz').provenance['date']
    assert date == '2023-11-14T22:13:20+00:00'


def test_train_learns_from_noisy_depth_and_from_the_mirror_as_it_is_told(recordings, tmp_path):
    path = tmp_path / 'me.npz'
    noisy = ['--fewest-neighbours', '3', '--smoothing-sigma', '0.1', '--edge-threshold', '0.08']
    noisy += ['--fill-holes', '5', '--noise-factor', '3.5']
    words = ['train', recordings[1], '-o', str(path), *SMALL, *noisy, '--mirror']
    assert main([*words, '--hold-out', '0']) == 0
    found = load_model(path)
    assert found.settings.fewest_neighbours == 3
    assert found.settings.smoothing_sigma == 0.1
    assert found.settings.edge_threshold == 0.08
    assert found.settings.fill_holes == 5
    assert found.settings.noise_factor == 3.5
    assert found.settings.body_yaws == 0
    assert found.provenance['mirrored'] == 'yes'
    assert found.provenance['people'] == '60'


def test_leaves_remember_as_they_are_told(recordings, tmp_path):
    votes = {}
    for name, words in {
        'plain': [],
        'far': ['--joint-reach', '0.7'],
        'few': ['--joint-fraction', '0.6'],
        'wide': ['--vote-bandwidth', '0.4'],
    }.items():
        path = tmp_path / f'{name}.npz'
        assert main(['train', recordings[1], '-o', str(path), *SMALL, *words]) == 0
        votes[name] = len(load_model(path).forest.joint_votes.target)
    assert votes['far'] > votes['plain'] > votes['few'] > 0
    assert votes['wide'] < votes['plain']


def test_train_leaves_the_graph_as_many_candidates_as_it_is_told(recordings, tmp_path):
    path = tmp_path / 'me.npz'
    words = ['train', recordings[1], '-o', str(path), *SMALL, '--candidates', '4']
    assert main(words) == 0
    assert load_model(path).settings.candidates == 4


def test_train_tells_the_forest_where_people_face(recordings, tmp_path, capsys):
    path = tmp_path / 'me.npz'
    words = ['train', recordings[1], '-o', str(path), *SMALL, '--body-yaw']
    said = complaint(capsys, words)
    missing = 'l_shoulder, r_shoulder, l_hip, r_hip'
    assert said.endswith(f'also learn {missing}, or leave out --body-yaw')
    assert not path.exists()
    assert main([*words, '--joints', 'l_shoulder', 'r_shoulder', 'l_hip', 'r_hip']) == 0
    found = load_model(path)
    assert found.settings.body_yaws == 8
    assert found.feature_size == 362
    assert 'facing learnt' not in found.provenance
    assert main(['evaluate', str(path), recordings[1]]) == 0


@pytest.mark.parametrize(
    ('option', 'value'),
    [
        ('--fewest-neighbours', '9'),
        ('--fill-holes', '9'),
        ('--fill-holes', '-1'),
        ('--fill-holes', '2.5'),
        ('--noise-factor', '-1'),
        ('--noise-factor', 'nan'),
        ('--noise-factor', 'much'),
        ('--smoothing-sigma', '-1'),
        ('--edge-threshold', '0'),
        ('--joint-reach', '0'),
        ('--joint-fraction', '-0.1'),
        ('--vote-bandwidth', '0'),
        ('--candidates', '0'),
    ],
)
def test_train_refuses_settings_that_make_no_sense(option, value, recordings, tmp_path, capsys):
    words = ['train', recordings[0], '-o', str(tmp_path / 'me.npz'), option, value]
    with pytest.raises(SystemExit):
        main(words)
    assert option in capsys.readouterr().err


@pytest.mark.parametrize('graph', [True, False])
def test_evaluate_prints_a_table_and_writes_the_agreed_results(
    graph, model, recordings, tmp_path, capsys
):
    path = tmp_path / 'results.json'
    words = ['evaluate', model, recordings[1], '--tolerance', '0.2', '--json', str(path)]
    assert main([*words, *([] if graph else ['--no-graph'])]) == 0
    table = capsys.readouterr().out
    results = json.loads(path.read_text())
    visibility = results['visibility']
    assert [line.split()[0] for line in table.splitlines()] == [
        'joint', 'head', 'neck', 'l_knee', 'mean',
        'joints', *(name.split()[0] for name in visibility), '30', 'confidence',
    ]  # fmt: skip
    assert visibility['seen']['n'] > 0
    assert sum(score['n'] for score in visibility.values()) == 90
    assert results['frames'] == 30
    assert results['tolerance_m'] == 0.2
    assert results['graph'] is graph
    assert results['model'] == model
    assert results['recordings'] == [recordings[1]]
    assert set(results['joints']) == {'head', 'neck', 'l_knee'}
    scores = results['joints'].values()
    assert all(set(score) == {'mean_error_m', 'ap', 'n'} for score in scores)
    assert results['map'] == pytest.approx(np.mean([score['ap'] for score in scores]))
    assert results['map'] > 0.8
    assert 0 < results['mean_error_m'] < 0.15
    confidence = results['confidence']
    assert confidence['calibrated'] is True
    assert confidence['within_m'] == 0.1  # whatever the tolerance
    assert 0 <= confidence['ece'] < 0.3
    assert set(confidence['joints']) == set(results['joints'])
    assert sum(each['n'] for each in confidence['bins']) == 90
    assert all(each['least'] <= each['confidence'] <= each['most'] for each in confidence['bins'])
    assert 0 < results['ms_per_frame']['p50'] <= results['ms_per_frame']['p95']


def test_without_a_model_the_one_of_the_package_is_measured(
    model, recordings, shipped, tmp_path, capsys
):
    path = tmp_path / 'results.json'
    said = ['--json', path]
    assert 'no model comes with this' in complaint(capsys, ['evaluate', recordings[1], *said])
    for name in ('default', 'front'):
        (shipped / f'{name}.npz').write_bytes(Path(model).read_bytes())
    for words, name, count in (
        ([recordings[1]], 'default', 30),
        ([*recordings], 'default', 180),
        (['--model', 'front', recordings[1]], 'front', 30),
        (['front', *said, recordings[1]], 'front', 30),
        ([shipped / 'front.npz', recordings[1]], 'front', 30),
    ):
        assert main(['evaluate', *map(str, [*words, *said])]) == 0
        results = json.loads(path.read_text())
        assert results['model'] == str(shipped / f'{name}.npz')
        assert results['frames'] == count


def test_which_word_is_the_model_is_said_where_it_is_not_clear(
    model, recordings, shipped, tmp_path, capsys
):
    assert shipped.is_dir()
    line = complaint(capsys, ['evaluate', model])
    assert 'no recording is named; give `lsc_pose evaluate` one after the model' in line
    line = complaint(capsys, ['evaluate', model, recordings[1], '--model', tmp_path / 'b.npz'])
    assert 'two models are named' in line
    line = complaint(capsys, ['evaluate', 'backwards', recordings[1]])
    assert 'no model backwards comes with' in line
    with pytest.raises(SystemExit) as stop:
        main(['evaluate'])
    assert stop.value.code == 2


@pytest.fixture(scope='module')
def moved(recordings, people, tmp_path_factory):
    """The recording to be tested on, as other labels put it: the head 30 cm farther up."""
    frames = []
    for frame in people[150:180]:
        positions = frame.ground_truth.positions.copy()
        positions[:, frame.ground_truth.joints == 0] += np.array([0, -0.3, 0], np.float32)
        frames.append(
            frame._replace(ground_truth=frame.ground_truth._replace(positions=positions))
        )
    assert recordings
    folder = tmp_path_factory.mktemp('moved')
    return record(folder / 'fit.mcap', frames[::2]), record(folder / 'test.mcap', frames[1::2])


def test_results_with_and_without_offsets(model, moved, tmp_path, capsys):
    path = tmp_path / 'results.json'
    words = ['evaluate', model, moved[1], '--offsets-from', moved[0], '--json', str(path)]
    assert main(words) == 0
    table = capsys.readouterr().out
    assert 'with offsets' in table.splitlines()[0]
    results = json.loads(path.read_text())
    assert main(['evaluate', model, moved[1], '--json', str(path)]) == 0
    plain = json.loads(path.read_text())
    assert 'with_offsets' not in plain
    for name in ('map', 'mean_error_m', 'joints', 'confidence', 'recordings'):
        assert results[name] == plain[name]
    fitted = results['with_offsets']
    assert fitted['offsets_from'] == [moved[0]]
    assert set(fitted['offsets_m']) == set(results['joints'])
    assert fitted['offsets_m']['head'][1] == pytest.approx(-0.3, abs=0.05)
    assert abs(fitted['offsets_m']['neck'][1]) < 0.05
    assert results['joints']['head']['ap'] < 0.1
    assert fitted['joints']['head']['ap'] > 0.8
    assert fitted['map'] == pytest.approx(np.mean([s['ap'] for s in fitted['joints'].values()]))
    assert fitted['map'] > results['map'] + 0.2
    assert fitted['mean_error_m'] < results['mean_error_m'] - 0.05
    assert fitted['confidence']['ece'] < results['confidence']['ece']


def test_some_joints_only(model, recordings, tmp_path, capsys):
    path = tmp_path / 'results.json'
    words = ['evaluate', model, recordings[1], '--json', str(path)]
    assert main(words) == 0
    whole = json.loads(path.read_text())
    assert main([*words, '--joints', 'l_knee', 'head']) == 0
    some = json.loads(path.read_text())
    assert some['joints'] == {name: whole['joints'][name] for name in ('head', 'l_knee')}
    assert some['map'] == pytest.approx(np.mean([s['ap'] for s in some['joints'].values()]))
    capsys.readouterr()
    line = complaint(capsys, [*words, '--joints', 'l_hand'])
    assert 'does not estimate l_hand; its joints are head, neck, l_knee' in line


def test_recordings_for_the_offsets_need_ground_truth(model, recordings, people, tmp_path, capsys):
    path = record(tmp_path / 'bare.mcap', [f._replace(ground_truth=None) for f in people[:3]])
    words = ['evaluate', model, recordings[1], '--offsets-from', path]
    assert 'bare.mcap has no ground truth' in complaint(capsys, words)


def test_fewer_points_may_vote(model, recordings, tmp_path):
    path = tmp_path / 'results.json'
    words = ['evaluate', model, recordings[1], '--json', str(path)]
    maps = {}
    for count in (120, 30):
        assert main([*words, '--query-points', str(count)]) == 0
        results = json.loads(path.read_text())
        assert results['query_points'] == count
        maps[count] = results['mean_error_m']
    assert maps[30] != maps[120]


def test_evaluate_writes_a_report(model, recordings, tmp_path, capsys):
    assert main(['evaluate', model, recordings[1], '--report', str(tmp_path / 'page')]) == 0
    assert 'index.html' in capsys.readouterr().out
    page = (tmp_path / 'page' / 'index.html').read_text()
    assert 'l_knee' in page
    assert page.count('data:image/png;base64,') >= 4
    assert page.count('role="img"') == 4
    assert f'by lsc_pose_ros {__version__}' in page
    assert 'How the model was made' in page
    assert not re.search(r'(src|href)="?(http|//|file)', page)


def test_several_models_are_shown_side_by_side(model, recordings, tmp_path, capsys):
    folder = tmp_path / 'other'
    folder.mkdir()
    other = folder / Path(model).name
    other.write_bytes(Path(model).read_bytes())
    figures, page = tmp_path / 'both.json', tmp_path / 'page'
    words = [model, str(other), recordings[1], '--json', str(figures), '--report', str(page)]
    assert main(['evaluate', *words]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert f'other/{Path(model).stem}' in lines[0]
    mean = next(line for line in lines if line.startswith('mean')).split()
    assert mean[1:4] == mean[4:7]
    results = json.loads(figures.read_text())['models']
    assert len(results) == 2
    first, second = results.values()
    assert first['joints'] == second['joints']
    assert first['model'] == str(model)
    text = (page / 'index.html').read_text()
    assert text.count('role="img"') == 2
    assert f'other/{Path(model).stem}' in text


def test_missing_recording(model, tmp_path, capsys):
    missing = tmp_path / 'gone.mcap'
    assert 'gone.mcap' in complaint(capsys, ['evaluate', model, missing])
    assert 'gone.mcap' in complaint(capsys, ['train', missing, '-o', tmp_path / 'm.npz'])
    assert list(tmp_path.iterdir()) == []


def test_missing_and_wrong_model_file(recordings, tmp_path, capsys):
    line = complaint(capsys, ['evaluate', tmp_path / 'gone.npz', recordings[1]])
    assert 'there is no model file' in line
    other = tmp_path / 'other.npz'
    other.write_bytes(b'PK is not enough')
    line = complaint(capsys, ['evaluate', other, recordings[1]])
    assert 'other.npz is not a usable model file' in line


def test_missing_folder_is_reported_before_the_training(recordings, tmp_path, capsys):
    line = complaint(capsys, ['train', recordings[0], '-o', tmp_path / 'no' / 'm.npz', *SMALL])
    assert 'does not exist; create it first' in line


def test_unknown_joint(recordings, tmp_path, capsys):
    words = ['train', recordings[0], '-o', tmp_path / 'm.npz', '--joints', 'nose']
    assert 'unknown joint nose; the joints are head' in complaint(capsys, words)


def test_recording_without_ground_truth(model, people, tmp_path, capsys):
    path = record(tmp_path / 'bare.mcap', [f._replace(ground_truth=None) for f in people[:3]])
    assert 'has no ground truth' in complaint(capsys, ['evaluate', model, path])
    assert 'has no ground truth' in complaint(capsys, ['train', path, '-o', tmp_path / 'm.npz'])


def test_empty_masks(model, people, tmp_path, capsys):
    frames = [f._replace(labels=np.full_like(f.labels, NO_BODY)) for f in people[:3]]
    path = record(tmp_path / 'empty.mcap', frames)
    assert 'the masks of all 3 frames are empty' in complaint(capsys, ['evaluate', model, path])
    assert 'no labelled person' in complaint(capsys, ['train', path, '-o', tmp_path / 'm.npz'])


def test_mask_of_another_size(model, people, tmp_path, capsys):
    path = record(tmp_path / 'small.mcap', [f._replace(labels=f.labels[:60]) for f in people[:2]])
    line = complaint(capsys, ['evaluate', model, path])
    assert '160 x 60' in line
    assert '160 x 120' in line


def test_camera_matrix_of_zeros(model, people, tmp_path, capsys):
    frames = [f._replace(camera=Intrinsics(0.0, 0.0, 0.0, 0.0)) for f in people[:2]]
    path = record(tmp_path / 'blind.mcap', frames)
    assert 'camera_info' in complaint(capsys, ['evaluate', model, path])


def test_truncated_recording_is_used_up_to_the_damage(model, recordings, tmp_path, capsys):
    with open(recordings[0], 'rb') as file:  # noqa: PTH123
        whole = file.read()
    path = tmp_path / 'cut.mcap'
    path.write_bytes(whole[: len(whole) * 2 // 3])
    results = tmp_path / 'results.json'
    assert main(['evaluate', model, str(path), '--json', str(results)]) == 0
    frames = json.loads(results.read_text())['frames']
    assert 0 < frames < 150
    (warning,) = capsys.readouterr().err.strip().splitlines()
    assert warning.startswith('lsc_pose: warning: ')
    assert 'cut.mcap' in warning


@pytest.mark.parametrize(
    'words',
    [
        ['--points', '0'],
        ['--trees', 'many'],
        ['--depth', '-3'],
        ['--seed', 'x'],
        ['--hold-out', '0.6'],
        ['--hold-out', 'nan'],
        ['--hold-out', '0.1', '--calibrate', 'other.mcap'],
    ],
)
def test_numbers_out_of_reason_end_with_two(words, recordings, tmp_path, capsys):
    with pytest.raises(SystemExit) as stop:
        main(['train', recordings[0], '-o', str(tmp_path / 'm.npz'), *words])
    assert stop.value.code == 2
    assert words[0] in capsys.readouterr().err


def test_confidence_may_be_learnt_from_other_recordings(recordings, tmp_path, capsys):
    path, figures = tmp_path / 'me.npz', tmp_path / 'figures.json'
    words = ['train', recordings[0], '-o', str(path), *SMALL, '--json', str(figures)]
    assert main([*words, '--calibrate', recordings[1]]) == 0
    assert json.loads(figures.read_text())['people'] == 150  # nobody is held out
    assert load_model(path).provenance['confidence learnt from'] == '30 people'
    assert main(['evaluate', str(path), recordings[1]]) == 0
    assert 'not calibrated' not in capsys.readouterr().out


def test_nobody_need_be_held_out(recordings, tmp_path, capsys):
    path = tmp_path / 'me.npz'
    assert main(['train', recordings[1], '-o', str(path), *SMALL, '--hold-out', '0']) == 0
    assert len(load_model(path).calibration) == 0
    assert main(['evaluate', str(path), recordings[1]]) == 0
    assert capsys.readouterr().out.strip().endswith('not calibrated')


def test_recording_to_calibrate_with_that_shows_nobody(recordings, people, tmp_path, capsys):
    frames = [f._replace(labels=np.full_like(f.labels, NO_BODY)) for f in people[:3]]
    empty = record(tmp_path / 'empty.mcap', frames)
    words = ['train', recordings[0], '-o', tmp_path / 'm.npz', *SMALL, '--calibrate', empty]
    line = complaint(capsys, words)
    assert 'empty.mcap: no labelled person was found' in line
    assert not (tmp_path / 'm.npz').exists()


def test_negative_seed(recordings, tmp_path, capsys):
    words = ['train', recordings[0], '-o', tmp_path / 'm.npz', '--seed', '-1']
    assert '--seed -1' in complaint(capsys, words)


@pytest.mark.parametrize('tolerance', ['0', '-1', 'nan', 'wide'])
def test_impossible_tolerance(tolerance, model, recordings, capsys):
    with pytest.raises(SystemExit) as stop:
        main(['evaluate', model, recordings[1], '--tolerance', tolerance])
    assert stop.value.code == 2
    assert 'is not a number above 0' in capsys.readouterr().err
