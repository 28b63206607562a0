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

"""Writes files so that nothing is lost: a file appears whole, or what was there before stays.

- A file is written under another name beside its target, flushed to the disk, and renamed.
- The target of a symbolic link is replaced; the link stays.
- Devices, pipes and descriptors are written to. `-` is standard output.
- A file of another kind is never replaced.
"""

import atexit
import os
import re
import secrets
import shutil
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, cast

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import Kind

STANDARD_OUTPUT = '-'
"""The name of standard output as an output."""

_DESCRIPTOR = re.compile(r'/(?:dev|proc/self)/fd/(\d+)')
_NAMED_DESCRIPTORS = {STANDARD_OUTPUT: 1, '/dev/stdout': 1, '/dev/stderr': 2}

_LONGEST_STEM = 200
"""How much of a name is kept in that of the unfinished file, characters; systems allow 255."""

_unfinished: dict[Path, int] = {}
"""The unfinished files and folders, and the processes that write them."""


class OutputFile:
    """A file that is written; a context manager that returns the open stream.

    At the end, the file replaces the one that was there; after an error, that one is as before.
    A process that is killed leaves a file `.NAME.PROCESS.RANDOM.part`.
    """

    def __init__(self, path: Path, kind: Kind) -> None:
        """Check the path; nothing is written before the context is entered.

        Raises:
            InputError: the folder does not exist, or a file of another kind is in the way.
        """
        check_output(path, kind)
        self._path, self._kind = path, kind
        self._partial: Path | None = None
        self._stream: BinaryIO | None = None

    def __enter__(self) -> BinaryIO:
        """Open the file.

        Raises:
            InputError: it cannot be written.
        """
        try:
            with writing(self._path):
                self._stream = self._open()
        except BaseException:
            self._discard()
            raise
        return self._stream

    def __exit__(
        self,
        error_type: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Put the file in its place, or remove it after an error.

        Raises:
            InputError: it cannot be finished, for example because the disk is full.
            BrokenPipeError: nobody reads the pipe any more.
        """
        try:
            if error is None:
                with writing(self._path):
                    self._finish()
        finally:
            self._discard()

    def _open(self) -> BinaryIO:
        descriptor = _descriptor(self._path)
        if descriptor is not None:
            return cast('BinaryIO', _Sequential(os.dup(descriptor)))
        if is_written_through(self._path):
            return cast('BinaryIO', _Sequential(os.open(self._path, os.O_WRONLY)))
        target = Path(os.path.realpath(self._path))
        self._partial = partial_name(target)
        stream = self._partial.open('xb')
        with suppress(FileNotFoundError):
            os.fchmod(stream.fileno(), stat.S_IMODE(target.stat().st_mode))
        return stream

    def _finish(self) -> None:
        if self._stream is None:
            return
        self._stream.flush()
        if self._partial is None:
            self._stream.close()
            return
        os.fsync(self._stream.fileno())
        self._stream.close()
        # Another program may have written there meanwhile.
        check_output(self._path, self._kind)
        put_in_place(self._partial, Path(os.path.realpath(self._path)))

    def _discard(self) -> None:
        if self._stream is not None:
            # Closing flushes, which fails again if the disk is full.
            with suppress(OSError):
                self._stream.close()
        if self._partial is not None:
            remove_partial(self._partial)


class OutputFolder:
    """A new folder, whose files are written under another name; a context manager.

    At the end, the folder gets its name; after an error, it is removed.
    """

    def __init__(self, path: Path) -> None:
        """Check the path; nothing is written before the context is entered.

        Raises:
            InputError: the folder around it does not exist, or `path` exists.
        """
        _check_folder(path)
        if path.exists():
            msg = f'{path} exists already; remove it or choose another name'
            raise InputError(msg)
        self._path = path
        self._partial: Path | None = None

    def __enter__(self) -> Path:
        """Create the folder; return the path under which its files are written.

        Raises:
            InputError: it cannot be created.
        """
        self._partial = partial_name(Path(os.path.realpath(self._path)))
        try:
            with writing(self._path):
                self._partial.mkdir()
        except BaseException:
            remove_partial(self._partial)
            raise
        return self._partial

    def __exit__(
        self,
        error_type: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Give the folder its name, or remove it after an error.

        Raises:
            InputError: another folder has got the name.
        """
        if self._partial is None:
            return
        try:
            if error is None:
                with writing(self._path):
                    put_in_place(self._partial, Path(os.path.realpath(self._path)))
        finally:
            remove_partial(self._partial)


class _Sequential:
    """A stream that can only be written, one byte after the other, and knows its position."""

    def __init__(self, descriptor: int) -> None:
        self._file = os.fdopen(descriptor, 'wb')
        self._position = 0

    def write(self, data: bytes) -> int:
        """Write `data`; return its size."""
        self._position += self._file.write(data)
        return memoryview(data).nbytes

    def tell(self) -> int:
        """Return the number of bytes that are written."""
        return self._position

    def flush(self) -> None:
        """Write what is buffered."""
        self._file.flush()

    def close(self) -> None:
        """Write what is buffered, and close the stream."""
        self._file.close()


def write_output(path: Path, kind: Kind, write: bytes | Callable[[BinaryIO], object]) -> int:
    """Write a file: the bytes `write`, or what the function `write` writes to a stream.

    Returns:
        The size of the file, bytes.

    Raises:
        InputError: it cannot be written, or a file of another kind is in the way.
    """
    with OutputFile(path, kind) as stream, writing(path):
        if callable(write):
            write(stream)
        else:
            stream.write(write)
        return stream.tell()


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


def check_output(path: Path, kind: Kind) -> None:
    """Check that a file of `kind` may be written to `path`.

    Raises:
        InputError: the folder does not exist, or something of another kind is in the way.
    """
    if _descriptor(path) is not None:
        return
    with writing(path):
        if not path.exists():
            _check_folder(path)
            return
        state = path.stat()
    if stat.S_ISDIR(state.st_mode):
        msg = f'{path} is a folder; choose another name'
        raise InputError(msg)
    if stat.S_ISREG(state.st_mode) and state.st_size:
        _check_existing(path, kind)


def _check_folder(path: Path) -> None:
    folder = Path(os.path.realpath(path)).parent
    if not folder.is_dir():
        msg = f'{path}: the folder {folder} does not exist; create it first'
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


def is_written_through(path: Path) -> bool:
    """Return whether `path` is written to, not replaced: a device, a pipe, or `-`."""
    if _descriptor(path) is not None:
        return True
    try:
        mode = path.stat().st_mode
    except OSError:
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


def _descriptor(path: Path) -> int | None:
    """Return the number of the descriptor of this process that `path` names, None for others."""
    found = _DESCRIPTOR.fullmatch(str(path))
    return int(found[1]) if found else _NAMED_DESCRIPTORS.get(str(path))


def partial_name(target: Path) -> Path:
    """Return a new name beside `target`, which is removed if the program ends before it is placed.

    The random part keeps apart the writers of one file, even those of one process.
    """
    stem = target.name[:_LONGEST_STEM]
    path = target.with_name(f'.{stem}.{os.getpid()}.{secrets.token_hex(4)}.part')
    _unfinished[path] = os.getpid()
    return path


def put_in_place(partial: Path, target: Path) -> None:
    """Rename a finished file or folder to `target`, and record that on the disk.

    Raises:
        OSError: it is impossible.
    """
    partial.replace(target)
    _unfinished.pop(partial, None)
    # Some file systems cannot flush a folder, and the file is complete anyway.
    with suppress(OSError):
        folder = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def remove_partial(partial: Path) -> None:
    """Remove an unfinished file or folder if there is one."""
    if partial.is_dir():
        shutil.rmtree(partial, ignore_errors=True)
    else:
        with suppress(OSError):
            partial.unlink(missing_ok=True)
    _unfinished.pop(partial, None)


@atexit.register
def _remove_unfinished() -> None:
    """Remove what Ctrl-C during the cleaning up has left."""
    for path, process in list(_unfinished.items()):
        if process == os.getpid():
            remove_partial(path)
