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

"""Recordings whose files are not in the order of time are read in that order."""

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import pytest
import zstandard
from mcap.writer import CompressionType, Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter

from lsc_pose_ros.bags import SerializedMessage, open_recording, read_messages
from lsc_pose_ros.bags.serialization.type_store import typestore
from lsc_pose_ros.bags.storage import mcap_file
from lsc_pose_ros.bags.storage.time_order import TimedPart, in_time_order, largest_overlap

Messages = list[SerializedMessage]


@pytest.fixture(scope='session')
def messages(labelled_recording: Path) -> Messages:
    return sorted(read_messages(labelled_recording), key=lambda each: each.log_time)


def grouped(messages: Messages) -> Messages:
    return sorted(messages, key=lambda each: each.topic)


def halves(messages: Messages) -> Messages:
    """The second half of the time first, as `cat` of two recordings."""
    middle = len(messages) // 2
    return messages[middle:] + messages[:middle]


ORDERS: list[Callable[[Messages], Messages]] = [grouped, halves, lambda each: each[::-1]]


def write_mcap(path: Path, messages: Messages, **options: object) -> Path:
    with path.open('wb') as stream:
        writer = Writer(stream, **options)
        writer.start(profile='ros2')
        channels: dict[str, int] = {}
        for message in messages:
            if message.topic not in channels:
                schema = writer.register_schema(message.type_name, 'ros2msg', b'')
                channels[message.topic] = writer.register_channel(message.topic, 'cdr', schema)
            number = channels[message.topic]
            writer.add_message(number, message.log_time, message.data, message.log_time)
        writer.finish()
    return path


def write_sqlite(path: Path, messages: Messages) -> Path:
    connections = {}
    with BagWriter(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        for message in messages:
            if message.topic not in connections:
                connections[message.topic] = writer.add_connection(
                    message.topic, message.type_name, typestore=typestore()
                )
            writer.write(connections[message.topic], message.log_time, message.data)
    return path


def assert_in_order(path: Path, messages: Messages) -> None:
    reader = read_messages(path)
    read = list(reader)
    times = [message.log_time for message in read]
    assert times == sorted(times)
    assert sorted(read) == sorted(messages)
    assert reader.warnings == []
    frames = open_recording(path)
    assert len(list(frames)) == 10
    assert frames.warnings == []


@pytest.mark.parametrize('order', ORDERS)
@pytest.mark.parametrize(
    'options',
    [
        {'chunk_size': 3000},
        {'chunk_size': 3000, 'use_statistics': False, 'use_summary_offsets': False},
        {'chunk_size': 3000, 'repeat_channels': False, 'repeat_schemas': False},
        {'chunk_size': 10**9, 'compression': CompressionType.NONE},
        {'use_chunking': False},
    ],
)
def test_mcap(
    tmp_path: Path,
    messages: Messages,
    order: Callable[[Messages], Messages],
    options: dict[str, object],
) -> None:
    path = write_mcap(tmp_path / 'one.mcap', order(messages), **options)
    assert_in_order(path, messages)


@pytest.mark.parametrize('order', ORDERS)
def test_compressed_mcap(
    tmp_path: Path, messages: Messages, order: Callable[[Messages], Messages]
) -> None:
    plain = write_mcap(tmp_path / 'one.mcap', order(messages), chunk_size=3000)
    path = tmp_path / 'one.mcap.zstd'
    path.write_bytes(zstandard.ZstdCompressor().compress(plain.read_bytes()))
    plain.unlink()
    assert_in_order(path, messages)


@pytest.mark.parametrize('order', ORDERS)
@pytest.mark.parametrize('index', [True, False])
def test_sqlite(
    tmp_path: Path, messages: Messages, order: Callable[[Messages], Messages], *, index: bool
) -> None:
    path = write_sqlite(tmp_path / 'bag', order(messages))
    if not index:
        with closing(sqlite3.connect(path / 'bag.db3')) as database:
            database.execute('DROP INDEX IF EXISTS timestamp_idx')
            database.commit()
    assert_in_order(path, messages)


def test_files_of_a_bag_that_overlap(tmp_path: Path, messages: Messages) -> None:
    folder = tmp_path / 'bag'
    folder.mkdir()
    by_topic = grouped(messages)
    write_mcap(folder / 'bag_0.mcap', by_topic[20:], chunk_size=3000)
    write_mcap(folder / 'bag_1.mcap', by_topic[:20], chunk_size=3000)
    assert_in_order(folder, messages)


def test_file_that_overlaps_too_much_is_read_as_it_is_and_said(
    tmp_path: Path, messages: Messages, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mcap_file, 'LARGEST_OVERLAP', 1000)
    path = write_mcap(tmp_path / 'one.mcap', grouped(messages), chunk_size=3000)
    reader = read_messages(path)
    times = [each.log_time for each in reader]
    assert times != sorted(times)
    assert len(times) == len(messages)
    (warning,) = reader.warnings
    assert 'not in the order of time' in warning
    assert 'mcap sort' in warning


def test_only_parts_that_overlap_are_open_together() -> None:
    opened: set[int] = set()
    most = 0

    def read(part: TimedPart) -> Iterator[int]:
        nonlocal most
        opened.add(part.position)
        most = max(most, len(opened))
        yield from range(part.start, part.end + 1)
        opened.discard(part.position)

    parts = [TimedPart(10 * k, 10 * k + 14, 7, k) for k in (3, 0, 2, 1)]
    found = list(in_time_order(parts, read, lambda item: item))
    assert found == sorted(found)
    assert len(found) == 4 * 15
    assert most == 2
    assert largest_overlap(parts) == 14
