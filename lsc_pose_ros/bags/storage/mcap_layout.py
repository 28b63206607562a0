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

"""Lists the chunks and messages of an MCAP file by the heads of its records, without its index.

The index at the end of a file can be missing or incomplete. The head of a chunk says which times
it covers, so the data themselves tell in which order to read them.
"""

import struct
from itertools import pairwise
from typing import IO, NamedTuple

from mcap.opcode import Opcode

from lsc_pose_ros.bags.storage.damage import DAMAGE
from lsc_pose_ros.bags.storage.time_order import TimedPart

MAGIC_SIZE = 8
RECORD_HEAD = struct.Struct('<BQ')  # opcode and length
_CHUNK_HEAD = struct.Struct('<QQQ')  # earliest time, latest time, size without compression
_MESSAGE_HEAD = struct.Struct('<HIQ')  # channel, sequence number, log time
_CHANNEL_NUMBER = struct.Struct('<H')


class McapLayout(NamedTuple):
    """The records of the data section.

    Attributes:
        parts: chunks, and runs of messages outside of chunks that are in the order of time; the
            position is that of the first record in the file, bytes.
        channels: the numbers of the channels that have messages in a chunk, by its position,
            according to the message indexes behind it; without index the chunk is missing.
        cut: whether the file ends within a record.
    """

    parts: list[TimedPart]
    channels: dict[int, set[int]]
    cut: bool

    @property
    def indexed_channels(self) -> set[int]:
        """The numbers of all channels that have messages according to the message indexes."""
        return set().union(*self.channels.values())

    def parts_with(self, channels: set[int]) -> list[TimedPart]:
        """Return the parts that hold messages of `channels`, or may do so."""
        return [
            part
            for part in self.parts
            if part.position not in self.channels or self.channels[part.position] & channels
        ]

    @property
    def in_order(self) -> bool:
        """Whether no part begins before the end of an earlier one."""
        return all(before.end <= after.start for before, after in pairwise(self.parts))


def scan_layout(stream: IO[bytes]) -> McapLayout:
    """Return the layout of the MCAP file that `stream` reads from its beginning."""
    scan = _Scan(stream)
    try:
        while scan.next_record():
            pass
    except DAMAGE:
        scan.cut = True
    return McapLayout(scan.parts, scan.channels, scan.cut)


class _Scan:
    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream
        self._position = 0
        self._run_ends = -1  # the position behind the last message outside of chunks
        self.parts: list[TimedPart] = []
        self.channels: dict[int, set[int]] = {}
        self.cut = False
        self._read(MAGIC_SIZE)

    def next_record(self) -> bool:
        """Read the head of the next record and skip its content; return False at the end."""
        begin = self._position
        head = self._read(RECORD_HEAD.size)
        opcode, length = RECORD_HEAD.unpack(head)
        if opcode in (Opcode.DATA_END, Opcode.FOOTER):
            return False
        if opcode == Opcode.CHUNK:
            self._add_chunk(begin, *_CHUNK_HEAD.unpack(self._read(_CHUNK_HEAD.size)))
        elif opcode == Opcode.MESSAGE:
            _, _, log_time = _MESSAGE_HEAD.unpack(self._read(_MESSAGE_HEAD.size))
            self._add_message(begin, log_time, length)
            self._run_ends = begin + RECORD_HEAD.size + length
        elif opcode == Opcode.MESSAGE_INDEX:
            (channel,) = _CHANNEL_NUMBER.unpack(self._read(_CHANNEL_NUMBER.size))
            if self.parts:
                self.channels.setdefault(self.parts[-1].position, set()).add(channel)
        self._skip_to(begin + RECORD_HEAD.size + length)
        return True

    def _add_chunk(self, begin: int, start: int, end: int, size: int) -> None:
        if size:
            self.parts.append(TimedPart(start, max(start, end), size, begin))

    def _add_message(self, begin: int, log_time: int, length: int) -> None:
        if self.parts and begin == self._run_ends and self.parts[-1].end <= log_time:
            last = self.parts[-1]
            self.parts[-1] = last._replace(end=log_time, size=max(last.size, length))
        else:
            self.parts.append(TimedPart(log_time, log_time, length, begin))

    def _read(self, size: int) -> bytes:
        data = self._stream.read(size)
        if len(data) < size:
            raise EOFError
        self._position += size
        return data

    def _skip_to(self, position: int) -> None:
        if self._stream.seekable():
            self._stream.seek(position)
            # Seeking beyond the end is no error; the byte before must exist.
            self._position = position
            return
        while self._position < position:
            self._read(min(1 << 20, position - self._position))
