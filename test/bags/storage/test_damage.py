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

"""Damaged recordings: read up to the damage with a warning, or refused with one clear error."""

import re

import numpy as np
import pytest
import zstandard
from mcap.records import Chunk
from mcap.stream_reader import StreamReader
from mcap.writer import Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter

from lsc_pose_ros.bags import RecordingWriter, open_recording, read_messages
from lsc_pose_ros.bags.serialization.type_store import typestore
from lsc_pose_ros.errors import InputError


@pytest.fixture(scope='session')
def messages(simple_frames, tmp_path_factory):
    """Of forty frames with noise: enough bytes for several chunks and several zstd blocks."""
    random = np.random.default_rng(6)
    path = tmp_path_factory.mktemp('noisy') / 'noisy.mcap'
    with RecordingWriter(path) as writer:
        for number in range(40):
            frame = simple_frames[number % 10]
            depth = frame.depth + random.normal(0, 0.1, frame.depth.shape).astype(np.float32)
            writer.write_frame(frame._replace(depth=depth, stamp=number * 33_333_333))
    return list(read_messages(path))


@pytest.fixture(scope='session')
def mcap_bytes(messages, tmp_path_factory):
    """A recording of many small chunks, with checksums."""
    path = tmp_path_factory.mktemp('mcap') / 'one.mcap'
    with path.open('wb') as stream:
        writer = Writer(stream, chunk_size=8000, enable_data_crcs=True)
        writer.start(profile='ros2')
        numbers = {}
        for message in messages:
            if message.topic not in numbers:
                schema = writer.register_schema(message.type_name, 'ros2msg', b'')
                numbers[message.topic] = writer.register_channel(message.topic, 'cdr', schema)
            writer.add_message(
                numbers[message.topic], message.log_time, message.data, message.log_time
            )
        writer.finish()
    return path.read_bytes()


