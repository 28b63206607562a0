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

"""Reads one MCAP file in the order of time; of a damaged file, the messages before the damage."""

import os
from collections.abc import Container, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from operator import attrgetter
from typing import IO

from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.records import Channel, Chunk, DataEnd, McapRecord, Message, Schema
from mcap.stream_reader import StreamReader, breakup_chunk
from mcap.summary import Summary

from lsc_pose_ros.bags.storage.damage import DAMAGE, reason
from lsc_pose_ros.bags.storage.layout import Part, open_part, plain_copy
from lsc_pose_ros.bags.storage.mcap_layout import McapLayout, scan_layout
from lsc_pose_ros.bags.storage.serialized_messages import (
    ReadStatistics,
    SerializedMessage,
    TopicSummary,
)
from lsc_pose_ros.bags.storage.time_order import (
    LARGEST_OVERLAP,
    TimedPart,
    in_time_order,
    largest_overlap,
)

# The longest record of a compressed file, whose decompressed size is unknown.
_LONGEST_RECORD = 1 << 31
_COMPRESSIONS = ('', 'lz4', 'zstd')
_UNKNOWN = 'the unknown compression {}'
_SERIALIZATION = 'cdr'


class McapPart:
    """One MCAP file."""

    def __init__(self, part: Part) -> None:
        """Store the file; the methods open it."""
        self._part = part

    @cached_property
    def span(self) -> tuple[int, int] | None:
        """The earliest and the latest log time, nanoseconds; None without messages."""
        parts = self._layout.parts
        if not parts:
            return None
        return min(each.start for each in parts), max(each.end for each in parts)

    def topics(self) -> dict[str, TopicSummary]:
        """Return the topics, from the summary if it is complete, else by reading the file."""
        summary = self._summary
        if summary is None:
            return self._scanned_topics()
        counts = _trusted_counts(summary, self._layout)
        topics: dict[str, TopicSummary] = {}
        for number, channel in summary.channels.items():
            type_name = _type_name(channel, summary.schemas)
            _add_topic(topics, channel, type_name, counts.get(number))
        return topics

    def select(self, topics: Container[str]) -> Iterator[SerializedMessage]:
        """Yield the messages of some topics in the order of log time; other chunks are skipped."""
        schemas, channels = self._declared
        numbers = {number for number, channel in channels.items() if channel.topic in topics}
        layout = self._layout
        with self._opened(seekable=True) as stream:
            reading = self._pass(stream, [])
            reading.schemas.update(schemas)
            reading.channels.update(channels)
            wanted = layout._replace(parts=layout.parts_with(numbers))
            yield from (each for each in reading.messages_in_order(wanted) if each.topic in topics)

    def messages(self, warnings: list[str]) -> Iterator[SerializedMessage]:
        """Yield the messages in the order of log time, as far as the file can be read.

        Args:
            warnings: a sentence for each problem is appended.
        """
        layout = self._layout
        ordered = not layout.in_order
        if ordered and largest_overlap(layout.parts) > LARGEST_OVERLAP:
            ordered = False
            warnings.append(
                f'{self._part.path.name}: the messages are not in the order of time, and too many '
                'overlap to be sorted here; sort the file with `mcap sort`'
            )
        with self._opened(seekable=ordered) as stream:
            reading = self._pass(stream, warnings)
            if ordered:
                schemas, channels = self._declared
                reading.schemas.update(schemas)
                reading.channels.update(channels)
                yield from reading.messages_in_order(layout)
            else:
                yield from reading.messages()

    @cached_property
    def _layout(self) -> McapLayout:
        with open_part(self._part.path, compressed=self._part.compressed) as stream:
            return scan_layout(stream)

    @cached_property
    def _summary(self) -> Summary | None:
        """The summary at the end of the file, None if it is missing or incomplete."""
        if self._part.compressed:
            return None
        try:
            with open_part(self._part.path, compressed=False) as stream:
                summary = make_reader(stream).get_summary()
        except DAMAGE:
            return None
        return summary if summary and _is_complete(summary, self._layout) else None

    @cached_property
    def _declared(self) -> tuple[dict[int, Schema], dict[int, Channel]]:
        """All schemas and channels by their numbers, wherever the file declares them."""
        if self._summary is not None:
            return self._summary.schemas, self._summary.channels
        reading, _ = self._scan()
        return reading.schemas, reading.channels

    @contextmanager
    def _opened(self, *, seekable: bool) -> Iterator[IO[bytes]]:
        path, compressed = self._part.path, self._part.compressed
        if not (compressed and seekable):
            with open_part(path, compressed=compressed) as stream:
                yield stream
            return
        with (
            plain_copy(self._part, 'recording.mcap') as copy,
            open_part(copy, compressed=False) as stream,
        ):
            yield stream

    def _pass(self, stream: IO[bytes], warnings: list[str]) -> '_Pass':
        limit = _LONGEST_RECORD if self._part.compressed else os.fstat(stream.fileno()).st_size
        reading = _Pass(self._part.path.name, stream, limit, warnings)
        if self._summary is not None:
            reading.schemas.update(self._summary.schemas)
            reading.channels.update(self._summary.channels)
        return reading

    def _scan(self) -> tuple['_Pass', ReadStatistics]:
        """Read the whole file; return the pass and the statistics of its messages."""
        statistics = ReadStatistics()
        with open_part(self._part.path, compressed=self._part.compressed) as stream:
            reading = self._pass(stream, [])
            for message in reading.messages():
                statistics.add(message)
        return reading, statistics

    def _scanned_topics(self) -> dict[str, TopicSummary]:
        reading, statistics = self._scan()
        topics: dict[str, TopicSummary] = {}
        for channel in reading.channels.values():
            _add_topic(topics, channel, _type_name(channel, reading.schemas), None)
        return {
            topic: replace(summary, count=statistics.counts.get(topic, 0))
            for topic, summary in topics.items()
        }


