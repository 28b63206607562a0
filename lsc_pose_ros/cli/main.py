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

"""`lsc_pose`: runs a command and turns errors into one line and an exit status."""

import argparse
import importlib
import importlib.util
import os
import sys
import traceback
from collections.abc import Sequence
from contextlib import nullcontext, redirect_stdout, suppress
from pathlib import Path
from typing import NamedTuple, Protocol, cast

from lsc_pose_ros import __version__
from lsc_pose_ros.cli.options.camera_preset import use_camera_preset
from lsc_pose_ros.cli.options.completion import complete, typed_words
from lsc_pose_ros.cli.options.settings_file import use_settings_file
from lsc_pose_ros.cli.output.terminal_text import line_of
from lsc_pose_ros.cli.program import INTERRUPTED, let_interrupt
from lsc_pose_ros.cli.standard_streams import silence_stdout
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.output_place import STANDARD_OUTPUT, names_standard_output, writing

PROGRAM = 'lsc_pose'
DEBUG_VARIABLE = 'LSC_POSE_DEBUG'

FAILURE = 1
BAD_INPUT = 2
PIPE_CLOSED = 141  # 128 + SIGPIPE

_DESCRIPTION = 'Human joints in 3-D from depth images: record, train, evaluate, replay.'
_EPILOG = f"""\
'{PROGRAM} COMMAND --help' explains a command. The status is 0, or 2 for input that cannot be
used, or 1 for any other failure; {DEBUG_VARIABLE}=1 shows the traceback of those.
"""

_INSTALL_EXPERIMENTS = 'pip install -e ./experiments'


class Command(NamedTuple):
    """The module of a command, and its line in the list of commands."""

    module: str
    help: str


class CommandModule(Protocol):
    """What the module of a command provides."""

    HELP: str

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Add the command's own arguments to `parser`."""

    def run(self, arguments: argparse.Namespace) -> int:
        """Run the command and return the exit status."""


# The help lines are repeated here, so that `--help` imports neither numba nor matplotlib.
COMMANDS: dict[str, Command] = {
    'import': Command(
        'lsc_pose_ros.cli.commands.import_command',
        'convert a public data set, images or a ROS 1 bag into a recording',
    ),
    'label': Command(
        'lsc_pose_ros.cli.commands.label_command',
        'add labels from another program to a recording',
    ),
    'annotate': Command(
        'lsc_pose_ros.cli.commands.annotate_command', 'label a recording by hand, in a browser'
    ),
    'synth': Command(
        'lsc_pose_ros.cli.commands.synth_command',
        'generate a labelled recording of synthetic people',
    ),
    'train': Command(
        'lsc_pose_ros.cli.commands.train_command', 'train a model on labelled recordings'
    ),
    'evaluate': Command(
        'lsc_pose_ros.cli.commands.evaluate_command', 'measure a model on labelled recordings'
    ),
    'replay': Command(
        'lsc_pose_ros.cli.commands.replay_command',
        'estimate the joints in a recording, or publish it',
    ),
    'view': Command(
        'lsc_pose_ros.cli.commands.view_command',
        'draw frames of a recording, or the stages of one frame',
    ),
    'export': Command(
        'lsc_pose_ros.cli.commands.export_command',
        'write the joints of a recording as a table, arrays or an animation',
    ),
    'bench': Command(
        'lsc_pose_ros.cli.commands.bench_command', 'time each stage of the estimation'
    ),
    'experiments': Command(
        'lsc_pose_experiments.command', "repeat the paper's tables and figures on recordings"
    ),
    'info': Command(
        'lsc_pose_ros.cli.commands.info_command', 'print the contents of a recording or a model'
    ),
}


def main(words: Sequence[str] | None = None) -> int:
    """Run `lsc_pose` with `words` (default: `sys.argv[1:]`) and return the exit status.

    Raises:
        SystemExit: the words are wrong (status 2), or request help or the version (status 0).
    """
    try:
        status = _run(list(sys.argv[1:] if words is None else words))
        _flush()
    except KeyboardInterrupt:
        return _report_interrupt()
    except BrokenPipeError:
        silence_stdout()
        return PIPE_CLOSED
    except Exception as error:  # noqa: BLE001 - the last resort: a line instead of a traceback
        return _report(error)
    return status