@pytest.fixture(scope='session')
def sqlite_bytes(messages, tmp_path_factory):
    path = tmp_path_factory.mktemp('sqlite') / 'bag'
    connections = {}
    with BagWriter(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        for message in messages:
            if message.topic not in connections:
                connections[message.topic] = writer.add_connection(
                    message.topic, message.type_name, typestore=typestore()
                )
            writer.write(connections[message.topic], message.log_time, message.data)
    return (path / 'bag.db3').read_bytes()


def chunk_places(data, tmp_path):
    """Where each chunk's record starts and ends."""
    path = tmp_path / 'whole.mcap'
    path.write_bytes(data)
    places = []
    with path.open('rb') as stream:
        before = 0
        for record in StreamReader(stream, emit_chunks=True).records:
            if isinstance(record, Chunk):
                places.append((before, stream.tell()))
            before = stream.tell()
    return places


@pytest.mark.parametrize('share', [0.3, 0.5, 0.8])
def test_truncated_file_is_read_up_to_there(tmp_path, mcap_bytes, messages, share):
    path = tmp_path / 'cut.mcap'
    path.write_bytes(mcap_bytes[: int(len(mcap_bytes) * share)])
    reader = read_messages(path)
    read = list(reader)
    assert 0 < len(read) < len(messages)
    assert read == messages[: len(read)]
    (warning,) = reader.warnings
    assert list(reader) == read
    assert reader.warnings == [warning]  # anew, not once more
    match = re.search(r'up to there: (\d+) messages, ([\d.]+) MB, ([\d.]+) s', warning)
    assert int(match[1]) == len(read)
    assert float(match[2]) == pytest.approx(sum(len(m.data) for m in read) * 1e-6, abs=0.051)
    seconds = (read[-1].log_time - read[0].log_time) * 1e-9
    assert float(match[3]) == pytest.approx(seconds, abs=0.051)
    assert reader.topics['/depth/image'].count == sum(m.topic == '/depth/image' for m in read)
    frames = open_recording(path)
    assert sum(1 for _ in frames) >= len(read) // 4 - 1
    assert frames.warnings[0] == warning


def test_only_the_index_is_lost(tmp_path, mcap_bytes, messages):
    path = tmp_path / 'cut.mcap'
    path.write_bytes(mcap_bytes[:-30])
    reader = read_messages(path)
    assert list(reader) == messages
    assert 'the index at its end is damaged' in reader.warnings[0]
    assert 'all messages were read' in reader.warnings[0]


def test_damaged_chunk_is_left_out_with_a_warning(tmp_path, mcap_bytes, messages):
    start, end = chunk_places(mcap_bytes, tmp_path)[3]
    damaged = bytearray(mcap_bytes)
    damaged[(start + end) // 2 + 20] ^= 4
    path = tmp_path / 'rotten.mcap'
    path.write_bytes(damaged)
    reader = read_messages(path)
    read = list(reader)
    assert len(messages) - 8 < len(read) < len(messages)
    assert [message for message in messages if message in read] == read
    assert any('1 damaged chunks were left out' in warning for warning in reader.warnings)
    assert any('a checksum is wrong' in warning for warning in reader.warnings)


def test_channels_that_were_in_a_rotten_chunk_are_found_in_the_index(
    tmp_path, mcap_bytes, messages
):
    start, end = chunk_places(mcap_bytes, tmp_path)[0]
    damaged = bytearray(mcap_bytes)
    damaged[(start + end) // 2] ^= 255
    path = tmp_path / 'rotten.mcap'
    path.write_bytes(damaged)
    assert list(read_messages(path)) == messages[-len(list(read_messages(path))) :]
    # Without the index too, nobody knows what the other chunks' messages are.
    path.write_bytes(damaged[: len(damaged) * 2 // 3])
    reader = read_messages(path)
    assert {message.topic for message in reader} != {message.topic for message in messages}
    assert any('records of their topics are damaged' in warning for warning in reader.warnings)


def test_wrong_checksum_of_a_file_without_chunks(tmp_path, messages):
    path = tmp_path / 'one.mcap'
    with path.open('wb') as stream:
        writer = Writer(stream, use_chunking=False, enable_data_crcs=True)
        writer.start(profile='ros2')
        schema = writer.register_schema(messages[0].type_name, 'ros2msg', b'')
        channel = writer.register_channel('/depth/image', 'cdr', schema)
        for number in range(3):
            writer.add_message(channel, number, messages[0].data, number)
        writer.finish()
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)
    reader = read_messages(path)
    assert len(list(reader)) == 3
    assert 'a checksum is wrong' in reader.warnings[0]


def test_truncated_sqlite_bag(tmp_path, sqlite_bytes, messages):
    path = tmp_path / 'cut.db3'
    path.write_bytes(sqlite_bytes[: len(sqlite_bytes) // 2])
    reader = read_messages(path)
    read = list(reader)
    assert read == messages[: len(read)]
    assert len(read) < len(messages)
    assert 'cut.db3: damaged' in reader.warnings[0]


def test_truncated_compressed_file(tmp_path, mcap_bytes, sqlite_bytes, messages):
    for name, data in (('cut.mcap.zstd', mcap_bytes), ('cut.db3.zstd', sqlite_bytes)):
        packed = zstandard.compress(data)
        path = tmp_path / name
        path.write_bytes(packed[: len(packed) * 3 // 4])
        reader = read_messages(path)
        read = list(reader)
        assert read == messages[: len(read)]
        assert len(read) < len(messages)
        assert f'{name}: damaged' in reader.warnings[0]


def read_whatever_is_there(path):
    """Read it in every way; return whether something was wrong."""
    try:
        reader = open_recording(path)
        for _ in reader:
            pass
        reader.count  # noqa: B018
    except InputError as error:
        sentences = [str(error)]
    else:
        sentences = reader.warnings
    assert not any('\n' in sentence for sentence in sentences)
    return bool(sentences)


@pytest.mark.parametrize('kind', ['mcap', 'db3', 'mcap.zstd', 'db3.zstd'])
def test_random_damage_never_does_worse_than_an_input_error(
    tmp_path, mcap_bytes, sqlite_bytes, kind
):
    random = np.random.default_rng(1)
    data = mcap_bytes if kind.startswith('mcap') else sqlite_bytes
    if kind.endswith('zstd'):
        data = zstandard.compress(data)
    noticed = 0
    for number in range(60):
        damaged = bytearray(data)
        if number % 3 == 0:
            damaged = damaged[: int(random.integers(len(data)))]
        elif number % 3 == 1:
            damaged[int(random.integers(len(data)))] ^= 1 << int(random.integers(8))
        else:
            place = int(random.integers(len(data)))
            damaged[place : place + 40] = random.bytes(40)
        path = tmp_path / f'damaged.{kind}'
        path.write_bytes(damaged)
        noticed += read_whatever_is_there(path)
    assert noticed >= 15


def test_random_damage_to_a_real_bag(tmp_path, shared):
    random = np.random.default_rng(2)
    data = (shared / 'bags' / 'd160_none' / 'd160_none_0.mcap').read_bytes()
    # The records' frames are few bytes among the images': aim where they are.
    places = [0, 8, 60, 600, 3_000, len(data) - 40_000, len(data) - 4_000, len(data) - 40]
    for place in places:
        damaged = bytearray(data)
        damaged[place + int(random.integers(30))] ^= 1 << int(random.integers(8))
        path = tmp_path / 'damaged.mcap'
        path.write_bytes(damaged)
        read_whatever_is_there(path)
