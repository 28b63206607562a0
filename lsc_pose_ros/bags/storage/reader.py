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

"""Reads the messages of a recording of any storage format in the order of time."""

from collections.abc import Container, Iterator
from dataclasses import replace
from itertools import pairwise
from operator import attrgetter
from pathlib import Path

import zstandard

from lsc_pose_ros.bags.storage.damage import DAMAGE
from lsc_pose_ros.bags.storage.layout import ZSTD_MAGIC, Part, find_parts
from lsc_pose_ros.bags.storage.mcap_file import McapPart
from lsc_pose_ros.bags.storage.recorded_metadata import METADATA_NAME
from lsc_pose_ros.bags.storage.serialized_messages import (
    ReadStatistics,
    SerializedMessage,
    TopicSummary,
)
from lsc_pose_ros.bags.storage.sqlite_file import SqlitePart
from lsc_pose_ros.bags.storage.time_order import TimedPart, in_time_order
from lsc_pose_ros.messages.type_names import full_type_name


class RecordingReader:
    """The serialized messages of a recording; each iteration reads it again.

    Attributes:
        path: the file or the bag folder.
        warnings: a sentence for each problem of the recording. The list grows during an iteration
            and is cleared by the next one.
        statistics: what the current or last iteration has read.
    """

    def __init__(self, path: Path | str) -> None:
        """Find the files of the recording.

        Args:
            path: an .mcap or .db3 file, or a bag folder.

        Raises:
            InputError: there is no recording.
        """
        self._layout = find_parts(Path(path))
        self._parts = [_open(part) for part in self._layout.parts]
        self._topics: dict[str, TopicSummary] | None = None
        self.path = self._layout.path
        self.warnings = list(self._layout.warnings)
        self.statistics = ReadStatistics()

    @property
    def topics(self) -> dict[str, TopicSummary]:
        """The topics by name, from the files; metadata.yaml adds what they do not tell.

        Raises:
            InputError: a file's list of topics cannot be read.
        """
        if self._topics is None:
            self._topics = _with_metadata(self._topics_of_files(), self._layout.topics or {})
        return self._topics

    @property
    def size(self) -> int:
        """The size of the files, bytes."""
        return sum(part.path.stat().st_size for part in self._layout.parts)

    @property
    def files(self) -> list[Path]:
        """The files of the recording, including metadata.yaml if it exists."""
        metadata = self.path / METADATA_NAME
        files = [part.path for part in self._layout.parts]
        return [*files, metadata] if metadata.exists() else files

    def __iter__(self) -> Iterator[SerializedMessage]:
        """Yield the messages in the order of log time."""
        self.warnings[:] = self._layout.warnings
        self.statistics = ReadStatistics()
        damaged = 0
        for message in self._in_time_order():
            whole = _decompressed(message)
            if whole is None:
                damaged += 1
            else:
                whole = whole._replace(type_name=self._type_of(whole))
                self.statistics.add(whole)
                yield whole
        if damaged:
            self.warnings.append(f'{damaged} messages were left out: they cannot be decompressed')

    def select(self, topics: Container[str]) -> Iterator[SerializedMessage]:
        """Yield the messages of some topics, file by file; the rest is hardly read.

        Damage is not told, and `statistics` do not change.
        """
        for part in self._parts:
            for message in part.select(topics):
                whole = _decompressed(message)
                if whole is not None:
                    yield whole._replace(type_name=self._type_of(whole))

    def _in_time_order(self) -> Iterator[SerializedMessage]:
        """Yield the messages of all files; files that overlap in time are merged."""
        spans = [part.span for part in self._parts]
        known = [
            TimedPart(*span, 0, position)
            for position, span in enumerate(spans)
            if span is not None
        ]
        if all(before.end <= after.start for before, after in pairwise(known)):
            for part in self._parts:
                yield from part.messages(self.warnings)
            return
        # A file without a known span has no readable messages, but its damage is a warning.
        for part, span in zip(self._parts, spans, strict=True):
            if span is None:
                yield from part.messages(self.warnings)
        yield from in_time_order(
            known,
            lambda part: self._parts[part.position].messages(self.warnings),
            attrgetter('log_time'),
        )

    def _type_of(self, message: SerializedMessage) -> str:
        """Return the full name of a message's type, from metadata.yaml if the file has none."""
        if not message.type_name and self._layout.topics and message.topic in self._layout.topics:
            return full_type_name(self._layout.topics[message.topic].type_name)
        return full_type_name(message.type_name)

    def _topics_of_files(self) -> dict[str, TopicSummary]:
        topics: dict[str, TopicSummary] = {}
        for part in self._parts:
            for name, topic in part.topics().items():
                known = topics.get(name)
                if known is not None:
                    counts = (known.count, topic.count)
                    total = None if None in counts else sum(filter(None, counts))
                    type_name = topic.type_name or known.type_name
                    topic = replace(topic, count=total, type_name=type_name)  # noqa: PLW2901
                topics[name] = topic
        return topics


def _with_metadata(
    topics: dict[str, TopicSummary], metadata: dict[str, TopicSummary]
) -> dict[str, TopicSummary]:
    """Return the topics of the files with what only metadata.yaml tells: types and other topics.

    Counts of metadata.yaml are not used: a recorder that was killed leaves them zero.
    """
    complete = {name: replace(each, count=0) for name, each in metadata.items()}
    for name, topic in topics.items():
        listed = metadata.get(name)
        type_name = topic.type_name or (listed.type_name if listed else '')
        qos = topic.qos or (listed.qos if listed else '')
        complete[name] = replace(topic, type_name=type_name, qos=qos)
    return {
        name: replace(each, type_name=full_type_name(each.type_name))
        for name, each in complete.items()
    }


def read_messages(path: Path | str) -> RecordingReader:
    """Open a recording for reading its serialized messages.

    Args:
        path: an .mcap or .db3 file (compressed as .zstd or not), or a bag folder with or without
            metadata.yaml.

    Raises:
        InputError: there is no recording.
    """
    return RecordingReader(path)


def _open(part: Part) -> McapPart | SqlitePart:
    return McapPart(part) if part.storage == 'mcap' else SqlitePart(part)


def _decompressed(message: SerializedMessage) -> SerializedMessage | None:
    """Return a message without rosbag2's message compression, None if the data are damaged.

    A serialized message starts with 0 (the high byte of the CDR representation), a compressed one
    with the magic number of zstd. The metadata are not used, because a single file may have none.
    """
    if not message.data.startswith(ZSTD_MAGIC):
        return message
    try:
        decompressor = zstandard.ZstdDecompressor().decompressobj()
        return message._replace(data=decompressor.decompress(message.data))
    except DAMAGE:
        return None
