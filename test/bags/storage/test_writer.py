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

"""Written recordings, read back by this package, by rosbags and by mcap, and real bags."""

import os
import resource
import signal
import subprocess
import sys
import threading
from importlib.metadata import version

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap.records import Channel, Chunk, DataEnd, Header, Metadata, Schema, Statistics
from mcap.stream_reader import StreamReader
from rosbags.highlevel import AnyReader

from lsc_pose_ros.bags import (
    DEFAULT_TOPICS,
    RecordingWriter,
    Topics,
    open_recording,
    read_messages,
)
from lsc_pose_ros.bags.storage.metadata import RecordingContents, metadata_yaml
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.markers import skeleton_markers
from lsc_pose_ros.settings.table import FrameSettings

OLD_ROSBAGS = pytest.mark.skipif(
    version('rosbags').startswith('0.10.'), reason='this rosbags opens no file outside of a folder'
)
EDGES = np.array([[0, 1], [1, 2]], np.int32)


def write_all(path, frames):
    with RecordingWriter(path) as writer:
        for frame in frames:
            writer.write_frame(frame)
            stamp, frame_id, ground_truth = frame.stamp, frame.frame_id, frame.ground_truth
            writer.write_skeletons('/pose_node/skeletons', stamp, frame_id, ground_truth)
            markers = skeleton_markers(ground_truth, EDGES)
            writer.write_markers('/pose_node/joint_markers', stamp, frame_id, markers)


def write_half(path, frame):
    """Fail in the midst of writing."""
    with RecordingWriter(path) as writer:
        writer.write_frame(frame)
        raise ZeroDivisionError


def assert_same(frame, other):
    assert (frame.stamp, frame.frame_id, frame.camera) == (
        other.stamp,
        other.frame_id,
        other.camera,
    )
    np.testing.assert_allclose(frame.depth, other.depth, atol=0.0005)
    np.testing.assert_array_equal(frame.labels, other.labels)
    assert frame.depth.dtype == np.float32
    assert frame.labels.dtype == np.int32
    for mine, theirs in zip(frame.ground_truth, other.ground_truth, strict=True):
        np.testing.assert_array_equal(mine, theirs)


@pytest.mark.parametrize('name', ['one.mcap', 'bag'])
def test_frames_come_back(tmp_path, simple_frames, name):
    write_all(tmp_path / name, simple_frames)
    reader = open_recording(tmp_path / name)
    assert reader.topics == DEFAULT_TOPICS
    assert reader.count == len(simple_frames)
    for _ in range(2):  # each iteration starts anew
        for frame, other in zip(reader, simple_frames, strict=True):
            assert_same(frame, other)
    assert reader.warnings == []


@pytest.mark.parametrize('name', [pytest.param('one.mcap', marks=OLD_ROSBAGS), 'bag'])
def test_rosbags_reads_it(tmp_path, simple_frames, name):
    write_all(tmp_path / name, simple_frames)
    with AnyReader([tmp_path / name]) as reader:
        types = {connection.topic: connection.msgtype for connection in reader.connections}
        counts = dict.fromkeys(types, 0)
        for connection, stamp, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            counts[connection.topic] += 1
            if hasattr(message, 'header'):
                header = message.header
                assert header.stamp.sec * 10**9 + header.stamp.nanosec == stamp
    assert types == {
        '/depth/image': 'sensor_msgs/msg/Image',
        '/depth/camera_info': 'sensor_msgs/msg/CameraInfo',
        '/mask': 'sensor_msgs/msg/Image',
        '/ground_truth/skeletons': 'sensor_msgs/msg/PointCloud2',
        '/pose_node/skeletons': 'sensor_msgs/msg/PointCloud2',
        '/pose_node/joint_markers': 'visualization_msgs/msg/MarkerArray',
    }
    assert set(counts.values()) == {len(simple_frames)}


def test_mcap_reads_it_by_its_index_and_checksums(tmp_path, simple_frames):
    write_all(tmp_path / 'one.mcap', simple_frames)
    with (tmp_path / 'one.mcap').open('rb') as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        stamps = [message.log_time for _, _, message in reader.iter_messages('/mask')]
    assert stamps == [frame.stamp for frame in simple_frames]
    assert summary.statistics.message_count == 6 * len(simple_frames)
    assert all(index.message_index_offsets for index in summary.chunk_indexes)


def records_of(path, *kinds):
    with path.open('rb') as stream:
        records = StreamReader(stream, emit_chunks=Chunk in kinds, validate_crcs=True).records
        return [record for record in records if isinstance(record, kinds)]


def test_file_is_what_rosbag2_accepts(tmp_path, simple_frames):
    path = tmp_path / 'one.mcap'
    write_all(path, simple_frames)
    assert [record.profile for record in records_of(path, Header)] == ['ros2']
    assert {record.encoding for record in records_of(path, Schema)} == {'ros2msg'}
    chunks = records_of(path, Chunk)
    assert {chunk.compression for chunk in chunks} == {'zstd'}
    assert all(chunk.uncompressed_crc for chunk in chunks)
    assert all(record.data_section_crc for record in records_of(path, DataEnd))
    assert len(records_of(path, Statistics)) == 1
    for channel in records_of(path, Channel):
        assert channel.message_encoding == 'cdr'
        (qos,) = yaml.safe_load(channel.metadata['offered_qos_profiles'])
        assert (qos['history'], qos['depth'], qos['reliability']) == ('keep_last', 10, 'reliable')
        assert channel.metadata['topic_type_hash'].startswith('RIHS01_')


