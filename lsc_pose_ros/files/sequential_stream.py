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

"""The stream of a pipe or a device, which is written one byte after the other."""

import io
from typing import Any, NoReturn


class SequentialStream(io.BufferedWriter):
    """A binary stream that has only a next byte, but knows how many were written.

    What is written does not depend on what is behind the descriptor: a file that the shell has
    opened could be sought, where others write, too.
    """

    def __init__(self, descriptor: int) -> None:
        """Write to `descriptor`, and close it at the end."""
        super().__init__(io.FileIO(descriptor, 'wb'))
        self._position = 0

    def write(self, data: Any, /) -> int:  # noqa: ANN401 - bytes or what has them
        """Write `data`; return its size, bytes."""
        size = super().write(data)
        self._position += size
        return size

    def tell(self) -> int:
        """Return the number of bytes that are written."""
        return self._position

    def seekable(self) -> bool:
        """Return False."""
        return False

    def seek(self, _offset: int, _whence: int = 0, /) -> NoReturn:
        """Raise UnsupportedOperation, as all streams do that cannot be sought."""
        msg = 'a stream that is written one byte after the other has no other place'
        raise io.UnsupportedOperation(msg)

    def truncate(self, _size: int | None = None, /) -> NoReturn:
        """Raise UnsupportedOperation."""
        msg = 'a stream that is written one byte after the other cannot be cut'
        raise io.UnsupportedOperation(msg)
