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

"""What all commands share: how they are found, and how they end."""

import argparse
import io
import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest

from lsc_pose_ros import __version__
from lsc_pose_ros.bags.topics import Topics
from lsc_pose_ros.cli import main as cli
from lsc_pose_ros.cli.options.topic_options import add_topic_arguments, topics_of
from lsc_pose_ros.cli.output.progress import progress
from lsc_pose_ros.errors import InputError

ROOT = Path(__file__).parents[2]


def python(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *words], cwd=ROOT, capture_output=True, text=True, check=False
    )


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch) -> Callable[[Callable[[], int]], None]:
    """Replace all commands by `fake`, which runs the function of the test."""

    def put(act: Callable[[], int]) -> None:
        module = SimpleNamespace(
            HELP='runs the function of the test',
            add_arguments=lambda parser: parser.add_argument('--number', type=int),
            run=lambda _arguments: act(),
        )
        monkeypatch.setattr(cli, 'COMMANDS', {'fake': cli.Command('fake_command', 'fakes')})
        monkeypatch.setattr(cli, 'load', lambda _command: module)

    return put


def fail_with(error: BaseException) -> Callable[[], int]:
    def act() -> int:
        raise error

    return act


def test_help_lists_every_command_and_imports_nothing_heavy() -> None:
    script = (
        'import sys, json\n'
        'from lsc_pose_ros.cli.main import main\n'
        'try:\n'
        '    main(["--help"])\n'
        'except SystemExit as end:\n'
        '    print("\\n" + json.dumps([end.code, sorted(sys.modules)]))\n'
    )
    output = python('-c', script).stdout
    status, modules = json.loads(output.splitlines()[-1])
    assert status == 0
    listed = {line[4:].split(' ')[0] for line in output.splitlines() if line[:4] == '    '}
    assert set(cli.COMMANDS) <= listed
    assert not {'numpy', 'numba', 'matplotlib', 'rclpy', 'tqdm', 'yaml'} & set(modules)


def test_version_is_printed() -> None:
    result = python('-m', 'lsc_pose_ros', '--version')
    assert (result.returncode, result.stdout) == (0, f'lsc_pose {__version__}\n')


