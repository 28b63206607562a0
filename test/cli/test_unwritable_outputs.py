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

"""Every command refuses an output that cannot be written before it reads its inputs."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from lsc_pose_ros.cli.main import main

FILES = {
    'train': 'train nothing.mcap -o {}',
    'train --json': 'train nothing.mcap -o new.npz --json {}',
    'evaluate --json': 'evaluate m.npz nothing.mcap --json {}',
    'replay': 'replay nothing.mcap -o {}.mcap',
    'view': 'view nothing.mcap -o {}.png',
    'info --json': 'info nothing.mcap --json {}',
    'bench --json': 'bench nothing.mcap --json {}',
    'export': 'export nothing.mcap -o {}.csv',
    'synth': 'synth {}.mcap --frames 1',
    'label': 'label nothing.mcap --from skeletons -o {}.mcap',
    'label --json': 'label nothing.mcap --check --json {}',
    'import': 'import images nothing {}.mcap',
    'import utd-mhad': 'import utd-mhad nothing {}.mcap',
    'experiments --json': 'experiments new --recordings nothing.mcap --json {}',
}
"""The words of commands that write a file {}."""

FOLDERS = {
    'evaluate --report': 'evaluate m.npz nothing.mcap --report {}',
    'view --stages': 'view nothing.mcap --stages 0 -o {}',
    'label --report': 'label nothing.mcap --check --report {}',
    'import --report': 'import utd-mhad nothing new.mcap --report {}',
    'experiments': 'experiments {} --recordings nothing.mcap',
}
"""The words of commands that write a folder {} of files, which they make."""

BAGS = {
    'synth': 'synth {} --frames 1',
    'replay': 'replay nothing.mcap -o {}',
    'label': 'label nothing.mcap --from skeletons -o {}',
}
"""The words of commands that write a bag folder {}, which must not exist."""

LONG = 'a' * 300
ANY = {**FILES, **FOLDERS}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path('file').write_text('{}')
    return tmp_path


def refusal(capsys, words, output):
    status = main([word.format(output) for word in words.split()])
    printed = capsys.readouterr()
    assert status == 2, printed
    assert printed.out == ''
    (line,) = printed.err.splitlines()
    assert line.startswith('lsc_pose: error: ')
    assert 'Error' not in line
    assert 'nothing' not in line, 'the input was read before the output was checked'
    assert not Path('new').exists()
    return line


@pytest.mark.parametrize('name', ANY)
def test_name_that_is_too_long(name, capsys):
    assert 'File name too long' in refusal(capsys, ANY[name], LONG)


@pytest.mark.parametrize('name', BAGS)
def test_name_of_a_bag_that_is_too_long(name, capsys):
    assert 'File name too long' in refusal(capsys, BAGS[name], LONG)


@pytest.mark.parametrize('name', FILES)
def test_folder_that_does_not_exist(name, capsys):
    assert 'missing does not exist' in refusal(capsys, FILES[name], 'missing/x')


@pytest.mark.parametrize('name', [name for name in FILES if FILES[name].endswith('{}')])
@pytest.mark.parametrize('output', ['', '.', '..', '/'])
def test_folder_is_no_file(name, output, capsys):
    assert 'is a folder' in refusal(capsys, FILES[name], output)


@pytest.mark.parametrize('name', BAGS)
@pytest.mark.parametrize('output', ['', '.', '..'])
def test_folder_is_no_new_bag(name, output, capsys):
    assert ' is a folder; choose another name' in refusal(capsys, BAGS[name], output)


@pytest.mark.parametrize('name', FOLDERS)
@pytest.mark.parametrize('output', ['file', 'file/x'])
def test_file_is_no_folder(name, output, capsys):
    assert 'file is no folder' in refusal(capsys, FOLDERS[name], output)


@pytest.mark.parametrize('name', ANY)
def test_folder_that_is_write_protected(name, folder, capsys, monkeypatch):
    allowed = os.access
    monkeypatch.setattr(
        os, 'access', lambda path, mode: Path(path).name != 'shut' and allowed(path, mode)
    )
    (folder / 'shut').mkdir()
    assert 'shut cannot be written' in refusal(capsys, ANY[name], 'shut/x')


def run(words, **streams):
    return subprocess.run(
        [sys.executable, '-m', 'lsc_pose_ros', *words],
        check=False,
        stderr=subprocess.PIPE,
        text=True,
        **streams,
    )


CLOSE_OUTPUT = '>&-'
CLOSE_ALL = '<&- >&- 2>&-'


def run_closed(closed, words):
    """Run a command whose streams a shell has closed."""
    shell = ['/bin/sh', '-c', f'exec "$0" -m lsc_pose_ros "$@" {closed}', sys.executable]
    return subprocess.run([*shell, *words], check=False, capture_output=True, text=True)


def test_closed_standard_output_swallows_what_is_printed(labelled_recording):
    ended = run_closed(CLOSE_OUTPUT, ['info', str(labelled_recording), '--json', 'i.json'])
    assert (ended.returncode, ended.stderr) == (0, '')
    assert Path('i.json').read_text().startswith('{')


def test_closed_standard_output_is_no_output(labelled_recording):
    for name in ('-', '/dev/stdout', '/dev/fd/1'):
        ended = run_closed(CLOSE_OUTPUT, ['info', str(labelled_recording), '--json', name])
        assert ended.returncode == 2
        assert ended.stderr == (
            f'lsc_pose: error: {name}: cannot be written: standard output is closed; '
            'name a file instead\n'
        )


def test_all_streams_closed(labelled_recording):
    done = run_closed(CLOSE_ALL, ['info', str(labelled_recording), '--json', 'i.json'])
    assert done.returncode == 0
    assert Path('i.json').read_text().startswith('{')
    assert run_closed(CLOSE_ALL, ['info', 'nothing.mcap']).returncode == 2


@pytest.mark.skipif(not Path('/dev/full').exists(), reason='no /dev/full here')
def test_full_standard_output(labelled_recording, monkeypatch):
    monkeypatch.delenv('PYTHONUNBUFFERED', raising=False)
    with Path('/dev/full').open('wb') as full:
        ended = run(['info', str(labelled_recording)], stdout=full)
    assert ended.returncode == 2
    assert ended.stderr == 'lsc_pose: error: -: cannot be written: No space left on device\n'


@pytest.mark.parametrize('word', ['--json=-', '--json=/dev/stdout', '--json=/dev/fd/1'])
def test_nothing_else_is_on_standard_output(labelled_recording, word):
    ended = run(['info', str(labelled_recording), word], stdout=subprocess.PIPE)
    assert ended.returncode == 0
    assert ended.stdout.startswith('{')
    assert '/ground_truth/skeletons' in ended.stderr


@pytest.mark.parametrize('name', [b'a\xff.mcap', 'ü\U0001f600.mcap'.encode()])
def test_names_that_the_terminal_cannot_show(labelled_recording, name, monkeypatch):
    monkeypatch.setenv('PYTHONIOENCODING', 'ascii')
    os.link(labelled_recording, name)
    ended = run(['info', os.fsdecode(name)], stdout=subprocess.PIPE)
    assert (ended.returncode, ended.stderr) == (0, '')
    assert ended.stdout.startswith('recording')


def test_longest_name_of_an_output_leaves_room_for_the_journal(capsys):
    """The journal is opened before the recording is read."""
    output = 'a' * 250 + '.mcap'
    assert main(['annotate', 'nothing.mcap', '-o', output, '--no-browser']) == 2
    assert 'nothing.mcap: no such file' in capsys.readouterr().err


@pytest.mark.parametrize('words', ['info {}', 'view {} -o a.png', 'evaluate --model {} k.mcap'])
def test_input_with_a_name_that_is_too_long(words, capsys):
    assert 'too long' in refusal(capsys, words, f'{LONG}')