def _is_complete(summary: Summary, layout: McapLayout) -> bool:
    """Return whether a summary declares the channels of all messages, and their schemas."""
    channels = summary.channels
    if any(each.schema_id and each.schema_id not in summary.schemas for each in channels.values()):
        return False
    if layout.indexed_channels:
        return layout.indexed_channels <= channels.keys()
    statistics = summary.statistics
    if statistics is None:
        return not layout.parts
    counted = sum(statistics.channel_message_counts.get(number, 0) for number in channels)
    return counted == statistics.message_count and (counted > 0 or not layout.parts)


def _trusted_counts(summary: Summary, layout: McapLayout) -> dict[int, int]:
    """Return the number of messages of each channel for which it is known."""
    statistics = summary.statistics
    if statistics is None:
        return {}
    counts = statistics.channel_message_counts
    if sum(counts.values()) != statistics.message_count or (layout.parts and not counts):
        return {}
    return {
        number: counts.get(number, 0)
        for number in summary.channels
        if counts.get(number, 0) or number not in layout.indexed_channels
    }


class _Pass:
    """One pass through a file."""

    def __init__(self, name: str, stream: IO[bytes], limit: int, warnings: list[str]) -> None:
        self._name = name
        self._stream = stream
        self._limit = limit
        self._warnings = warnings
        self._statistics = ReadStatistics()
        self._damaged_chunks: list[str] = []
        self._lost = 0
        self._complete = False
        self._foreign: dict[str, str] = {}
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}

    def messages(self) -> Iterator[SerializedMessage]:
        """Yield the messages in the order of the file; those of a chunk in the order of time."""
        for record in self._records():
            message = self._message(record)
            if message is not None:
                self._statistics.add(message)
                yield message
        self._warn()

    def messages_in_order(self, layout: McapLayout) -> Iterator[SerializedMessage]:
        """Yield the messages in the order of log time; all channels must be known."""
        for message in in_time_order(layout.parts, self._messages_of, attrgetter('log_time')):
            self._statistics.add(message)
            yield message
        if layout.cut:
            self._warn_of_end(EOFError())
        self._warn()

    def _messages_of(self, part: TimedPart) -> Iterator[SerializedMessage]:
        """Yield the messages of a chunk or of a run of messages, in the order of time."""
        position, last = part.position, part.start
        while last <= part.end:
            self._stream.seek(position)
            reader = StreamReader(
                self._stream, skip_magic=True, emit_chunks=True, record_size_limit=self._limit
            )
            try:
                record = next(reader.records, None)
            except DAMAGE as error:
                self._damaged_chunks.append(reason(error))
                return
            position = self._stream.tell()
            if isinstance(record, Chunk):
                yield from filter(None, map(self._message, self._break_up(record)))
                return
            if not isinstance(record, Message) or not last <= record.log_time <= part.end:
                return
            last = record.log_time
            message = self._message(record)
            if message is not None:
                yield message

    def _records(self) -> Iterator[McapRecord]:
        """Yield the records, including those in chunks, up to the end or the damage."""
        records = StreamReader(
            self._stream, emit_chunks=True, validate_crcs=True, record_size_limit=self._limit
        ).records
        while True:
            try:
                record = next(records, None)
            except DAMAGE as error:
                self._warn_of_end(error)
                return
            if record is None:
                return
            if isinstance(record, Chunk):
                yield from self._break_up(record)
            else:
                yield record

    def _break_up(self, chunk: Chunk) -> list[McapRecord]:
        try:
            if chunk.compression not in _COMPRESSIONS:
                raise McapError(_UNKNOWN.format(chunk.compression))
            records = breakup_chunk(chunk, validate_crc=True)
        except DAMAGE as error:
            # Only this chunk is lost, because the position of the next one is known.
            self._damaged_chunks.append(reason(error))
            return []
        # Declarations first, then the messages in the order of time.
        records.sort(key=lambda each: each.log_time if isinstance(each, Message) else -1)
        return records

    def _message(self, record: McapRecord) -> SerializedMessage | None:
        """Return the message in `record`; store a schema or channel."""
        if isinstance(record, Schema):
            self.schemas[record.id] = record
        elif isinstance(record, Channel):
            self.channels[record.id] = record
        elif isinstance(record, DataEnd):
            self._complete = True
        elif isinstance(record, Message):
            channel = self.channels.get(record.channel_id)
            if channel is None:
                self._lost += 1
            elif channel.message_encoding != _SERIALIZATION:
                self._foreign[channel.topic] = channel.message_encoding
            else:
                return SerializedMessage(
                    channel.topic, _type_name(channel, self.schemas), record.log_time, record.data
                )
        return None

    def _warn_of_end(self, error: BaseException) -> None:
        if self._complete:
            text = f'the index at its end is damaged ({reason(error)}); all messages were read'
        else:
            text = f'damaged ({reason(error)}); read up to there: {self._statistics}'
        self._warnings.append(f'{self._name}: {text}')

    def _warn(self) -> None:
        if self._damaged_chunks:
            self._warnings.append(
                f'{self._name}: {len(self._damaged_chunks)} damaged chunks were left out '
                f'({self._damaged_chunks[0]})'
            )
        if self._lost:
            self._warnings.append(
                f'{self._name}: {self._lost} messages were left out because the records of '
                'their topics are damaged'
            )
        for topic, encoding in self._foreign.items():
            self._warnings.append(
                f'{self._name}: the topic {topic} was left out: its encoding is {encoding}, '
                f'not {_SERIALIZATION}'
            )


def _type_name(channel: Channel, schemas: dict[int, Schema]) -> str:
    schema = schemas.get(channel.schema_id)
    return schema.name if schema is not None else ''


def _add_topic(
    topics: dict[str, TopicSummary], channel: Channel, type_name: str, count: int | None
) -> None:
    """Add a channel to its topic; a topic has one channel for each recorded publisher."""
    if channel.message_encoding != _SERIALIZATION:
        return
    known = topics.get(channel.topic)
    if known is not None and known.count is not None and count is not None:
        count += known.count
    qos = channel.metadata.get('offered_qos_profiles', '')
    topics[channel.topic] = TopicSummary(type_name, count, qos)
