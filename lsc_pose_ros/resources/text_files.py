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

"""Reads small text files that users write or get from strangers."""

from pathlib import Path
from typing import BinaryIO

from lsc_pose_ros.errors import InputError

LARGEST_TEXT = 1 << 20
"""The largest file of settings, bytes; nobody writes a larger one."""

_PIECE = 1 << 16


def read_text(path: Path, what: str, largest: int = LARGEST_TEXT) -> str:
    """Return the contents of a text file in UTF-8; no more than `largest` bytes are read.

    Args:
        path: the file.
        what: names it in errors, such as 'extrinsic'.
        largest: the most bytes that it may have.

    Raises:
        InputError: it cannot be read, is larger, or is not UTF-8.
    """
    try:
        with path.open('rb') as stream:
            data = _read(stream, largest)
        if len(data) <= largest:
            return data.decode('utf-8-sig')
    except (OSError, ValueError) as error:  # no file, no path, or not UTF-8
        why = error.strerror if isinstance(error, OSError) else None
        msg = f'cannot read the {what} {path}: {why or error}'
        raise InputError(msg) from error
    msg = f'the {what} {path} has more than {largest >> 10} kB, which is too much for such a file'
    raise InputError(msg)


def _read(stream: BinaryIO, largest: int) -> bytes:
    """Return what the stream has, and at most a piece more than `largest` bytes.

    `read(largest)` would allocate so many bytes also for a short file.
    """
    data = bytearray()
    while len(data) <= largest and (piece := stream.read(_PIECE)):
        data += piece
    return bytes(data)