@pytest.mark.parametrize('name', cli.COMMANDS)
def test_every_command_explains_itself(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    module = cli.load(cli.COMMANDS[name])
    with pytest.raises(SystemExit) as end:
        cli.main([name, '--help'])
    assert end.value.code == 0
    printed = ' '.join(capsys.readouterr().out.split())
    assert printed.startswith(f'usage: lsc_pose {name}')
    assert ' '.join(module.HELP.split()) in printed


@pytest.mark.parametrize('words', [[], ['dance'], ['--loud'], ['fake', '--number', 'x']])
def test_wrong_words_end_with_2_and_the_usage(
    words: list[str],
    command: Callable[[Callable[[], int]], None],
    capsys: pytest.CaptureFixture[str],
) -> None:
    command(lambda: 0)
    with pytest.raises(SystemExit) as end:
        cli.main(words)
    assert end.value.code == cli.BAD_INPUT
    assert capsys.readouterr().err.startswith('usage: lsc_pose')


def test_command_of_a_missing_package_says_how_to_install_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    missing = cli.Command('package_that_is_missing.command', 'does nothing')
    monkeypatch.setattr(cli, 'COMMANDS', {'missing': missing})
    assert cli.main(['missing']) == cli.BAD_INPUT
    complaint = capsys.readouterr().err
    assert complaint.count('\n') == 1
    assert 'package_that_is_missing of this command is not installed' in complaint
    assert '`pip install -e ./experiments`' in complaint


def test_help_lists_a_missing_package_and_how_to_install_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    missing = cli.Command('package_that_is_missing.command', 'does nothing')
    installed = cli.Command('lsc_pose_ros.cli.commands.info_command', 'prints')
    monkeypatch.setattr(cli, 'COMMANDS', {'missing': missing, 'info': installed})
    with pytest.raises(SystemExit, match='0'):
        cli.main(['--help'])
    lines = ' '.join(capsys.readouterr().out.split())
    assert (
        'missing does nothing (package_that_is_missing is not installed: '
        'pip install -e ./experiments)' in lines
    )
    assert 'info prints' in lines
    assert lines.count('not installed') == 1


def test_failing_import_in_a_command_is_no_missing_package(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / 'broken_command.py').write_text('import package_that_is_missing\n')
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(cli, 'COMMANDS', {'broken': cli.Command('broken_command', 'fails')})
    assert cli.main(['broken']) == cli.FAILURE
    assert 'ModuleNotFoundError' in capsys.readouterr().err


def test_command_returns_its_own_status(command: Callable[[Callable[[], int]], None]) -> None:
    command(lambda: 7)
    assert cli.main(['fake']) == 7


def test_bad_input_ends_with_2_and_one_line(
    command: Callable[[Callable[[], int]], None],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(cli.DEBUG_VARIABLE, '1')  # bad input never shows a traceback
    command(fail_with(InputError('a.mcap: no such file;\n  check the path')))
    assert cli.main(['fake']) == 2
    assert capsys.readouterr() == ('', 'lsc_pose: error: a.mcap: no such file; check the path\n')


def test_other_failures_end_with_1_and_one_line(
    command: Callable[[Callable[[], int]], None],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv(cli.DEBUG_VARIABLE, raising=False)
    command(fail_with(ValueError('odd\nshape')))
    assert cli.main(['fake']) == 1
    assert capsys.readouterr() == ('', 'lsc_pose: error: ValueError: odd shape\n')


def test_debug_variable_shows_the_traceback(
    command: Callable[[Callable[[], int]], None],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(cli.DEBUG_VARIABLE, '1')
    command(fail_with(ValueError('odd shape')))
    assert cli.main(['fake']) == 1
    lines = capsys.readouterr().err.splitlines()
    assert lines[0].startswith('Traceback')
    assert lines[-1] == 'lsc_pose: error: ValueError: odd shape'


def test_interrupt_ends_with_130_and_one_line(
    command: Callable[[Callable[[], int]], None], capsys: pytest.CaptureFixture[str]
) -> None:
    command(fail_with(KeyboardInterrupt()))
    assert cli.main(['fake']) == 130
    assert capsys.readouterr() == ('', 'lsc_pose: interrupted\n')


def test_error_that_follows_from_an_interrupt_is_one(
    command: Callable[[Callable[[], int]], None], capsys: pytest.CaptureFixture[str]
) -> None:
    error = SystemError('returned a result with an exception set')
    error.__cause__ = KeyboardInterrupt()
    command(fail_with(error))
    assert cli.main(['fake']) == 130
    assert capsys.readouterr() == ('', 'lsc_pose: interrupted\n')


def test_closed_pipe_is_no_error() -> None:
    # `lsc_pose ... | head -1`, where the reader leaves before the writer has flushed.
    script = (
        'import sys\n'
        'from types import SimpleNamespace\n'
        'from lsc_pose_ros.cli import main as cli\n'
        'cli.load = lambda _: SimpleNamespace(HELP="", add_arguments=lambda _: None,\n'
        '    run=lambda _: print("line\\n" * 100_000) or 0)\n'
        'sys.exit(cli.main(["info"]))\n'
    )
    with subprocess.Popen(
        [sys.executable, '-c', script], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.readline()
        process.stdout.close()
        complaint = process.stderr.read()
    assert (process.returncode, complaint) == (cli.PIPE_CLOSED, b'')


def test_error_that_nobody_reads_keeps_its_status() -> None:
    # `lsc_pose ... 2>&1 | true`: the reader has left.
    with subprocess.Popen(
        [sys.executable, '-m', 'lsc_pose_ros', 'info', 'nothing.mcap'],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    ) as process:
        assert process.stdout is not None
        process.stdout.close()
    assert process.returncode == cli.BAD_INPUT


def test_progress_is_silent_without_a_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    assert list(progress(iter('abc'), 3, 'reading')) == ['a', 'b', 'c']
    assert capsys.readouterr() == ('', '')


def test_progress_draws_a_bar_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = io.StringIO()
    monkeypatch.setattr(terminal, 'isatty', lambda: True)
    monkeypatch.setattr(sys, 'stderr', terminal)
    assert list(progress(range(3), None, 'reading')) == [0, 1, 2]
    assert 'reading' in terminal.getvalue()
    assert '3' in terminal.getvalue()


def test_topics_are_found_automatically_unless_named() -> None:
    parser = argparse.ArgumentParser()
    add_topic_arguments(parser)
    assert topics_of(parser.parse_args([])) == Topics()
    assert parser.parse_args([]).mask_background == 0
    words = '--depth-topic /d --camera-info-topic /c --mask-topic /m --ground-truth-topic /t'
    arguments = parser.parse_args([*words.split(), '--mask-background', '255'])
    assert topics_of(arguments) == Topics('/d', '/c', '/m', '/t')
    assert arguments.mask_background == 255
