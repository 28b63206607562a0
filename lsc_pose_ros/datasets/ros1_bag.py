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

"""Imports bags of ROS 1: their messages become those of ROS 2."""

from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from rosbags.convert.converter import STATIC_MSGTYPE_RENAMES, migrate_message
from rosbags.highlevel import AnyReader, AnyReaderError

from lsc_pose_ros.bags.serialization.type_store import typestore
from lsc_pose_ros.bags.storage.serialized_messages import SerializedMessage
from lsc_pose_ros.errors import InputError


class Ros1Bag:
    """The messages of a bag of ROS 1.

    Attributes:
        left_out: how many messages were left out so far, by their type.
    """

    def __init__(self, path: Path) -> None:
        """Use the file `path`; nothing is read yet."""
        self._path = path
        self.left_out: Counter[str] = Counter()

    def __iter__(self) -> Iterator[SerializedMessage]:
        """Yield the messages in the order of time, as messages of ROS 2.

        Messages of types that ROS 2 Jazzy does not have are left out.

        Raises:
            InputError: the file is no bag of ROS 1, or damaged.
        """
        self.left_out.clear()
        try:
            with AnyReader([self._path]) as reader:
                if reader.is2:
                    msg = f'{self._path} is a bag of ROS 2, which needs no import'
                    raise InputError(msg)
                yield from self._messages(reader)
        except (AnyReaderError, OSError) as error:
            msg = f'{self._path} cannot be read as a bag of ROS 1: {error}'
            raise InputError(msg) from error

    def _messages(self, reader: AnyReader) -> Iterator[SerializedMessage]:
        store, cache = typestore(), dict[str, object]()
        for connection, log_time, data in reader.messages():
            source = connection.msgtype
            target = STATIC_MSGTYPE_RENAMES.get(source, source)
            message: Any = None
            if target in store.types:
                with suppress(KeyError, AttributeError):  # of another definition
                    message = migrate_message(
                        reader.typestore,
                        store,
                        source,
                        target,
                        cache,
                        reader.deserialize(data, source),
                    )
            if message is None:
                self.left_out[source] += 1
                continue
            serialized = bytes(store.serialize_cdr(message, target))
            yield SerializedMessage(connection.topic, target, log_time, serialized)
