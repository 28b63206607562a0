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

"""The standard streams of the process, which may be closed, full or unable to show a name."""

import io
import os
import sys
from pathlib import Path


def prepare_streams() -> None:
    """Make printing harmless, whatever the standard streams are.

    - A stream that is closed swallows what is printed. Its descriptor is occupied, so that no
      file gets it, into which an output to `-` would go; it cannot be written, so that such an
      output is refused.
    - A name with characters or bytes that the encoding lacks is printed with escapes.
    """
    for number in (0, 1, 2):
        if not _is_open(number):
            os.open(os.devnull, os.O_RDONLY)  # gets the lowest number that is free
    # Python has None for a closed stream.
    if sys.stdout is None:
        sys.stdout = _nowhere()
    if sys.stderr is None:
        sys.stderr = _nowhere()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors='backslashreplace')


def silence_stdout() -> None:
    """Prevent an error message at exit about a pipe that is closed, or a disk that is full."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _is_open(descriptor: int) -> bool:
    try:
        os.fstat(descriptor)
    except OSError:
        return False
    return True


def _nowhere() -> io.TextIOWrapper:
    return Path(os.devnull).open('w', encoding='utf-8')
