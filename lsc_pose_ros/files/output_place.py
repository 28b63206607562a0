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

"""Where outputs go: files, devices, pipes, descriptors and folders, checked before the work."""

import os
import re
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import Kind
from lsc_pose_ros.files.sibling_names import longest_name

if sys.platform != 'win32':
    import fcntl

STANDARD_OUTPUT = '-'
"""The name of standard output as an output."""

_DESCRIPTOR = re.compile(r'/(?:dev|proc/self)/fd/(\d+)')
_NAMED_DESCRIPTORS = {STANDARD_OUTPUT: 1, '/dev/stdout': 1, '/dev/stderr': 2}


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn errors of the system into one of `path`.

    Raises:
        InputError: `path` cannot be written.
        BrokenPipeError: nobody reads the pipe any more.
    """
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        msg = f'{path}: cannot be written: {error.strerror or error}'
        raise InputError(msg) from error


def descriptor_of(path: Path) -> int | None:
    """Return the number of the descriptor of this process that `path` names, None for others."""
    found = _DESCRIPTOR.fullmatch(str(path))
    return int(found[1]) if found else _NAMED_DESCRIPTORS.get(str(path))


def names_standard_output(path: Path) -> bool:
    """Return whether `path` is standard output, under any of its names."""
    return descriptor_of(path) == 1


def is_written_through(path: Path) -> bool:
    """Return whether `path` is written to, not replaced: a device, a pipe, or `-`."""
    if descriptor_of(path) is not None:
        return True
    try:
        mode = path.stat().st_mode
    except OSError:
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


def check_output(path: Path, kind: Kind) -> None:
    """Check that a file of `kind` may be written to `path`.

    Raises:
        InputError: the folder does not exist or is write-protected, the name is too long, the
            descriptor is closed, or something of another kind is in the way.
    """
    descriptor = descriptor_of(path)
    if descriptor is not None:
        _check_descriptor(path, descriptor)
        return
    state = _state(path)
    if state is not None and stat.S_ISDIR(state.st_mode):
        msg = f'{path} is a folder; choose another name'
        raise InputError(msg)
    if state is not None and stat.S_ISREG(state.st_mode) and state.st_size:
        _check_existing(path, kind)
    if state is None or stat.S_ISREG(state.st_mode):
        check_folder_around(path)


def check_folder_around(path: Path) -> None:
    """Check that a new file or folder `path` can be made.

    Raises:
        InputError: the folder around it does not exist or is write-protected, or the name is too
            long.
    """
    target = Path(os.path.realpath(path))
    with writing(path):
        folder_is_there = target.parent.is_dir()
    if not folder_is_there:
        msg = f'{path}: the folder {target.parent} does not exist; create it first'
        raise InputError(msg)
    _check_writable(path, target.parent)
    _check_names(path, target.parent, target.name)


def check_new_folder(path: Path) -> None:
    """Check that a new folder `path` can be made.

    Raises:
        InputError: `path` exists, or as `check_folder_around`.
    """
    if _state(path) is not None:
        msg = f'{path} exists already; remove it or choose another name'
        raise InputError(msg)
    check_folder_around(path)


def check_folder_of_outputs(folder: Path) -> None:
    """Check that files can be written to `folder`, which is made with all folders around it.

    Raises:
        InputError: a file is in the way, or a folder is write-protected, or a name is too long.
    """
    state, missing = _state(folder), list[str]()
    around = folder
    while state is None and around != around.parent:
        missing.append(around.name)
        around = around.parent
        state = _state(around)
    if state is None or not stat.S_ISDIR(state.st_mode):
        msg = f'{around} is no folder; choose another name for the folder {folder}'
        raise InputError(msg)
    _check_writable(folder, around)
    _check_names(folder, around, *missing)


def _state(path: Path) -> os.stat_result | None:
    """Return what the system knows of `path`, None if it does not exist.

    Raises:
        InputError: the system refuses the path, for example because its name is too long.
    """
    with writing(path):
        try:
            return path.stat()
        except (FileNotFoundError, NotADirectoryError):
            return None


def _check_descriptor(path: Path, descriptor: int) -> None:
    """Check that a descriptor is open, and not only for reading."""
    try:
        os.fstat(descriptor)
        reads = (
            sys.platform != 'win32'
            and fcntl.fcntl(descriptor, fcntl.F_GETFL) & os.O_ACCMODE == os.O_RDONLY
        )
    except (OSError, OverflowError):
        reads = True
    if reads:
        named = 'standard output' if descriptor == 1 else f'the descriptor {descriptor}'
        msg = f'{path}: cannot be written: {named} is closed; name a file instead'
        raise InputError(msg)


def _check_writable(path: Path, folder: Path) -> None:
    if not os.access(folder, os.W_OK | os.X_OK):
        msg = f'{path}: the folder {folder} cannot be written; choose another one'
        raise InputError(msg)


def _check_names(path: Path, folder: Path, *names: str) -> None:
    longest = longest_name(folder)
    if any(len(os.fsencode(name)) > longest for name in names):
        msg = f'{path}: cannot be written: File name too long: more than {longest} bytes'
        raise InputError(msg)


def _check_existing(path: Path, kind: Kind) -> None:
    """Check that the file `path` is of `kind` and may be replaced."""
    if not os.access(path, os.W_OK):
        msg = f'{path}: cannot be written: the file is write-protected; choose another name'
        raise InputError(msg)
    try:
        with path.open('rb') as stream:
            fits = kind.fits(stream)
    except Exception:  # noqa: BLE001 - a file of another kind can raise almost anything
        fits = False
    if not fits:
        msg = (
            f'{path} exists and is not {kind.name}, so it is not replaced; '
            'remove it or choose another name'
        )
        raise InputError(msg)
