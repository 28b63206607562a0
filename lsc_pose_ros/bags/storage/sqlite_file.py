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

"""Reads one SQLite file of rosbag2 (.db3) of any schema version."""

import shutil
import sqlite3
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any

from lsc_pose_ros.bags.storage.damage import DAMAGE, reason
from lsc_pose_ros.bags.storage.layout import Part, open_part
from lsc_pose_ros.bags.storage.serialized_messages import (
    ReadStatistics,
    SerializedMessage,
    TopicSummary,
)
from lsc_pose_ros.errors import InputError

_SERIALIZATION = 'cdr'


class SqlitePart:
    """One SQLite file."""

    def __init__(self, part: Part) -> None:
        """Store the file; `topics` and `messages` open it."""
        self._part = part

    def topics(self) -> dict[str, TopicSummary]:
        """Return the topics.

        Raises:
            InputError: its tables cannot be read.
        """
        try:
            with self._database() as database:
                rows = _topic_rows(database)
                counts = _counts(database)
        except DAMAGE as error:
            msg = f'{self._part.path}: its list of topics cannot be read ({reason(error)})'
            raise InputError(msg) from error
        return {
            name: TopicSummary(type_name, None if counts is None else counts.get(number, 0), qos)
            for number, (name, type_name, qos) in rows.items()
        }

    def messages(self, warnings: list[str]) -> Iterator[SerializedMessage]:
        """Yield the messages in the order of the file, up to the first damage.

        Args:
            warnings: a sentence for each problem is appended.
        """
        statistics = ReadStatistics()
        unusable = 0
        for message in self._rows(warnings, statistics):
            if message is None:
                unusable += 1
            else:
                statistics.add(message)
                yield message
        if unusable:
            name = self._part.path.name
            warnings.append(f'{name}: {unusable} damaged messages were left out')

    def _rows(
        self, warnings: list[str], statistics: ReadStatistics
    ) -> Iterator[SerializedMessage | None]:
        """Yield the messages of the table, None for a damaged one."""
        try:
            with self._database() as database:
                topics = _topic_rows(database)
                # In the order of recording: the order of time needs an index, which a killed
                # recorder has not written, or memory for all messages.
                for row in database.execute(
                    'SELECT topic_id, timestamp, data FROM messages ORDER BY id'
                ):
                    yield _message(row, topics)
        except DAMAGE as error:
            warnings.append(
                f'{self._part.path.name}: damaged ({reason(error)}); '
                f'read up to there: {statistics}'
            )

    @contextmanager
    def _database(self) -> Iterator[sqlite3.Connection]:
        with self._plain_file() as path:
            # A killed recorder leaves a journal, which SQLite must read.
            journal = path.with_name(f'{path.name}-wal')
            mode = 'mode=ro' if journal.exists() else 'immutable=1'
            with closing(
                sqlite3.connect(f'{path.absolute().as_uri()}?{mode}', uri=True)
            ) as opened:
                yield opened

    @contextmanager
    def _plain_file(self) -> Iterator[Path]:
        """Return the file, or a decompressed copy of a compressed file."""
        if not self._part.compressed:
            yield self._part.path
            return
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / 'recording.db3'
            # The data before a damage can be used.
            with (
                suppress(*DAMAGE),
                open_part(self._part.path, compressed=True) as source,
                path.open('wb') as target,
            ):
                shutil.copyfileobj(source, target)
            yield path


def _topic_rows(database: sqlite3.Connection) -> dict[int, tuple[str, str, str]]:
    """Return name, type and QoS of each topic with CDR messages, by its number."""
    columns = {str(row[1]) for row in database.execute('PRAGMA table_info(topics)')}
    qos = 'offered_qos_profiles' if 'offered_qos_profiles' in columns else "''"
    rows = database.execute(
        f'SELECT id, name, type, {qos} FROM topics WHERE serialization_format = ?',  # noqa: S608
        (_SERIALIZATION,),
    )
    return {int(row[0]): (str(row[1]), str(row[2]), str(row[3])) for row in rows}


def _counts(database: sqlite3.Connection) -> dict[int, int] | None:
    try:
        rows = database.execute('SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id')
        return {int(number): int(count) for number, count in rows}
    except DAMAGE:
        return None


def _message(
    row: tuple[Any, Any, Any], topics: dict[int, tuple[str, str, str]]
) -> SerializedMessage | None:
    number, log_time, data = row
    if number not in topics or not isinstance(log_time, int) or not isinstance(data, bytes):
        return None
    name, type_name, _ = topics[number]
    return SerializedMessage(name, type_name, log_time, data)
