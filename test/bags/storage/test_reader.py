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

"""The same messages in every container that rosbag2 writes."""

import os
import shutil
import sqlite3
from pathlib import Path

import pytest
import yaml
import zstandard
from mcap.writer import CompressionType, IndexType, Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter

from lsc_pose_ros.bags import RecordingWriter, open_recording, read_messages
from lsc_pose_ros.bags.serialization.type_store import typestore
from lsc_pose_ros.errors import InputError

SQLITE, MCAP = StoragePlugin.SQLITE3, StoragePlugin.MCAP
NONE = CompressionMode.NONE


@pytest.fixture(scope='session')
def messages(labelled_recording):
    return list(read_messages(labelled_recording))


def write_bag(path, messages, storage, mode, version=9):
    """A bag folder by rosbags."""
    writer = BagWriter(path, version=version, storage_plugin=storage)
    if mode != NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    connections = {}
    with writer:
        for message in messages:
            if message.topic not in connections:
                connections[message.topic] = writer.add_connection(
                    message.topic, message.type_name, typestore=typestore()
                )
            writer.write(connections[message.topic], message.log_time, message.data)
    return path


def write_mcap(path, messages, **options):
    """A lone file by mcap, with whatever `options` its writer knows."""
    with path.open('wb') as stream:
        writer = Writer(stream, **options)
        writer.start(profile='ros2')
        channels = {}
        for message in messages:
            if message.topic not in channels:
                schema = writer.register_schema(message.type_name, 'ros2msg', b'')
                channels[message.topic] = writer.register_channel(message.topic, 'cdr', schema)
            time = message.log_time
            writer.add_message(channels[message.topic], time, message.data, time)
        writer.finish()
    return path


def by_time(messages):
    return sorted(messages, key=lambda message: (message.log_time, message.topic))


@pytest.mark.parametrize('version', [8, 9])
@pytest.mark.parametrize(
    ('storage', 'mode'),
    [
        (SQLITE, NONE),
        (SQLITE, CompressionMode.FILE),
        (SQLITE, CompressionMode.MESSAGE),
        (MCAP, NONE),
        (MCAP, CompressionMode.FILE),
        (MCAP, CompressionMode.MESSAGE),
        (MCAP, CompressionMode.STORAGE),
    ],
)
@pytest.mark.parametrize('part', ['folder', 'folder without metadata', 'lone file'])
def test_bags(tmp_path, messages, storage, mode, version, part):
    path = write_bag(tmp_path / 'bag', messages, storage, mode, version)
    if part == 'folder without metadata':
        (path / 'metadata.yaml').unlink()
    elif part == 'lone file':
        (path,) = (file for file in path.iterdir() if file.name != 'metadata.yaml')
    reader = read_messages(path)
    assert by_time(reader) == by_time(messages)
    assert reader.warnings == []
    counts = {name: topic.count for name, topic in reader.topics.items()}
    assert counts == dict.fromkeys(
        ['/depth/image', '/depth/camera_info', '/mask', '/ground_truth/skeletons'], 10
    )
    assert len(list(open_recording(path))) == 10


@pytest.mark.parametrize('compression', CompressionType)
@pytest.mark.parametrize('chunks', [True, False])
def test_lone_mcap(tmp_path, messages, compression, chunks):
    options = {'compression': compression, 'use_chunking': chunks, 'chunk_size': 9000}
    path = write_mcap(tmp_path / 'one.mcap', messages, **options)
    assert list(read_messages(path)) == messages


@pytest.mark.parametrize(
    'options',
    [
        {'index_types': IndexType.NONE},
        {'repeat_channels': False, 'repeat_schemas': False},
        {'use_statistics': False},
        {
            'index_types': IndexType.NONE,
            'repeat_channels': False,
            'repeat_schemas': False,
            'use_statistics': False,
            'use_summary_offsets': False,
        },
        {'enable_crcs': False},
        {'enable_data_crcs': True},
    ],
)
def test_mcap_with_less_in_its_summary(tmp_path, messages, options):
    path = write_mcap(tmp_path / 'one.mcap', messages, **options)
    reader = read_messages(path)
    assert list(reader) == messages
    assert reader.warnings == []
    assert set(reader.topics) == {message.topic for message in messages}
    assert len(list(open_recording(path))) == 10


def split(folder, messages, name):
    """A bag folder of two files, with one metadata.yaml, as `ros2 bag record` splits it."""
    folder.mkdir()
    for number, part in enumerate((messages[:17], messages[17:])):
        write_mcap(folder / name.format(number), part)
    metadata = {
        'version': 5,
        'storage_identifier': 'mcap',
        'relative_file_paths': [name.format(number) for number in range(2)],
        'message_count': len(messages),
        'topics_with_message_count': [],
    }
    document = {'rosbag2_bagfile_information': metadata}
    (folder / 'metadata.yaml').write_text(yaml.safe_dump(document))
    return folder