def keys_of(value):
    """The shape of a document: the keys, and of lists that of their first entry."""
    if isinstance(value, dict):
        return {key: keys_of(part) for key, part in value.items()}
    if isinstance(value, list):
        return [keys_of(part) for part in value[:1]]
    return type(value).__name__


def test_metadata_has_the_form_of_a_real_bag(shared, tmp_path, simple_frames):
    write_all(tmp_path / 'bag', simple_frames)
    real = shared / 'bags' / 'd160_none'
    mine = yaml.safe_load((tmp_path / 'bag' / 'metadata.yaml').read_text())
    theirs = yaml.safe_load((real / 'metadata.yaml').read_text())
    assert keys_of(mine) == keys_of(theirs)
    (record,) = records_of(tmp_path / 'bag' / 'bag_0.mcap', Metadata)
    real_record = records_of(real / 'd160_none_0.mcap', Metadata)[-1]
    assert record.name == real_record.name
    inside = yaml.safe_load(record.metadata['serialized_metadata'])
    assert keys_of(inside) == keys_of(yaml.safe_load(real_record.metadata['serialized_metadata']))
    assert inside == mine['rosbag2_bagfile_information']


def test_schemas_and_hashes_are_a_real_bags(shared, tmp_path, simple_frames):
    """The definitions' fields, without comments and blanks, and the fingerprints are the same."""
    write_all(tmp_path / 'one.mcap', simple_frames)
    real = shared / 'bags' / 'd160_none' / 'd160_none_0.mcap'

    def fingerprints(path):
        schemas = {record.id: record.name for record in records_of(path, Schema)}
        channels = records_of(path, Channel)
        return {schemas[c.schema_id]: c.metadata['topic_type_hash'] for c in channels}

    def fields(path):
        definitions = {}
        for record in records_of(path, Schema):
            parts = record.data.decode().split('=' * 80)
            names = [record.name, *(part.split()[1] for part in parts[1:])]
            definitions[record.name] = {
                name.replace('/msg/', '/'): [
                    line.split()[:2]
                    for line in part.splitlines()
                    if line.split('#')[0].strip()
                    and not line.startswith('MSG:')
                    and '=' not in line
                ]
                for name, part in zip(names, parts, strict=True)
            }
        return definitions

    mine, theirs = fingerprints(tmp_path / 'one.mcap'), fingerprints(real)
    common = set(mine) & set(theirs)
    assert len(common) == 4
    assert {name: mine[name] for name in common} == {name: theirs[name] for name in common}
    my_fields, their_fields = fields(tmp_path / 'one.mcap'), fields(real)
    for name in common:
        assert set(my_fields[name]) == set(their_fields[name])
        for part, lines in my_fields[name].items():
            plain = [[kind.rpartition('/')[2], field] for kind, field in lines]
            real_lines = [[k.rpartition('/')[2], f] for k, f in their_fields[name][part]]
            assert plain == real_lines


def test_same_frames_give_the_same_bytes(tmp_path, simple_frames):
    for name in ('a.mcap', 'b.mcap'):
        write_all(tmp_path / name, simple_frames)
    assert (tmp_path / 'a.mcap').read_bytes() == (tmp_path / 'b.mcap').read_bytes()


def test_frame_without_ground_truth_and_other_topics(tmp_path, simple_frames):
    path = tmp_path / 'one.mcap'
    topics = Topics('/kinect/depth/image_raw', '/kinect/depth/camera_info', '/people/mask')
    with RecordingWriter(path) as writer:
        for frame in simple_frames:
            writer.write_frame(frame._replace(ground_truth=None), topics)
    reader = open_recording(path)
    assert reader.topics == topics
    assert [frame.ground_truth for frame in reader] == [None] * len(simple_frames)


def test_another_background(tmp_path, simple_frames):
    path = tmp_path / 'one.mcap'
    labels = np.where(simple_frames[0].labels == 1, 0, simple_frames[0].labels).astype(np.int32)
    frame = simple_frames[0]._replace(labels=labels)
    with RecordingWriter(path) as writer:
        writer.write_frame(frame, mask_background=255)
    (read,) = open_recording(path, settings=FrameSettings(mask_background=255))
    np.testing.assert_array_equal(read.labels, labels)
    assert set(np.unique(read.labels)) == {NO_BODY, 0, 2}


def test_raw_messages_are_copied_byte_by_byte(tmp_path, labelled_recording):
    with RecordingWriter(tmp_path / 'copy.mcap') as writer:
        for message in read_messages(labelled_recording):
            writer.write(message.topic, message.type_name, message.log_time, message.data)
    assert list(read_messages(tmp_path / 'copy.mcap')) == list(read_messages(labelled_recording))


