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

"""Reads metadata.yaml, which lists the files and topics of a bag folder."""

from pathlib import Path
from typing import NamedTuple

import yaml

from lsc_pose_ros.bags.storage.damage import reason
from lsc_pose_ros.bags.storage.serialized_messages import TopicSummary
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources.bounded_yaml import parse_yaml
from lsc_pose_ros.resources.text_files import read_text

METADATA_NAME = 'metadata.yaml'

# Linux allows 255 bytes; a suffix .zstd may be added.
_LONGEST_NAME = 250


class RecordedMetadata(NamedTuple):
    """What metadata.yaml tells.

    Attributes:
        files: the names of the files in the order of recording, without folders.
        topics: the topics by name, None if it does not tell them.
    """

    files: list[str]
    topics: dict[str, TopicSummary] | None


def read_metadata(path: Path, warnings: list[str]) -> RecordedMetadata:
    """Return what the file `path` tells; nothing, and a warning, if it is damaged."""
    nothing = RecordedMetadata([], None)
    if not path.is_file():  # a pipe in the folder would wait for somebody who writes to it
        return nothing
    try:
        information = _information(parse_yaml(read_text(path, METADATA_NAME)))
        files = _files(information.get('relative_file_paths'))
    except (InputError, ValueError) as error:
        warnings.append(f'{path} is damaged ({reason(error)}); it was ignored')
        return nothing
    try:
        topics = _topics(information.get('topics_with_message_count'))
    except ValueError as error:
        warnings.append(f'{METADATA_NAME} does not list the topics ({reason(error)})')
        topics = {}
    return RecordedMetadata(files, topics or None)


def _information(contents: object) -> dict[object, object]:
    if isinstance(contents, dict):
        information = contents.get('rosbag2_bagfile_information')
        if isinstance(information, dict):
            return information
    msg = 'it has no rosbag2_bagfile_information'
    raise ValueError(msg)


def _files(listed: object) -> list[str]:
    if not isinstance(listed, list):
        msg = 'it does not list the files'
        raise ValueError(msg)  # noqa: TRY004 - damage of the file, as all that is wrong in it
    # Old recordings contain the name of the folder.
    return [Path(_text(each, 'a file')).name for each in listed if _is_name(each)]


def _is_name(listed: object) -> bool:
    """Return whether a file can have the name; the others cannot be there."""
    text = _text(listed, 'a file')
    return '\0' not in text and len(Path(text).name.encode()) <= _LONGEST_NAME


def _topics(entries: object) -> dict[str, TopicSummary]:
    if not isinstance(entries, list):
        msg = 'it has no topics_with_message_count'
        raise ValueError(msg)  # noqa: TRY004
    return dict(map(_topic, entries))


def _topic(entry: object) -> tuple[str, TopicSummary]:
    topic = entry.get('topic_metadata') if isinstance(entry, dict) else None
    if not isinstance(entry, dict) or not isinstance(topic, dict):
        msg = 'an entry has no topic_metadata'
        raise ValueError(msg)  # noqa: TRY004
    qos = topic.get('offered_qos_profiles') or ''
    if not isinstance(qos, str):  # a list since version 9, text in a text before
        qos = yaml.safe_dump(qos, sort_keys=False)
    count = entry.get('message_count')
    summary = TopicSummary(
        _text(topic.get('type'), 'a type'), count if type(count) is int else None, qos
    )
    return _text(topic.get('name'), 'a topic'), summary


def _text(value: object, what: str) -> str:
    if not isinstance(value, str):
        msg = f'{what} has no name'
        raise ValueError(msg)  # noqa: TRY004
    return value
