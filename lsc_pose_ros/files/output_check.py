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

"""Checks the outputs of a program before it begins to work."""

import os
import stat
from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations
from pathlib import Path
from typing import NamedTuple

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import Kind
from lsc_pose_ros.files.output_place import (
    check_folder_of_outputs,
    check_output,
    descriptor_of,
    is_written_through,
)


class Output(NamedTuple):
    """A file that is going to be written."""

    path: Path
    kind: Kind


def outputs_in(folder: Path, files: dict[str, Kind] | None = None) -> list[Output]:
    """Return the outputs in a folder, which is made if it does not exist.

    Args:
        folder: the folder.
        files: the kinds of the files that are replaced in it, by their names.

    Raises:
        InputError: the folder cannot be made, or nothing can be written to it.
    """
    check_folder_of_outputs(folder)
    if not folder.is_dir():
        return []
    return [Output(folder / name, kind) for name, kind in (files or {}).items()]


def check_outputs(outputs: Sequence[Output], inputs: Iterable[Path]) -> None:
    """Check that the outputs can be written, and that nothing is lost by it.

    Args:
        outputs: the files to write.
        inputs: the files and folders to read; those that do not exist are left to their readers.

    Raises:
        InputError: an output is an input, even under another name, or a file of an input folder;
            two outputs are one file or one stream; or an output is the place of something else.
    """
    files = [each for each in outputs if not is_written_through(each.path)]
    inputs = list(inputs)
    for output in files:
        _refuse_input(output.path, inputs)
    for first, second in combinations(files, 2):
        if _is_same(first.path, second.path):
            msg = f'{first.path} and {second.path} are one file; choose another name for one'
            raise InputError(msg)
    for first, second in combinations(outputs, 2):
        descriptor = descriptor_of(first.path)
        if descriptor is not None and descriptor == descriptor_of(second.path):
            msg = f'two outputs go to {first.path}; choose another name for one'
            raise InputError(msg)
    for output in outputs:
        check_output(output.path, output.kind)


def _refuse_input(output: Path, inputs: Sequence[Path]) -> None:
    if _mode(output) is None:
        return
    for given in inputs:
        for file in _files_of(given):
            if _is_same(output, file):
                which = 'the input' if given == file else 'a file of the input'
                msg = f'{output} is {which} {given}; choose another name for the output'
                raise InputError(msg)


def _files_of(given: Path) -> Iterator[Path]:
    """Yield the input itself, and for a folder all files below it."""
    yield given
    if stat.S_ISDIR(_mode(given) or 0):
        for folder, _, names in os.walk(given):
            yield from (Path(folder, name) for name in names)


def _mode(path: Path) -> int | None:
    """Return the kind and rights of a file, None if it does not exist or cannot."""
    try:
        return path.stat().st_mode
    except OSError:
        return None


def _is_same(one: Path, other: Path) -> bool:
    """Return whether two names stand for one file, which need not exist."""
    try:
        return one.samefile(other)
    except OSError:
        return os.path.realpath(one) == os.path.realpath(other)
