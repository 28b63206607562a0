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

"""Reads one MCAP file as a stream; a damaged file gives the messages before the damage."""

import os
from collections.abc import Iterator
from dataclasses import replace
from typing import IO

from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.records import Channel, Chunk, DataEnd, McapRecord, Message, Schema
from mcap.stream_reader import StreamReader, breakup_chunk
from mcap.summary import Summary

from lsc_pose_ros.bags.storage.damage import DAMAGE, reason
from lsc_pose_ros.bags.storage.layout import Part, open_part
from lsc_pose_ros.bags.storage.serialized_messages import (
    ReadStatistics,
    SerializedMessage,
    TopicSummary,
)

# The longest record of a compressed file, whose decompressed size is unknown.
_LONGEST_RECORD = 1 << 31
_COMPRESSIONS = ('', 'lz4', 'zstd')
_UNKNOWN = 'the unknown compression {}'
_SERIALIZATION = 'cdr'


class McapPart:
    """One MCAP file."""

    def __init__(self, part: Part) -> None:
        """Store the file; `topics` and `messages` open it."""
        self._part = part

    def topics(self) -> dict[str, TopicSummary]:
        """Return the topics, from the summary if there is one, else by reading the file."""
        summary = self._summary()
        if summary is None or not summary.channels:
            return self._scan()
        counts = summary.statistics.channel_message_counts if summary.statistics else None
        topics: dict[str, TopicSummary] = {}
        for number, channel in summary.channels.items():
            count = None if counts is None else counts.get(number, 0)
            _add_topic(topics, channel, _type_name(channel, summary.schemas), count)
        return topics

    def messages(self, warnings: list[str]) -> Iterator[SerializedMessage]:
        """Yield the messages in the order of the file, up to the first damage.

        Args:
            warnings: a sentence for each problem is appended.
        """
        with open_part(self._part.path, compressed=self._part.compressed) as stream:
            yield from self._pass(stream, warnings).messages()

    def _pass(self, stream: IO[bytes], warnings: list[str]) -> '_Pass':
        limit = _LONGEST_RECORD if self._part.compressed else os.fstat(stream.fileno()).st_size
        reading = _Pass(self._part.path.name, stream, limit, warnings)
        summary = self._summary()
        if summary is not None:
            reading.schemas.update(summary.schemas)
            reading.channels.update(summary.channels)
        return reading

    def _summary(self) -> Summary | None:
        if self._part.compressed:
            return None
        try:
            with self._part.path.open('rb') as stream:
                return make_reader(stream).get_summary()
        except DAMAGE:
            return None

    def _scan(self) -> dict[str, TopicSummary]:
        topics: dict[str, TopicSummary] = {}
        statistics = ReadStatistics()
        with open_part(self._part.path, compressed=self._part.compressed) as stream:
            reading = self._pass(stream, [])
            for message in reading.messages():
                statistics.add(message)
        for channel in reading.channels.values():
            _add_topic(topics, channel, _type_name(channel, reading.schemas), None)
        return {
            topic: replace(summary, count=statistics.counts.get(topic, 0))
            for topic, summary in topics.items()
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
        for record in self._records():
            message = self._message(record)
            if message is not None:
                self._statistics.add(message)
                yield message
        self._warn()

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
            return breakup_chunk(chunk, validate_crc=True)
        except DAMAGE as error:
            # Only this chunk is lost, because the position of the next one is known.
            self._damaged_chunks.append(reason(error))
            return []

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
