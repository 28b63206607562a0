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

"""Progress of long commands: a bar on a terminal, a line now and then in a log."""

import argparse
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

from tqdm import tqdm

from lsc_pose_ros.cli.output.terminal_text import line_of

_Item = TypeVar('_Item')

LOG_INTERVAL = 30.0
"""Seconds between two lines where the output is no terminal."""

_VERBOSE_INTERVAL = 5.0


class LogLines:
    """Prints a line on stderr if the last one is long ago."""

    def __init__(self, interval: float, clock: Callable[[], float] = time.monotonic) -> None:
        """Begin to wait for `interval` seconds, as `clock` measures them."""
        self._interval = interval
        self._clock = clock
        self._last = clock()

    def tell(self, text: str) -> None:
        """Print `text` if it is time for a line."""
        now = self._clock()
        if now - self._last >= self._interval:
            self._last = now
            print(f'lsc_pose: {text}', file=sys.stderr, flush=True)


class Reporter:
    """How the progress of this program is told.

    Attributes:
        quiet: whether nothing is told.
        verbose: whether each step is told, also where the output is no terminal.
    """

    def __init__(self) -> None:
        """Tell as much as is usual."""
        self.quiet = self.verbose = False
        self._steps: LogLines | None = None

    def set(self, arguments: argparse.Namespace) -> None:
        """Use the options `--quiet` and `--verbose`, for one command."""
        self.quiet = getattr(arguments, 'quiet', False)
        self.verbose = getattr(arguments, 'verbose', False)
        self._steps = LogLines(LOG_INTERVAL)

    def lines(self) -> LogLines:
        """Return the lines for one loop."""
        return LogLines(_VERBOSE_INTERVAL if self.verbose else LOG_INTERVAL)

    def step(self, text: str) -> None:
        """Tell that a step begins: at once on a terminal, now and then in a log."""
        if self.quiet:
            return
        if self.verbose or sys.stderr.isatty():
            print(f'lsc_pose: {text}', file=sys.stderr, flush=True)
        elif self._steps is not None:
            self._steps.tell(text)

    def tell(self, text: str) -> None:
        """Tell at once what the user asked for, or what is not as usual."""
        if not self.quiet:
            print(f'lsc_pose: {text}', file=sys.stderr, flush=True)


REPORTER = Reporter()
"""The one of this program."""


def warn(text: str) -> None:
    """Warn the user, also with `--quiet`."""
    print(f'lsc_pose: warning: {line_of(text)}', file=sys.stderr, flush=True)


def add_verbosity_options(parser: argparse.ArgumentParser) -> None:
    """Add `--quiet` and `--verbose` to a command, and to what it consists of."""
    group = parser.add_mutually_exclusive_group()
    group.add_argument('--quiet', action='store_true', help='print no progress')
    group.add_argument(
        '--verbose', action='store_true', help='print each step, also where there is no terminal'
    )
    for action in parser._actions:  # noqa: SLF001 - argparse has no public list
        if isinstance(action, argparse._SubParsersAction):  # noqa: SLF001
            for part in action.choices.values():
                add_verbosity_options(part)


def progress(iterable: Iterable[_Item], total: int | None, description: str) -> Iterator[_Item]:
    """Yield the items of `iterable`, and tell on stderr how far it is.

    Args:
        iterable: the items.
        total: the number of items, None if it is unknown.
        description: the text before the bar.
    """
    if REPORTER.quiet:
        yield from iterable
    elif sys.stderr.isatty():
        yield from tqdm(iterable, desc=description, total=total, file=sys.stderr)
    else:
        yield from with_lines(iterable, total, description, REPORTER.lines())


def with_lines(
    iterable: Iterable[_Item], total: int | None, description: str, lines: LogLines
) -> Iterator[_Item]:
    """Yield the items of `iterable`, and tell `lines` how far it is; arguments as `progress`."""
    of_all = '' if total is None else f' of {total}'
    for number, item in enumerate(iterable):
        yield item
        lines.tell(f'{description}: {number + 1}{of_all}')
