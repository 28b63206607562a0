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

"""Command-line options that are made from the table of settings."""

import argparse
from dataclasses import asdict

import pytest

from lsc_pose_ros.cli.options.estimation_options import add_estimation_options
from lsc_pose_ros.cli.options.setting_options import add_group_options, settings_from
from lsc_pose_ros.settings.table import SETTINGS, FrameSettings, NodeSettings


@pytest.fixture
def parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser()
    add_estimation_options(parser.add_argument_group())
    add_group_options(parser, FrameSettings)
    return parser


def test_every_setting_of_the_command_line_has_its_option(
    parser: argparse.ArgumentParser,
) -> None:
    options = {name for name, setting in SETTINGS.items() if setting.command_line}
    assert set(vars(parser.parse_args([]))) == options


def test_defaults_are_those_of_the_node(parser: argparse.ArgumentParser) -> None:
    assert settings_from(parser.parse_args([]), NodeSettings) == NodeSettings()


def test_help_describes_values_and_defaults(parser: argparse.ArgumentParser) -> None:
    text = ' '.join(parser.format_help().split())
    assert '--graph, --no-graph' in text
    assert '--smoothing-beta PER_METRE how much the cutoff frequency rises' in text
    assert '(default: 8.0)' in text
    assert 'nearest: no mask is needed.' in text


def test_values_are_read(parser: argparse.ArgumentParser) -> None:
    words = '--no-graph --range-max 3 --query-points 20 --body-ids tracked --model a.npz'
    found = settings_from(parser.parse_args(words.split()), NodeSettings)
    changed = {
        'graph': False, 'range_max': 3.0, 'query_points': 20, 'body_ids': 'tracked',
        'model': 'a.npz',
    }  # fmt: skip
    assert asdict(found) == asdict(NodeSettings()) | changed
    assert isinstance(found.range_max, float)


@pytest.mark.parametrize(
    ('words', 'reason'),
    [
        ('--range-max 20.1', "'20.1' is not a number from 0.0 to 20.0"),
        ('--range-max nan', "'nan' is not a number from 0.0 to 20.0"),
        ('--smoothing-cutoff 0', "'0' is not a number from 0.01 to 100.0"),
        ('--query-points -1', "'-1' is not a whole number from 0 to 10000"),
        ('--query-points 10.5', "'10.5' is not a whole number from 0 to 10000"),
        ('--mask-background 65536', "'65536' is not a whole number from -1 to 65535"),
        ('--body-ids names', "invalid choice: 'names'"),
    ],
)
def test_values_out_of_range_are_refused(
    parser: argparse.ArgumentParser,
    words: str,
    reason: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit):
        parser.parse_args(words.split())
    assert reason in capsys.readouterr().err