def test_error_writes_nothing_and_keeps_the_existing_file(tmp_path, simple_frames):
    for name in ('one.mcap', 'bag'):
        with pytest.raises(ZeroDivisionError):
            write_half(tmp_path / name, simple_frames[0])
    assert list(tmp_path.iterdir()) == []
    write_all(tmp_path / 'one.mcap', simple_frames)
    before = (tmp_path / 'one.mcap').read_bytes()
    with pytest.raises(ZeroDivisionError):
        write_half(tmp_path / 'one.mcap', simple_frames[0])
    assert (tmp_path / 'one.mcap').read_bytes() == before
    assert len(list(tmp_path.iterdir())) == 1


def test_file_is_replaced_but_a_folder_is_not(tmp_path, simple_frames):
    for _ in range(2):
        write_all(tmp_path / 'one.mcap', simple_frames)
    write_all(tmp_path / 'bag', simple_frames)
    with pytest.raises(InputError, match='exists already'):
        RecordingWriter(tmp_path / 'bag')


@pytest.mark.parametrize(
    ('name', 'words'),
    [
        ('out.bag', r'\.mcap or as a folder'),
        ('missing/out.mcap', 'does not exist'),
        ('folder.mcap', 'is a folder'),
    ],
)
def test_places_that_cannot_be_written_to(tmp_path, name, words):
    (tmp_path / 'folder.mcap').mkdir()
    with pytest.raises(InputError, match=words):
        RecordingWriter(tmp_path / name)


@pytest.mark.parametrize('name', ['one.mcap', 'bag'])
def test_full_disk(tmp_path, simple_frames, name):
    """A limit on the size of files stands for a full disk; the old recording is intact."""
    old = tmp_path / 'one.mcap'
    write_all(old, simple_frames[:2])
    content = old.read_bytes()
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.raises(InputError, match=rf'{name}\S*: cannot be written: File too large'):
            write_all(tmp_path / name, simple_frames)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list(tmp_path.iterdir()) == [old]
    assert old.read_bytes() == content


_KILLED = """
import os, signal, sys
from lsc_pose_ros.bags import RecordingWriter
with RecordingWriter(sys.argv[1]) as writer:
    for k in range(40):
        writer.write('/text', 'std_msgs/msg/String', k, b'\\0\\1\\0\\0' + os.urandom(100_000))
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_killed_writer_leaves_the_old_recording_and_what_was_written(tmp_path, simple_frames):
    path = tmp_path / 'one.mcap'
    write_all(path, simple_frames)
    before = path.read_bytes()
    killed = subprocess.run([sys.executable, '-c', _KILLED, str(path)], check=False)
    assert killed.returncode == -signal.SIGKILL
    assert path.read_bytes() == before
    (partial,) = tmp_path.glob('.one.mcap.*.part')
    # The chunks of a megabyte that were complete.
    assert len(list(read_messages(partial))) in range(30, 40)


def test_other_kind_of_file_is_not_replaced(tmp_path):
    path = tmp_path / 'one.mcap'
    path.write_bytes(b'SQLite format 3\0')
    with pytest.raises(InputError, match='is not a recording of the format MCAP'):
        RecordingWriter(path)
    assert path.read_bytes() == b'SQLite format 3\0'


def test_recording_through_a_pipe(tmp_path, simple_frames):
    path = tmp_path / 'pipe'
    os.mkfifo(path)
    copy = tmp_path / 'copy.mcap'
    reader = threading.Thread(target=lambda: copy.write_bytes(path.read_bytes()))
    reader.start()
    write_all(path, simple_frames)
    reader.join()
    write_all(tmp_path / 'one.mcap', simple_frames)
    assert copy.read_bytes() == (tmp_path / 'one.mcap').read_bytes()


def test_unknown_types_are_refused(tmp_path):
    with (
        pytest.raises(InputError, match='acme_msgs/msg/Thing'),
        RecordingWriter(tmp_path / 'one.mcap') as writer,
    ):
        writer.write('/thing', 'acme_msgs/msg/Thing', 0, b'\0\1\0\0')


def test_recording_without_messages_is_complete(tmp_path):
    for name in ('empty.mcap', 'empty'):
        with RecordingWriter(tmp_path / name):
            pass
        assert list(read_messages(tmp_path / name)) == []
        with pytest.raises(InputError, match='has no messages'):
            open_recording(tmp_path / name)
    assert '9223372036854775807' in metadata_yaml(RecordingContents('f', [], None, None))


def test_nothing_is_written_before_it_is_opened(tmp_path, simple_frames):
    with pytest.raises(RuntimeError, match='not open'):
        RecordingWriter(tmp_path / 'one.mcap').write_frame(simple_frames[0])


def test_depth_in_a_recording_is_rounded_to_millimetres(tmp_path, simple_frames):
    depth = np.full((48, 64), 1.2344, np.float32)
    frame: Frame = simple_frames[0]._replace(depth=depth)
    with RecordingWriter(tmp_path / 'one.mcap') as writer:
        writer.write_frame(frame)
    (read,) = open_recording(tmp_path / 'one.mcap')
    assert read.depth == pytest.approx(1.234)
