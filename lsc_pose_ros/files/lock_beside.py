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

"""A lock beside a file that is replaced, so that one program at a time works on it."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.file_lock import is_at, lock_file
from lsc_pose_ros.files.output_place import writing
from lsc_pose_ros.files.sibling_names import sibling


@contextmanager
def locked(path: Path, busy: str) -> Iterator[None]:
    """Hold the lock of the file `path`, which is an empty file `.NAME.lock` beside it.

    The system releases the lock when the process ends, however it ends; the empty file of a
    process that is killed stays, and does no harm. Where the system or the file system has no
    locks, nothing is locked.

    Args:
        path: the file, which need not exist.
        busy: the sentence for users if another program holds the lock.

    Raises:
        InputError: another program holds it, or the folder cannot be written.
    """
    lock = sibling(Path(os.path.realpath(path)), '.lock', '.')
    with writing(lock):
        descriptor = _acquire(lock)
    if descriptor is None:
        raise InputError(busy)
    try:
        yield
    finally:
        # Removed while it is locked: who opens the file from now on makes a new one.
        with suppress(OSError):
            lock.unlink()
        os.close(descriptor)


def _acquire(lock: Path) -> int | None:
    """Return a descriptor of the file `lock` that is locked; None if another one is.

    Raises:
        OSError: the file cannot be made.
    """
    while True:
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            lock_file(descriptor)
        except BlockingIOError:
            os.close(descriptor)
            return None
        except BaseException:
            os.close(descriptor)
            raise
        if is_at(lock, descriptor):
            return descriptor
        # The holder has removed the file between opening and locking.
        os.close(descriptor)