@pytest.mark.parametrize('with_metadata', [True, False])
def test_split_bags(tmp_path, messages, with_metadata):
    folder = split(tmp_path / 'bag', messages, 'bag_{}.mcap')
    if not with_metadata:
        (folder / 'metadata.yaml').unlink()
    reader = read_messages(folder)
    assert list(reader) == messages
    assert reader.topics['/depth/image'].count == 10
    assert reader.warnings == []
    assert len(list(open_recording(folder))) == 10


def test_split_bags_are_read_in_the_order_of_their_numbers(tmp_path, messages):
    folder = tmp_path / 'bag'
    folder.mkdir()
    for number in range(12):
        write_mcap(folder / f'run2_{number}.mcap', messages[3 * number : 3 * number + 3])
    assert list(read_messages(folder)) == messages[:36]


def test_missing_part_of_a_split_bag_is_a_warning(tmp_path, messages):
    folder = split(tmp_path / 'bag', messages, 'bag_{}.mcap')
    (folder / 'bag_0.mcap').unlink()
    reader = read_messages(folder)
    assert list(reader) == messages[17:]
    assert 'bag_0.mcap' in reader.warnings[0]
    (folder / 'bag_0.mcap').write_bytes(b'')
    assert 'the file is empty; it was left out' in read_messages(folder).warnings[0]


def test_old_metadata_name_the_folder_too(tmp_path, messages):
    folder = split(tmp_path / 'bag', messages, 'bag_{}.mcap')
    path = folder / 'metadata.yaml'
    path.write_text(path.read_text().replace('- bag_', '- bag/bag_'))
    assert list(read_messages(folder)) == messages


def test_damaged_metadata_are_done_without(tmp_path, messages):
    folder = split(tmp_path / 'bag', messages, 'bag_{}.mcap')
    for text in ('{', 'a: [', '- 1', '', 'rosbag2_bagfile_information: 7', '2000-99-99'):
        (folder / 'metadata.yaml').write_text(text)
        reader = read_messages(folder)
        assert list(reader) == messages
        assert 'metadata.yaml is damaged' in reader.warnings[0]


FLOW = ['&a0 [z, z]', *(f'&a{n} [*a{n - 1}, *a{n - 1}]' for n in range(1, 30))]
BOMB = f'[{", ".join(FLOW)}]'
"""A list that would be written with 2^30 letters."""

BEGIN = 'rosbag2_bagfile_information:\n  '


@pytest.mark.parametrize(
    'text',
    [
        BEGIN + 'relative_file_paths: ' + BOMB,
        BEGIN + 'relative_file_paths: [bag_0.mcap]\n  topics_with_message_count: ' + BOMB,
        BEGIN + 'relative_file_paths: [bag_0.mcap, 1]',
        BEGIN + 'relative_file_paths: [bag_0.mcap]\n  version: ' + '1:' * 500_000 + '1',
        BEGIN + 'relative_file_paths: [bag_0.mcap]\n  version: ' + '1' * 5000,
        BEGIN + 'relative_file_paths: ["\\ud800"]',
        '[' * 1_000_000,
        '#' * 2_000_000,
    ],
)
def test_metadata_of_a_stranger_are_done_without(tmp_path, messages, text):
    folder = split(tmp_path / 'bag', messages, 'bag_{}.mcap')
    (folder / 'metadata.yaml').write_text(text)
    reader = read_messages(folder)
    assert list(reader) == messages
    assert 'metadata.yaml is damaged' in reader.warnings[0]
    assert len(reader.warnings[0]) < 500
    lone = read_messages(folder / 'bag_0.mcap')
    assert list(lone) == messages[:17]


@pytest.mark.parametrize(
    'entry',
    [
        '1',
        '{topic_metadata: 1}',
        '{topic_metadata: {name: [/mask], type: a/msg/B}}',
        '{topic_metadata: {name: /mask, type: {a: 1}}}',
    ],
)
def test_topics_of_a_stranger_are_done_without(tmp_path, messages, entry):
    folder = split(tmp_path / 'bag', messages, 'bag_{}.mcap')
    (folder / 'metadata.yaml').write_text(
        f'{BEGIN}relative_file_paths: [bag_0.mcap, bag_1.mcap]\n'
        f'  topics_with_message_count: [{entry}]'
    )
    reader = read_messages(folder)
    assert list(reader) == messages
    assert 'does not list the topics' in reader.warnings[0]
    assert set(reader.topics) == {message.topic for message in messages}


