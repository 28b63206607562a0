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

"""What strangers have written is cut in what is printed, and cannot control the terminal."""

import pytest
from tiny_model import tiny_model

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.bags.topics import DEFAULT_TOPICS
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.cli.output.progress import warn
from lsc_pose_ros.cli.output.terminal_text import line_of, name_of
from lsc_pose_ros.errors import LONGEST_TEXT
from lsc_pose_ros.model_io.model_file import save_model

CONTROL = '\x1b[2J\x07\x9b31m\r'


def test_text_is_one_line_that_controls_nothing():
    assert line_of('two\nlines,\ttabs') == 'two lines, tabs'
    assert line_of(f'a{CONTROL}b') == r'a\x1b[2J\x07\x9b31m b'
    assert line_of('Körper \U0001f600 \udcff') == 'Körper \U0001f600 \udcff'
    assert line_of('right to left: \u202e') == r'right to left: \u202e'


def test_long_texts_are_cut():
    assert len(line_of('x' * 10**6)) < LONGEST_TEXT + 50
    assert line_of('x' * LONGEST_TEXT) == 'x' * LONGEST_TEXT
    assert len(name_of('x' * 10**6)) == 100
    assert name_of('/depth/image') == '/depth/image'


def test_warnings_are_lines(capsys):
    warn(f'{CONTROL}\n' * 10**5)
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(r'lsc_pose: warning: \x1b[2J')
    assert len(line) < 10 * LONGEST_TEXT
    assert line.isprintable()


@pytest.fixture
def strange(tmp_path, simple_frames):
    """A recording whose topics and frames have names of a stranger."""
    name = f'{CONTROL}x' * 600
    path = tmp_path / 'strange.mcap'
    topics = DEFAULT_TOPICS._replace(depth=f'/d{name}', mask=f'/m{name}')
    with RecordingWriter(path) as writer:
        for frame in simple_frames:
            writer.write_frame(frame._replace(frame_id=name), topics)
    return path


@pytest.mark.parametrize(
    'words',
    [
        'info {}',
        'export {} -o {}.csv',
        'export {} -o {}.csv --frame odom',
        'view {} -o {}.png --depth-topic /nothing',
        'train {} -o {}.npz --depth-topic /nothing',
    ],
)
def test_names_in_a_recording_are_cut_and_harmless(strange, words, capsys):
    main(words.replace('{}', str(strange)).split())
    printed = capsys.readouterr()
    lines = [*printed.out.splitlines(), *printed.err.splitlines()]
    assert lines
    assert max(map(len, lines)) < 10 * LONGEST_TEXT
    assert all(line.isprintable() for line in lines)


def test_provenance_of_a_model_is_cut_and_harmless(tmp_path, capsys):
    long = f'{CONTROL}x' * 600
    path = tmp_path / 'strange.npz'
    save_model(path, tiny_model()._replace(provenance={'date': long, long: 'x'}))
    assert main(['info', str(path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) < 10 * LONGEST_TEXT
    assert all(line.isprintable() for line in lines)
