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

"""The process of `lsc_pose`: Ctrl-C ends it with one line, whenever it comes."""

import atexit
import os
import signal
import sys
from contextlib import suppress
from types import FrameType
from typing import TYPE_CHECKING, NoReturn

from lsc_pose_ros.cli.standard_streams import prepare_streams

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

INTERRUPTED = 130  # 128 + SIGINT, as shells report it
_LINE = b'lsc_pose: interrupted\n'


def main() -> int:
    """Run the command of `sys.argv` and return the exit status.

    Raises:
        SystemExit: the words are wrong (status 2), or request help or the version (status 0).
    """
    # A program in the background of a shell ignores SIGINT.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)
        sys.unraisablehook = _pass_on
    prepare_streams()
    try:
        from lsc_pose_ros.cli.main import main as run_command  # noqa: PLC0415

        status = run_command()
    except KeyboardInterrupt:  # a second one, while the first was reported
        status = INTERRUPTED
    finally:
        # All is done, and the interpreter would print a traceback.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    if status == INTERRUPTED:
        _leave()
    return status


def let_interrupt() -> None:
    """Let SIGINT raise KeyboardInterrupt, because now there may be something to clean up.

    Before, the process ends at once: an import that is interrupted can fail in many ways.
    """
    if signal.getsignal(signal.SIGINT) is _end:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _end(_number: int, _frame: FrameType | None) -> None:
    os.write(2, _LINE)
    os._exit(INTERRUPTED)


def _leave() -> NoReturn:
    """End the process, without the interpreter's own end.

    A library in C that KeyboardInterrupt has left in the middle can crash there.
    """
    atexit._run_exitfuncs()  # noqa: SLF001 - files that are not finished are removed there
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    os._exit(INTERRUPTED)


def _pass_on(problem: 'UnraisableHookArgs') -> None:
    """Raise a KeyboardInterrupt again that came where Python cannot raise it."""
    if issubclass(problem.exc_type, KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)
    else:
        sys.__unraisablehook__(problem)