def test_names_that_no_file_can_have_are_left_out(tmp_path, messages):
    folder = split(tmp_path / 'bag', messages, 'bag_{}.mcap')
    (folder / 'metadata.yaml').write_text(
        f'{BEGIN}relative_file_paths: [{"x" * 300}.mcap, "a\\0b", bag_0.mcap, bag_1.mcap]\n'
    )
    assert list(read_messages(folder)) == messages


@pytest.mark.skipif(not hasattr(os, 'mkfifo'), reason='this system has no such pipes')
@pytest.mark.parametrize('name', ['metadata.yaml', 'a.mcap', 'b_0.db3'])
def test_pipes_in_a_folder_are_not_opened(tmp_path, messages, name):
    folder = split(tmp_path / 'bag', messages, 'bag_{}.mcap')
    (folder / name).unlink(missing_ok=True)
    os.mkfifo(folder / name)
    assert list(read_messages(folder)) == messages
    with pytest.raises(InputError, match='is no file'):
        read_messages(folder / name)


def test_file_that_is_listed_twice_is_read_once(tmp_path, messages):
    folder = split(tmp_path / 'bag', messages, 'bag_{}.mcap')
    names = '[bag_0.mcap, bag/bag_0.mcap, bag_1.mcap, bag_0.mcap]'
    (folder / 'metadata.yaml').write_text(f'{BEGIN}relative_file_paths: {names}')
    assert list(read_messages(folder)) == messages


def test_many_missing_files_have_few_warnings(tmp_path, messages):
    folder = split(tmp_path / 'bag', messages, 'bag_{}.mcap')
    names = ', '.join(f'gone_{number}.mcap' for number in range(1000))
    (folder / 'metadata.yaml').write_text(
        f'{BEGIN}relative_file_paths: [bag_0.mcap, bag_1.mcap, {names}]'
    )
    reader = read_messages(folder)
    assert list(reader) == messages
    assert '995 more files were left out' in reader.warnings
    assert len(reader.warnings) < 10
    for path in folder.glob('*.mcap'):
        path.unlink()
    with pytest.raises(InputError, match='no recording in this folder') as caught:
        read_messages(folder)
    assert len(str(caught.value)) < 2000


def test_quality_of_service_is_given(tmp_path, labelled_recording, messages):
    lone = read_messages(labelled_recording).topics['/mask']
    assert yaml.safe_load(lone.qos)[0]['reliability'] == 'reliable'
    with RecordingWriter(tmp_path / 'bag') as writer:
        for message in messages:
            writer.write(message.topic, message.type_name, message.log_time, message.data)
    assert yaml.safe_load(read_messages(tmp_path / 'bag').topics['/mask'].qos) == yaml.safe_load(
        lone.qos
    )


def test_sqlite_of_the_first_versions(tmp_path, messages):
    """Without QoS, without metadata, without indexes, and with a name that is awkward in a URI."""
    path = tmp_path / 'a?b #1%.db3'
    with sqlite3.connect(tmp_path / 'plain.db3') as database:
        database.execute('CREATE TABLE topics(id INTEGER, name, type, serialization_format)')
        database.execute(
            'CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data)'
        )
        topics = {}
        for message in messages:
            if message.topic not in topics:
                topics[message.topic] = len(topics)
                row = (topics[message.topic], message.topic, message.type_name, 'cdr')
                database.execute('INSERT INTO topics VALUES(?, ?, ?, ?)', row)
            data = (topics[message.topic], message.log_time, message.data)
            database.execute('INSERT INTO messages(topic_id, timestamp, data) VALUES(?,?,?)', data)
    database.close()
    (tmp_path / 'plain.db3').rename(path)
    reader = read_messages(path)
    assert list(reader) == messages
    assert reader.topics['/mask'].count == 10
    assert reader.topics['/mask'].qos == ''


def test_sqlite_with_a_journal_that_was_not_taken_in(tmp_path, messages):
    """A recorder that is killed leaves messages in the write-ahead log."""
    source = write_bag(tmp_path / 'bag', messages, SQLITE, NONE) / 'bag.db3'
    database = sqlite3.connect(source)
    database.execute('PRAGMA journal_mode=WAL')
    database.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(1, 5, X'00010000')")
    database.commit()
    for suffix in ('', '-wal', '-shm'):
        shutil.copy(f'{source}{suffix}', tmp_path / f'killed.db3{suffix}')
    database.close()
    assert len(list(read_messages(tmp_path / 'killed.db3'))) == len(messages) + 1


def test_message_compression_is_seen_without_metadata(tmp_path, messages):
    """zstd frames that do not tell their size are decompressed as well."""
    packer = zstandard.ZstdCompressor(write_content_size=False)
    packed = [message._replace(data=packer.compress(message.data)) for message in messages]
    path = write_mcap(tmp_path / 'one.mcap', packed)
    assert list(read_messages(path)) == messages


