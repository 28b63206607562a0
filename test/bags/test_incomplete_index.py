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

"""Summaries and metadata that tell less than the data, or something else."""

from pathlib import Path
from typing import Any

import pytest
import yaml
from mcap.writer import Writer
from test_time_order import write_sqlite

from lsc_pose_ros.bags import SerializedMessage, open_recording, read_messages

Messages = list[SerializedMessage]


@pytest.fixture(scope='session')
def messages(labelled_recording: Path) -> Messages:
    return list(read_messages(labelled_recording))


class IncompleteWriter(Writer):
    """Writes a summary from which something is missing."""

    def __init__(self, stream: Any, lacking: str) -> None:
        super().__init__(stream, chunk_size=3000)
        self._lacking = lacking

    def finish(self) -> None:
        private = vars(self)
        schemas = private['_Writer__schemas']
        channels = private['_Writer__channels']
        counts = private['_Writer__statistics'].channel_message_counts
        if self._lacking == 'schemas':
            schemas.clear()
        elif self._lacking == 'channels':
            del channels[max(channels)]
        elif self._lacking == 'counts':
            counts.clear()
        elif self._lacking == 'count':
            counts[1] = 0
        super().finish()


def write(path: Path, messages: Messages, lacking: str = '', name: Any = str) -> Path:
    with path.open('wb') as stream:
        writer = IncompleteWriter(stream, lacking)
        writer.start(profile='ros2')
        channels: dict[str, int] = {}
        for message in messages:
            if message.topic not in channels:
                type_name = name(message.type_name)
                schema = writer.register_schema(type_name, 'ros2msg', b'') if type_name else 0
                channels[message.topic] = writer.register_channel(message.topic, 'cdr', schema)
            number = channels[message.topic]
            writer.add_message(number, message.log_time, message.data, message.log_time)
        writer.finish()
    return path


def assert_whole(path: Path, messages: Messages) -> None:
    reader = read_messages(path)
    types = {message.topic: message.type_name for message in messages}
    assert {name: topic.type_name for name, topic in reader.topics.items()} == types
    assert all(topic.count in {10, None} for topic in reader.topics.values())
    assert sorted(reader) == sorted(messages)
    assert len(list(open_recording(path))) == 10


@pytest.mark.parametrize('lacking', ['', 'schemas', 'channels', 'counts', 'count'])
def test_summary_that_lacks_something(tmp_path: Path, messages: Messages, lacking: str) -> None:
    assert_whole(write(tmp_path / 'one.mcap', messages, lacking), messages)


def short(type_name: str) -> str:
    return type_name.replace('/msg/', '/')


def test_short_type_names(tmp_path: Path, messages: Messages) -> None:
    assert_whole(write(tmp_path / 'one.mcap', messages, name=short), messages)


def test_short_type_names_in_sqlite(tmp_path: Path, messages: Messages) -> None:
    import sqlite3  # noqa: PLC0415

    path = write_sqlite(tmp_path / 'bag', messages)
    database = sqlite3.connect(path / 'bag.db3')
    database.execute("UPDATE topics SET type = REPLACE(type, '/msg/', '/')")
    database.commit()
    database.close()
    (path / 'metadata.yaml').unlink()
    assert_whole(path, messages)


def metadata_of(messages: Messages, files: list[str], **changes: Any) -> str:
    types = {message.topic: message.type_name for message in messages}
    information = {
        'version': 9,
        'storage_identifier': 'mcap',
        'relative_file_paths': files,
        'topics_with_message_count': [
            {
                'topic_metadata': {
                    'name': name,
                    'type': type_name,
                    'serialization_format': 'cdr',
                    'offered_qos_profiles': '',
                },
                'message_count': 10,
            }
            for name, type_name in types.items()
        ],
        **changes,
    }
    return yaml.safe_dump({'rosbag2_bagfile_information': information})


def bag(folder: Path, messages: Messages, metadata: str, **options: Any) -> Path:
    folder.mkdir()
    write(folder / 'bag_0.mcap', messages, **options)
    (folder / 'metadata.yaml').write_text(metadata)
    return folder


def test_metadata_without_topics(tmp_path: Path, messages: Messages) -> None:
    metadata = metadata_of(messages, ['bag_0.mcap'], topics_with_message_count=[])
    assert_whole(bag(tmp_path / 'bag', messages, metadata), messages)


def test_metadata_that_lack_a_topic(tmp_path: Path, messages: Messages) -> None:
    depth_only = [each for each in messages if each.topic == '/depth/image']
    metadata = metadata_of(depth_only, ['bag_0.mcap'])
    assert_whole(bag(tmp_path / 'bag', messages, metadata), messages)


def test_metadata_with_zero_counts(tmp_path: Path, messages: Messages) -> None:
    metadata = metadata_of(messages, ['bag_0.mcap'], message_count=0)
    metadata = metadata.replace('message_count: 10', 'message_count: 0')
    assert_whole(bag(tmp_path / 'bag', messages, metadata), messages)


def test_metadata_with_old_file_names(tmp_path: Path, messages: Messages) -> None:
    metadata = metadata_of(messages, ['before_it_was_renamed_0.mcap'])
    assert_whole(bag(tmp_path / 'bag', messages, metadata), messages)


@pytest.mark.parametrize('alone', [True, False])
def test_types_that_only_the_metadata_tell(
    tmp_path: Path, messages: Messages, *, alone: bool
) -> None:
    metadata = metadata_of(messages, ['bag_0.mcap'])
    folder = bag(tmp_path / 'bag', messages, metadata, name=lambda _: '')
    assert_whole(folder / 'bag_0.mcap' if alone else folder, messages)
