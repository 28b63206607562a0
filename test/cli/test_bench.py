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

"""`lsc_pose bench`."""

import json

import numpy as np
import pytest

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.commands import bench_command
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.cli.output.bench_results import bench_results
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.evaluation.benchmark import FrameTimes
from lsc_pose_ros.evaluation.encoded_frame import encode_frame
from lsc_pose_ros.model_io.model_file import load_model

STAGES = [
    'decode', 'window', 'silhouette', 'descriptors', 'leaves', 'votes', 'modes', 'graph',
    'confidence', 'whole',
]  # fmt: skip


@pytest.fixture(scope='module')
def recording(people, tmp_path_factory):
    path = tmp_path_factory.mktemp('recording') / 'people.mcap'
    with RecordingWriter(path) as writer:
        for frame in people[:40]:
            writer.write_frame(frame)
    return str(path)


def complaint(capsys, words):
    """Run the command with `words`, which end with status 2; return its single error line."""
    assert main([str(word) for word in words]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    return line


def bench(*words, folder):
    """Run `lsc_pose bench` with `words`; return the JSON results."""
    path = folder / 'bench.json'
    assert main(['bench', *map(str, words), '--json', str(path)]) == 0
    return json.loads(path.read_text())


def test_recording_is_timed(small_model_file, recording, tmp_path, capsys):
    words = [recording, '--model', small_model_file, '--frames', 8]
    results = bench(*words, folder=tmp_path)
    assert results['frames'] == 8
    assert results['size'] == '160x120'
    assert results['points'] == results['query_points'] == 150
    assert (results['trees'], results['joints']) == (2, 8)
    assert results['bodies_per_frame'] == 1
    assert results['model'] == str(small_model_file)
    assert results['recording'] == recording
    assert list(results['stages']) == STAGES
    for stage in results['stages'].values():
        assert set(stage) == {'ms_p50', 'ms_p95'}
        assert 0 < stage['ms_p50'] <= stage['ms_p95']
    # No mean of positive numbers is below half of their median.
    assert 0 < results['frames_per_second'] <= 2000 / results['stages']['whole']['ms_p50']
    assert set(results['versions']) == {'lsc_pose_ros', 'python', 'numpy', 'numba'}
    assert results['machine']['cores_used'] == 1
    assert results['machine']['processor']

    table = capsys.readouterr().out.splitlines()
    assert [line[:20].strip() for line in table[1:11]] == STAGES
    assert '8 frames of 160x120' in table[12]


def test_frames_per_second_are_those_of_all_frames_together(small_model_file, people):
    model, frame = load_model(small_model_file), encode_frame(people[0])
    times = [
        FrameTimes(dict.fromkeys(STAGES, seconds), np.zeros((1, 8, 3), np.float32))
        for seconds in (0.001, 0.001, 0.007)
    ]
    results = bench_results(model, [frame] * 3, times)
    assert results['frames_per_second'] == pytest.approx(3 / 0.009)


def test_synthetic_frames_have_the_size_and_the_people_asked_for(small_model_file, tmp_path):
    words = ['--model', small_model_file, '--frames', 4, '--size', '200x150', '--people', 2]
    results = bench(*words, '--points', 90, '--query-points', 30, folder=tmp_path)
    assert results['size'] == '200x150'
    assert results['frames'] == 4
    assert results['bodies_per_frame'] == 2
    assert (results['points'], results['query_points']) == (90, 30)
    assert results['recording'] == 'synthetic'


def test_all_points_vote_if_there_are_fewer_than_the_models_query_points(
    small_model_file, tmp_path
):
    words = ['--model', small_model_file, '--frames', 1, '--points', 80]
    results = bench(*words, folder=tmp_path)
    assert results['points'] == results['query_points'] == 80


def test_without_any_model_a_small_one_is_trained_with_a_note(
    shipped, monkeypatch, tmp_path, capsys
):
    assert not list(shipped.iterdir())
    quick = bench_command.TRAINING._replace(frames=6, width=160, height=120)
    monkeypatch.setattr(bench_command, 'TRAINING', quick)
    results = bench('--frames', 2, '--size', '160x120', '--points', 60, folder=tmp_path)
    assert results['model'] == 'trained in this run on 6 synthetic frames'
    assert results['joints'] == 17
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert 'trained in this run on 6 synthetic frames' in line


@pytest.mark.parametrize(('name', 'words'), [('default', ()), ('front', ('--model', 'front'))])
def test_models_of_the_package(name, words, small_model_file, shipped, tmp_path):
    path = shipped / f'{name}.npz'
    path.write_bytes(small_model_file.read_bytes())
    results = bench('--frames', 1, '--size', '160x120', *words, folder=tmp_path)
    assert results['model'] == str(path)
    assert results['joints'] == len(load_model(small_model_file).joints)


def test_training_and_timing_are_of_different_people():
    assert bench_command.TRAINING.seed != bench_command.TIMED.seed


def test_number_of_frames_without_people_is_printed(small_model_file, people, tmp_path, capsys):
    path = tmp_path / 'partly.mcap'
    nobody = np.full_like(people[0].labels, NO_BODY)
    with RecordingWriter(path) as writer:
        for number, frame in enumerate(people[:6]):
            writer.write_frame(frame._replace(labels=nobody) if number < 2 else frame)
    assert bench(path, '--model', small_model_file, folder=tmp_path)['frames'] == 4
    assert '2 of 6 frames show too little of a person' in capsys.readouterr().err


def test_recording_of_nobody(small_model_file, people, tmp_path, capsys):
    path = tmp_path / 'empty.mcap'
    with RecordingWriter(path) as writer:
        for frame in people[:3]:
            writer.write_frame(frame._replace(labels=np.full_like(frame.labels, NO_BODY)))
    line = complaint(capsys, ['bench', path, '--model', small_model_file])
    assert 'too little of a person is visible in each of 3 frames' in line


@pytest.mark.parametrize('words', [['--size', '320x240'], ['--people', '2']])
def test_options_of_synthetic_frames_are_refused_with_a_recording(words, recording, capsys):
    line = complaint(capsys, ['bench', recording, *words])
    assert '--size and --people are for synthetic frames' in line


def test_more_votes_than_points(small_model_file, capsys):
    words = ['bench', '--model', small_model_file, '--frames', '1', '--query-points', '151']
    assert '--query-points 151 of 150 points' in complaint(capsys, words)


def test_missing_recording_and_missing_model(recording, tmp_path, capsys):
    assert 'gone.mcap' in complaint(capsys, ['bench', tmp_path / 'gone.mcap'])
    words = ['bench', recording, '--model', tmp_path / 'gone.npz']
    assert 'gone.npz' in complaint(capsys, words)


@pytest.mark.parametrize(
    'words', [['--size', 'large'], ['--size', '320'], ['--frames', '0'], ['--points', '-1']]
)
def test_invalid_values_end_with_status_2(words, capsys):
    with pytest.raises(SystemExit) as stop:
        main(['bench', *words])
    assert stop.value.code == 2
    assert words[0] in capsys.readouterr().err


def test_size_that_cannot_be_generated(small_model_file, capsys):
    words = ['bench', '--model', small_model_file, '--size', '4x4']
    assert 'size is 4x4' in complaint(capsys, words)
