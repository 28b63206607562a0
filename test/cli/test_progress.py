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

"""Progress in a log, --quiet and --verbose, settings from a file, completion."""

import argparse
import os
import subprocess
import sys

import pytest

from lsc_pose_ros.cli.commands import train_command
from lsc_pose_ros.cli.options.settings_file import use_settings_file
from lsc_pose_ros.cli.output.progress import (
    LogLines,
    Reporter,
    add_verbosity_options,
    with_lines,
)
from lsc_pose_ros.errors import InputError


def test_a_log_gets_a_line_now_and_then(capsys):
    seconds = iter(range(0, 1000, 10))
    lines = LogLines(30, lambda: next(seconds))
    assert list(with_lines('abcdefgh', 8, 'reading', lines)) == list('abcdefgh')
    assert capsys.readouterr().err.splitlines() == [
        'lsc_pose: reading: 3 of 8',
        'lsc_pose: reading: 6 of 8',
    ]


@pytest.mark.parametrize(
    ('words', 'told'), [([], ''), (['--verbose'], 'lsc_pose: growing\n'), (['--quiet'], '')]
)
def test_steps_are_told_as_asked(words, told, capsys):
    parser = argparse.ArgumentParser()
    add_verbosity_options(parser)
    reporter = Reporter()
    reporter.set(parser.parse_args(words))
    reporter.step('growing')
    assert capsys.readouterr().err == told


def parser_with(settings, tmp_path, *words):
    path = tmp_path / 'settings.yaml'
    path.write_text(settings)
    parser = argparse.ArgumentParser()
    train_command.add_arguments(parser)
    line = ['a.mcap', '-o', 'm.npz', '--settings', str(path), *words]
    use_settings_file(parser, line)
    return parser.parse_args(line)


def test_settings_of_a_training_from_a_file(tmp_path):
    settings = 'trees: 5\nleaf-samples: 7\nmirror: true\njoints: [head, neck]\nfeature: mixed\n'
    arguments = parser_with(settings, tmp_path, '--trees', '2')
    assert (arguments.trees, arguments.leaf_samples, arguments.mirror) == (2, 7, True)
    assert arguments.joints == ['head', 'neck']
    assert arguments.feature == 'mixed'
    assert arguments.depth == parser_with('{}', tmp_path).depth


@pytest.mark.parametrize(
    ('settings', 'reason'),
    [
        ('tree: 5', 'tree is not a setting'),
        ('output: x.npz', 'output is not a setting'),
        ('trees: many', 'trees'),
        ('mirror: 3', 'give true or false'),
        ('feature: best', 'give one of'),
        ('- 1', 'no table of settings'),
        ('a: [', 'settings.yaml is not valid YAML: line 1'),
        ('trees: [1, 2]', 'trees: give one value'),
        ('joints: []', 'joints: give one value or more'),
        ('trees: {a: 1}', 'trees: give one value'),
        ('model: null', 'is not a setting'),
        ('feature: null', 'feature: give one value'),
        ('trees: 1\ntrees: 2', 'line 2: the key trees occurs twice'),
    ],
)
def test_unusable_settings_are_told(settings, reason, tmp_path):
    with pytest.raises(InputError, match=reason):
        parser_with(settings, tmp_path)


def test_words_are_completed(tmp_path):
    pytest.importorskip('argcomplete')
    answer = tmp_path / 'answer'
    for line, expected in (('lsc_pose exp', 'export '), ('lsc_pose export --wi', '--wide ')):
        environment = {
            **os.environ, '_ARGCOMPLETE': '1', 'COMP_LINE': line, 'COMP_POINT': str(len(line)),
            '_ARGCOMPLETE_IFS': '\n', 'COMP_TYPE': '9',
            '_ARGCOMPLETE_STDOUT_FILENAME': str(answer),
        }  # fmt: skip
        subprocess.run(
            [sys.executable, '-m', 'lsc_pose_ros'], env=environment, check=False, timeout=120
        )
        assert expected.strip() in answer.read_text().split()
