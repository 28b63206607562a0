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

"""Temporary files and folders."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from lsc_pose_ros.errors import InputError


@contextmanager
def temporary_folder() -> Iterator[Path]:
    """Make a folder, and remove it at the end.

    Raises:
        InputError: no folder for temporary files can be written.
    """
    try:
        folder = tempfile.TemporaryDirectory(prefix='lsc_pose_')
    except OSError as error:
        raise _no_folder(error) from error
    with folder as name:
        yield Path(name)


def temporary_file() -> IO[bytes]:
    """Open a file without a name, which is gone when it is closed.

    Raises:
        InputError: no folder for temporary files can be written.
    """
    try:
        return tempfile.TemporaryFile(prefix='lsc_pose_')
    except OSError as error:
        raise _no_folder(error) from error


def _no_folder(error: OSError) -> InputError:
    return InputError(
        f'no temporary file can be written ({error.strerror or error}); name a folder that can be '
        'written in the variable TMPDIR'
    )
