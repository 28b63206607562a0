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

"""Files and folders under a temporary name, which are removed if the program ends before."""

import atexit
import os
import secrets
import shutil
from contextlib import suppress
from pathlib import Path

from lsc_pose_ros.files.sibling_names import sibling

_unfinished: dict[Path, int] = {}
"""The unfinished files and folders, and the processes that write them."""


def partial_name(target: Path) -> Path:
    """Return a new name beside `target`, which is removed if the program ends before it is placed.

    The random part keeps apart the writers of one file, even those of one process.
    """
    path = sibling(target, f'.{os.getpid()}.{secrets.token_hex(4)}.part', '.')
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