def _flush() -> None:
    """Write what was printed.

    Raises:
        InputError: standard output cannot be written, for example because a disk is full.
        BrokenPipeError: nobody reads it any more.
    """
    try:
        with writing(Path(STANDARD_OUTPUT)):
            sys.stdout.flush()
    except InputError:
        silence_stdout()
        raise


def _run(words: list[str]) -> int:
    words_or_typed = typed_words() or words
    name = next((word for word in words_or_typed if not word.startswith('-')), None)
    parser = argparse.ArgumentParser(prog=PROGRAM, description=_DESCRIPTION, epilog=_EPILOG)
    parser.add_argument('--version', action='version', version=f'{PROGRAM} {__version__}')
    subparsers = parser.add_subparsers(dest='command', required=True, metavar='COMMAND')
    module: CommandModule | None = None
    for listed, command in COMMANDS.items():
        # Adding the arguments of a command imports its module, so only the called command does.
        subparser = subparsers.add_parser(listed, help=_help_line(command))
        if listed == name:
            module = load(command)
            subparser.description = module.HELP
            module.add_arguments(subparser)
            _add_common_options(subparser, words)
    complete(parser)
    arguments = parser.parse_args(words)
    if module is None:  # parse_args has refused all other words already
        parser.error('name a command')
    _set_verbosity(arguments)
    let_interrupt()
    # What a command prints must not be mixed with an output that goes to standard output.
    outputs = [each for each in vars(arguments).values() if isinstance(each, Path)]
    is_occupied = any(names_standard_output(path) for path in outputs)
    with redirect_stdout(sys.stderr) if is_occupied else nullcontext():
        return module.run(arguments)


def _add_common_options(parser: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options that all commands have, and make files of settings the defaults."""
    # tqdm is imported with it, which `--help` need not wait for.
    from lsc_pose_ros.cli.output.progress import add_verbosity_options  # noqa: PLC0415

    add_verbosity_options(parser)
    use_camera_preset(parser, words)
    use_settings_file(parser, words)


def _set_verbosity(arguments: argparse.Namespace) -> None:
    from lsc_pose_ros.cli.output.progress import REPORTER  # noqa: PLC0415

    REPORTER.set(arguments)


def _help_line(command: Command) -> str:
    package = _package_of(command)
    if importlib.util.find_spec(package):
        return command.help
    return f'{command.help} ({package} is not installed: {_INSTALL_EXPERIMENTS})'


def load(command: Command) -> CommandModule:
    """Import the module of `command`.

    Raises:
        InputError: the package of the command is not installed.
    """
    try:
        return cast('CommandModule', importlib.import_module(command.module))
    except ModuleNotFoundError as error:
        package = _package_of(command)
        if error.name != package:
            raise
        msg = (
            f'the package {package} of this command is not installed; '
            f'run `{_INSTALL_EXPERIMENTS}` in a clone of the repository'
        )
        raise InputError(msg) from error


def _package_of(command: Command) -> str:
    return command.module.partition('.')[0]


def _report(error: Exception) -> int:
    """Print one line about `error`; return the exit status."""
    if _is_of_an_interrupt(error):
        return _report_interrupt()
    if isinstance(error, InputError):
        _complain(str(error))
        return BAD_INPUT
    if os.environ.get(DEBUG_VARIABLE):
        traceback.print_exception(error)
    if isinstance(error, OSError) and error.filename and error.strerror:
        _complain(f'{error.filename}: {error.strerror}')
        return BAD_INPUT
    _complain(f'{type(error).__name__}: {error}')
    return FAILURE


def _report_interrupt() -> int:
    print(f'{PROGRAM}: interrupted', file=sys.stderr)
    return INTERRUPTED


def _is_of_an_interrupt(error: BaseException) -> bool:
    """Return whether `error` follows from a KeyboardInterrupt, which C code can turn into one."""
    found: BaseException | None = error
    while found is not None:
        if isinstance(found, KeyboardInterrupt):
            return True
        found = found.__cause__ or found.__context__
    return False


def _complain(message: str) -> None:
    """Print `message` on stderr as one line, without its line breaks."""
    with suppress(BrokenPipeError):  # nobody reads it, which does not change the status
        print(f'{PROGRAM}: error: {line_of(message)}', file=sys.stderr, flush=True)
