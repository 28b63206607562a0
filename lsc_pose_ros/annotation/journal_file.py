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
"""The file of a journal: one process at a time writes it, and no line that it holds is lost."""

import os
import stat
from contextlib import suppress
from io import FileIO
from pathlib import Path

from lsc_pose_ros.annotation.refusals import Reason, RefusedError
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.file_lock import is_at, lock_file
from lsc_pose_ros.files.kinds import TEXT, begins_with
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.files.output_place import writing

BEGINNING = b'{"format": "lsc_pose annotation"'
"""With which the first line of each journal begins."""

_KIND = begins_with('a journal of lsc_pose annotate', BEGINNING)


class JournalFile:
    """A file of lines; it is locked until it is closed, and is not there while it is empty.

    Attributes:
        path: its name.
        is_locked: whether the file system could lock it.
    """

    def __init__(self, path: Path) -> None:
        """Open and lock the file; it is made if it is not there.

        Raises:
            InputError: it is no journal, another process has it, or it cannot be written.
        """
        self.path = path
        self._end = 0
        self._stream = self._open()
        try:
            self._refuse_other_kinds()
        except InputError:
            self._stream.close()
            raise

    def content(self) -> bytes:
        """Return all of the file."""
        self._stream.seek(0)
        return self._stream.readall()

    def append(self, data: bytes) -> None:
        """Write `data` at the end; it is on the disk when this returns.

        Raises:
            RefusedError: the disk is full, or somebody has taken the file away.
        """
        if not is_at(self.path, self._stream.fileno()):
            msg = (
                f'{self.path} was deleted or replaced by another program; the change is not kept. '
                'Write the recording now, which holds all that was kept before'
            )
            raise RefusedError(msg, Reason.NO_STORAGE)
        try:
            self._cut()  # what an earlier failure has left
            self._write(data)
        except OSError as error:
            msg = f'{self.path}: {error.strerror}; the change {self._take_back()}'
            raise RefusedError(msg, Reason.NO_STORAGE) from error
        self._end += len(data)

    def clear(self) -> None:
        """Make the file empty.

        Raises:
            InputError: it cannot be written.
        """
        with writing(self.path):
            self._stream.truncate(0)
        self._end = 0

    def replace(self, content: bytes) -> None:
        """Write the whole file anew; after a crash it is the old or the new one.

        Raises:
            InputError: it cannot be written.
        """
        write_output(self.path, _KIND, content)
        before = self._stream
        # The old file stays locked until the new one is, so that nobody comes between.
        self._stream = self._open()
        before.close()

    def set_aside(self) -> Path:
        """Copy the file to a new name beside it, and return that.

        Raises:
            InputError: the copy cannot be written.
        """
        number, path = 1, Path(f'{self.path}.damaged')
        while os.path.lexists(path):
            number += 1
            path = Path(f'{self.path}.damaged-{number}')
        write_output(path, TEXT, self.content())
        return path

    def remove(self) -> None:
        """Delete and close the file."""
        if not self._stream.closed and is_at(self.path, self._stream.fileno()):
            with suppress(OSError):
                self.path.unlink()
        self._stream.close()

    def close(self) -> None:
        """Close the file, which releases the lock; an empty one is deleted."""
        if not self._stream.closed and not os.fstat(self._stream.fileno()).st_size:
            self.remove()
        self._stream.close()

    def _open(self) -> FileIO:
        while True:
            try:
                descriptor = os.open(self.path, os.O_RDWR | os.O_CREAT, 0o666)
            except OSError as error:
                msg = f'{self.path}: {error.strerror}; name another output with -o'
                raise InputError(msg) from error
            stream = FileIO(descriptor, 'r+b')
            try:
                self.is_locked = lock_file(descriptor)
            except BlockingIOError as error:
                stream.close()
                msg = (
                    f'{self.path} is in use: this output is being annotated already; go on '
                    'there, or name another output with -o'
                )
                raise InputError(msg) from error
            # The process that had it may have deleted it meanwhile.
            if is_at(self.path, descriptor):
                self._end = os.fstat(descriptor).st_size
                return stream
            stream.close()

    def _refuse_other_kinds(self) -> None:
        if stat.S_ISREG(os.fstat(self._stream.fileno()).st_mode):
            self._stream.seek(0)
            found = self._stream.read(len(BEGINNING))
            # A crash can have cut it off within the first line.
            if BEGINNING.startswith(found):
                return
        msg = (
            f'{self.path} exists, and is no journal of lsc_pose annotate; move it away, or name '
            'another output with -o'
        )
        raise InputError(msg)

    def _cut(self) -> None:
        self._stream.truncate(self._end)
        self._stream.seek(self._end)

    def _write(self, data: bytes) -> None:
        rest = memoryview(data)
        while rest:
            rest = rest[self._stream.write(rest) :]
        os.fsync(self._stream.fileno())

    def _take_back(self) -> str:
        """Remove what was written of a change that failed, and return whether it is kept."""
        try:
            self._cut()
        except OSError:
            return 'may not be kept'
        return 'is not kept'
