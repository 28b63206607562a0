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

"""No output is an input, under whatever name."""

import os
from pathlib import Path

import pytest

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import JSON, TEXT
from lsc_pose_ros.files.output_check import Output, check_outputs


def check(output: Path, given: Path) -> None:
    check_outputs([Output(output, TEXT)], [given])


@pytest.fixture
def recording(tmp_path):
    path = tmp_path / 'k.mcap'
    path.write_text('recorded')
    return path


def test_the_same_name(recording):
    with pytest.raises(InputError, match=r'k\.mcap is the input .*k\.mcap; choose another name'):
        check(recording, recording)


def test_links_to_it_and_it_behind_a_link(recording, tmp_path):
    (tmp_path / 'link').symlink_to(recording)
    os.link(recording, tmp_path / 'hard')
    for other in (tmp_path / 'link', tmp_path / 'hard', tmp_path / '.' / 'k.mcap'):
        for output, given in ((other, recording), (recording, other)):
            with pytest.raises(InputError, match='is the input'):
                check(output, given)


def test_file_of_an_input_folder(recording, tmp_path):
    (tmp_path / 'bag' / 'deep').mkdir(parents=True)
    os.link(recording, tmp_path / 'bag' / 'deep' / 'k_0.mcap')
    with pytest.raises(InputError, match=r'k\.mcap is a file of the input .*bag; choose another'):
        check(recording, tmp_path / 'bag')


def test_two_outputs_are_one_file(tmp_path):
    (tmp_path / 'link').symlink_to('new')
    outputs = [Output(tmp_path / 'new', TEXT), Output(tmp_path / 'link', JSON)]
    with pytest.raises(InputError, match='are one file'):
        check_outputs(outputs, [])
    check_outputs([Output(Path('/dev/null'), TEXT)] * 2, [])


def test_other_names_are_fine(recording, tmp_path):
    check(tmp_path / 'new', recording)
    check(tmp_path / 'new', tmp_path / 'missing')
    (tmp_path / 'old').write_text('text')
    check(tmp_path / 'old', recording)


def test_devices_may_be_read_and_written():
    check(Path('/dev/null'), Path('/dev/null'))


def test_other_kinds_are_refused(recording):
    with pytest.raises(InputError, match='not a JSON file'):
        check_outputs([Output(recording, JSON)], [])


@pytest.mark.parametrize('name', ['-', '/dev/stdout', '/dev/fd/1'])
def test_two_outputs_are_one_stream(name):
    with pytest.raises(InputError, match='two outputs go to -'):
        check_outputs([Output(Path('-'), TEXT), Output(Path(name), JSON)], [])


def test_two_outputs_may_be_thrown_away():
    check_outputs([Output(Path('/dev/null'), TEXT), Output(Path('/dev/null'), JSON)], [])
