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

"""The table of settings, and the documents that are made from it."""

from dataclasses import fields
from pathlib import Path

import pytest
import yaml

from lsc_pose_ros.settings.documents import markdown_table, with_table, yaml_file
from lsc_pose_ros.settings.setting import Change
from lsc_pose_ros.settings.table import SECTIONS, SETTINGS, NodeSettings

ROOT = Path(__file__).resolve().parents[2]
YAML = ROOT / 'lsc_pose_ros' / 'resources' / 'config' / 'pose_node.yaml'
PAGE = ROOT / 'docs' / 'parameters.md'


def test_pose_node_yaml_is_made_from_the_table() -> None:
    assert YAML.read_text(encoding='utf-8') == yaml_file(), 'run `make settings`'


def test_page_of_parameters_is_made_from_the_table() -> None:
    text = PAGE.read_text(encoding='utf-8')
    assert with_table(text) == text, 'run `make settings`'
    assert markdown_table() in text


def test_page_without_marks_is_refused() -> None:
    with pytest.raises(ValueError, match='settings: begin'):
        with_table('# Parameters\n')


def test_file_explains_every_parameter_with_its_default() -> None:
    text = yaml_file()
    values = yaml.safe_load(text)['/**']['ros__parameters']
    assert values == {name: declared.default for name, declared in SETTINGS.items()}
    assert list(map(type, values.values())) == [type(each.default) for each in SETTINGS.values()]
    for name, declared in SETTINGS.items():
        comment = text.partition(f'\n    {name}:')[0].rpartition('\n\n')[2]
        assert comment.count('#') > 0, name
        for choice in declared.choices:
            assert choice in comment, name
        if declared.highest is not None:
            assert str(declared.lowest) in comment, name
            assert str(declared.highest) in comment, name
        assert ('at any time' in comment) == (declared.change == Change.ANY_TIME), name


def test_values_are_named_and_typed_as_declared() -> None:
    types = {each.name: each.type for each in fields(NodeSettings)}
    assert {name: type(declared.default) for name, declared in SETTINGS.items()} == types


def test_every_setting_is_listed_once() -> None:
    listed = [
        each.name for groups in SECTIONS.values() for group in groups for each in fields(group)
    ]
    assert listed == list(SETTINGS)


@pytest.mark.parametrize('name', SETTINGS)
def test_setting_is_complete(name: str) -> None:
    declared = SETTINGS[name]
    assert declared.description.endswith('.')
    assert '\n' not in declared.description
    if declared.choices:
        assert declared.default in declared.choices
    is_number = isinstance(declared.default, int | float) and not isinstance(
        declared.default, bool
    )
    assert (declared.lowest is not None) == (declared.highest is not None) == is_number
    if declared.lowest is not None and declared.highest is not None:
        assert isinstance(declared.default, int | float)
        assert declared.lowest <= declared.default <= declared.highest
        assert type(declared.lowest) is type(declared.highest) is type(declared.default)
