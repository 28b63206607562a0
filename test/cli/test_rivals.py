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

"""Features and samples of other methods, from training to figures."""

import json

import numpy as np
import pytest

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.model_io.model_file import describe_model, load_model
from lsc_pose_ros.pose.features.point_features import feature_size
from lsc_pose_ros.pose.settings import FEATURES, SAMPLES

SMALL = ['--points', '100', '--query-points', '60', '--trees', '2', '--depth', '9']
JOINTS = ['--joints', 'head', 'neck', 'l_knee', '--seed', '3']
KINDS = [('2dsc', 'silhouette'), ('2dsc', 'body'), ('dcf', 'silhouette'), ('dcf', 'body'),
         ('mixed', 'silhouette'), ('3dlsc', 'body')]  # fmt: skip


@pytest.fixture(scope='module')
def recordings(people, tmp_path_factory):
    """A training recording, and a test recording of the same people."""
    paths = []
    for name, frames in (('learn', people[:120]), ('test', people[120:140])):
        paths.append(str(tmp_path_factory.mktemp('rivals') / f'{name}.mcap'))
        with RecordingWriter(paths[-1]) as writer:
            for frame in frames:
                writer.write_frame(frame)
    return paths


@pytest.fixture(scope='module', params=KINDS, ids='-'.join)
def trained(request, recordings, tmp_path_factory):
    """Feature, sample and file of one model of each kind."""
    feature, sample = request.param
    path = str(tmp_path_factory.mktemp('trained') / 'rival.npz')
    words = ['train', recordings[0], '-o', path, *SMALL, *JOINTS]
    assert main([*words, '--feature', feature, '--sample', sample]) == 0
    return feature, sample, path


def test_info_prints_feature_and_sample(trained):
    feature, sample, path = trained
    model = load_model(path)
    settings = model.settings
    assert (settings.feature, settings.sample, settings.offset_seed) == (feature, sample, 3)
    assert describe_model(model)['feature'] == feature
    assert describe_model(model)['sample'] == sample
    used = np.unique(model.forest.feature[model.forest.feature >= 0])
    assert used.max() < feature_size(settings)
    assert len(used) > 25


@pytest.mark.parametrize('graph', [True, False])
def test_all_kinds_find_the_easy_joints(graph, trained, recordings, tmp_path):
    feature, sample, path = trained
    figures = tmp_path / 'figures.json'
    words = ['evaluate', path, recordings[1], '--tolerance', '0.2', '--json', str(figures)]
    assert main([*words, *([] if graph else ['--no-graph'])]) == 0
    results = json.loads(figures.read_text())
    assert (results['feature'], results['sample']) == (feature, sample)
    assert results['map'] > 0.8
    assert results['mean_error_m'] < 0.15


def test_all_kinds_can_be_timed(trained, recordings, tmp_path, capsys):
    path = trained[2]
    figures = tmp_path / 'figures.json'
    words = ['bench', recordings[1], '--model', path, '--frames', '2', '--json', str(figures)]
    assert main(words) == 0
    capsys.readouterr()
    stages = json.loads(figures.read_text())['stages']
    assert stages['descriptors']['ms_p50'] > 0


@pytest.mark.parametrize('trained', [('dcf', 'body')], indirect=True, ids='-'.join)
def test_all_kinds_can_be_drawn(trained, recordings, tmp_path):
    words = ['view', recordings[1], '--model', trained[2], '--stages', '3']
    assert main([*words, '-o', str(tmp_path / 'stages')]) == 0
    assert len(list((tmp_path / 'stages').glob('*.png'))) == 9


@pytest.mark.parametrize(
    ('words', 'known'),
    [(['--feature', 'hog'], FEATURES), (['--sample', 'background'], SAMPLES)],
)
def test_unknown_feature_or_sample_lists_the_known_ones(
    words, known, recordings, tmp_path, capsys
):
    with pytest.raises(SystemExit) as ended:
        main(['train', recordings[0], '-o', str(tmp_path / 'me.npz'), *words])
    assert ended.value.code == 2
    error = capsys.readouterr().err
    assert all(name in error for name in known)
