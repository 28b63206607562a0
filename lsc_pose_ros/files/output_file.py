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

import os
import stat
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import BinaryIO

from lsc_pose_ros.files.kinds import Kind
from lsc_pose_ros.files.output_place import (
    check_new_folder,
    check_output,
    descriptor_of,
    is_written_through,
    writing,
)
from lsc_pose_ros.files.partial_files import partial_name, put_in_place, remove_partial
from lsc_pose_ros.files.sequential_stream import SequentialStream


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
        descriptor = descriptor_of(self._path)
        if descriptor is not None:
            return SequentialStream(os.dup(descriptor))
        if is_written_through(self._path):
            return SequentialStream(os.open(self._path, os.O_WRONLY))
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
        check_new_folder(path)
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
