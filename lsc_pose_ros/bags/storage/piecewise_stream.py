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

"""A stream that allocates no more than it holds.

The reader of MCAP asks for as many bytes as a damaged length claims, and a buffered file
allocates them all before it finds that it has fewer.
"""

from typing import IO, Any

_PIECE = 1 << 20


class PiecewiseStream:
    """Reads a stream in pieces; all else is the stream's own."""

    def __init__(self, stream: IO[bytes]) -> None:
        """Wrap `stream`."""
        self._stream = stream
        self.seek, self.tell = stream.seek, stream.tell

    def read(self, size: int = -1) -> bytes:
        """Return `size` bytes, or fewer at the end of the stream; all that follow if it is -1."""
        if 0 <= size <= _PIECE:
            return self._stream.read(size)
        pieces: list[bytes] = []
        missing = size
        while missing:
            piece = self._stream.read(_PIECE if missing < 0 else min(missing, _PIECE))
            if not piece:
                break
            pieces.append(piece)
            missing -= len(piece) if missing > 0 else 0
        return b''.join(pieces)

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        """Return an attribute of the stream."""
        return getattr(self._stream, name)