def test_other_serialisations_are_left_out_with_a_warning(tmp_path, messages):
    path = tmp_path / 'one.mcap'
    with path.open('wb') as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema('foxglove.RawImage', 'protobuf', b'')
        number = writer.register_channel('/depth/image', 'protobuf', schema)
        writer.add_message(number, 1, messages[0].data, 1)
        writer.finish()
    reader = read_messages(path)
    assert list(reader) == []
    assert reader.topics == {}
    assert 'the topic /depth/image was left out: its encoding is protobuf' in reader.warnings[0]
    with pytest.raises(InputError, match='its encoding is protobuf'):
        open_recording(path)


@pytest.mark.parametrize(
    ('name', 'contents', 'words'),
    [
        ('empty.mcap', b'', 'the file is empty'),
        ('text.mcap', b'hello, this is not a recording', 'neither MCAP nor SQLite'),
        ('short.mcap', b'\x89MC', 'neither MCAP nor SQLite'),
        ('old.bag', b'#ROSBAG V2.0\n', 'bag of ROS 1'),
        ('cut.mcap.zstd', b'\x28\xb5\x2f\xfd', 'the file is empty'),
        ('bad.mcap.zstd', b'\x28\xb5\x2f\xfd' + b'\xff' * 50, 'cannot be read'),
        ('packed.zstd', zstandard.compress(b'hello, this is no recording'), 'neither MCAP'),
    ],
)
def test_files_that_are_no_recording(tmp_path, name, contents, words):
    (tmp_path / name).write_bytes(contents)
    with pytest.raises(InputError, match=words) as caught:
        read_messages(tmp_path / name)
    assert name in str(caught.value)


def test_missing_files_and_empty_folders(tmp_path):
    with pytest.raises(InputError, match=r'gone\.mcap: no such file or folder'):
        read_messages(tmp_path / 'gone.mcap')
    with pytest.raises(InputError, match='no recording in this folder'):
        read_messages(tmp_path)
    (tmp_path / 'bag_0.mcap').write_bytes(b'')
    with pytest.raises(InputError, match='the file is empty'):
        read_messages(tmp_path)


@pytest.mark.parametrize('name', ['none', 'fastwrite', 'filezstd'])
def test_real_bags_are_read_whole(shared, name):
    reader = read_messages(shared / 'bags' / f'd160_{name}')
    assert sum(1 for _ in reader) == 259
    assert reader.warnings == []
    assert reader.statistics.counts == {
        '/camera/depth/image_rect_raw': 60,
        '/camera/depth/camera_info': 60,
        '/camera/mask': 60,
        '/markers': 60,
        '/points': 6,
        '/rosout': 12,
        '/tf_static': 1,
    }
    declared = {name: topic.count for name, topic in reader.topics.items() if topic.count}
    assert declared == reader.statistics.counts
    assert 'transient_local' in reader.topics['/tf_static'].qos
    frames = open_recording(shared / 'bags' / f'd160_{name}')
    assert frames.count == 60
    assert sum(1 for _ in frames) == 60
    assert frames.warnings == []


@pytest.mark.parametrize('name', ['none', 'fastwrite', 'filezstd'])
def test_file_of_a_real_bag_alone(shared, name):
    (path,) = Path(shared / 'bags' / f'd160_{name}').glob('*.mcap*')
    frames = open_recording(path)
    assert frames.count == 60
    assert sum(1 for _ in frames) == 60


def test_killed_recording_is_read_up_to_the_damage(shared):
    frames = open_recording(shared / 'bags' / 'd160_killed')
    assert frames.count == 153
    assert sum(1 for _ in frames) == 152
    counts = frames.statistics.counts
    assert counts['/camera/depth/image_rect_raw'] == 153
    assert counts['/camera/depth/camera_info'] == counts['/camera/mask'] == 152
    damaged, unpaired = frames.warnings
    assert damaged == (
        'd160_killed_0.mcap: damaged (the file is cut off); '
        'read up to there: 638 messages, 8.9 MB, 9.8 s'
    )
    assert unpaired.startswith('1 of /camera/depth/image_rect_raw were left out')
    assert sum(1 for _ in frames) == 152
    assert len(frames.warnings) == 2


@pytest.mark.parametrize(('name', 'count'), [('front_val', 500), ('tof_val', 317)])
def test_synthetic_recordings_are_labelled(shared, name, count):
    frames = open_recording(shared / 'synthetic' / f'{name}.mcap')
    assert frames.count == count
    joints = [frame.ground_truth.joints.tolist() for frame in frames]
    assert joints == [list(range(20))] * count
