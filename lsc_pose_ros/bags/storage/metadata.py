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

"""Formats metadata.yaml (version 9) and QoS profiles as rosbag2 reads them."""

from typing import NamedTuple

import yaml

# 'No limit', as rosbag2 writes a duration.
_FOREVER = {'sec': 9223372036, 'nsec': 854775807}
_NO_TIME = 9223372036854775807

VERSION = 9
DISTRO = 'jazzy'


class WrittenTopic(NamedTuple):
    """A topic of a written recording, with its number of messages."""

    name: str
    type_name: str
    type_hash: str
    messages: int


class RecordingContents(NamedTuple):
    """The contents of a recording of one file; times in nanoseconds, None without messages."""

    file_name: str
    topics: list[WrittenTopic]
    start: int | None
    end: int | None


def qos_profile() -> dict[str, object]:
    """Return the QoS profile of every topic: reliable, depth 10, volatile."""
    return {
        'history': 'keep_last',
        'depth': 10,
        'reliability': 'reliable',
        'durability': 'volatile',
        'deadline': dict(_FOREVER),
        'lifespan': dict(_FOREVER),
        'liveliness': 'automatic',
        'liveliness_lease_duration': dict(_FOREVER),
        'avoid_ros_namespace_conventions': False,
    }


def qos_text() -> str:
    """Return the QoS profiles of a channel, as YAML text of rosbag2."""
    return _dump([qos_profile()])


def metadata_text(written: RecordingContents) -> str:
    """Return the record 'serialized_metadata' of an MCAP file's metadata 'rosbag2'."""
    return _dump(_information(written))


def metadata_yaml(written: RecordingContents) -> str:
    """Return the contents of a bag folder's metadata.yaml."""
    return _dump({'rosbag2_bagfile_information': _information(written)}) + '\n'


def _information(written: RecordingContents) -> dict[str, object]:
    start = _NO_TIME if written.start is None else written.start
    duration = 0 if written.start is None or written.end is None else written.end - written.start
    count = sum(topic.messages for topic in written.topics)
    times = {
        'duration': {'nanoseconds': duration},
        'starting_time': {'nanoseconds_since_epoch': start},
        'message_count': count,
    }
    return {
        'version': VERSION,
        'storage_identifier': 'mcap',
        **times,
        'topics_with_message_count': [_topic(topic) for topic in written.topics],
        'compression_format': '',
        'compression_mode': '',
        'relative_file_paths': [written.file_name],
        'files': [{'path': written.file_name, **times}],
        'custom_data': None,
        'ros_distro': DISTRO,
    }


def _topic(topic: WrittenTopic) -> dict[str, object]:
    return {
        'topic_metadata': {
            'name': topic.name,
            'type': topic.type_name,
            'serialization_format': 'cdr',
            'offered_qos_profiles': [qos_profile()],
            'type_description_hash': topic.type_hash,
        },
        'message_count': topic.messages,
    }


class _Dumper(yaml.SafeDumper):
    """Writes no YAML aliases, so that any YAML reader can read the text."""

    def ignore_aliases(self, data: object) -> bool:
        """Return True for any `data`."""
        return data is not self


def _dump(data: object) -> str:
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False, width=1000).strip()
