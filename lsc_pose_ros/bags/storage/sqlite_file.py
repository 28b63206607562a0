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

import sqlite3
from collections.abc import Container, Iterator
from contextlib import closing, contextmanager, suppress
from functools import cached_property
from pathlib import Path
from typing import Any

from lsc_pose_ros.bags.storage.damage import DAMAGE, reason
from lsc_pose_ros.bags.storage.layout import Part, plain_copy
from lsc_pose_ros.bags.storage.serialized_messages import (
    ReadStatistics,
    SerializedMessage,
    TopicSummary,
)
from lsc_pose_ros.errors import InputError

_SERIALIZATION = 'cdr'

_ROWS = 'SELECT topic_id, timestamp, data FROM messages'
_BY_NUMBER = f'{_ROWS} WHERE id = ?'
_NUMBERS_BY_TIME = 'SELECT id FROM messages ORDER BY timestamp, id'


class SqlitePart:
    """One SQLite file."""

    def __init__(self, part: Part) -> None:
        """Store the file; `topics` and `messages` open it."""
        self._part = part

    @cached_property
    def span(self) -> tuple[int, int] | None:
        """The earliest and the latest log time, nanoseconds; None without messages."""
        try:
            with self._database() as database:
                times = database.execute('SELECT MIN(timestamp), MAX(timestamp) FROM messages')
                start, end = times.fetchone()
        except DAMAGE:
            return None
        return (start, end) if isinstance(start, int) and isinstance(end, int) else None

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

    def select(self, topics: Container[str]) -> Iterator[SerializedMessage]:
        """Yield the messages of some topics in the order of log time."""
        with suppress(*DAMAGE), self._database() as database:
            rows = _topic_rows(database)
            for number in (each for each, row in rows.items() if row[0] in topics):
                for row in database.execute(f'{_ROWS} WHERE topic_id = ? ORDER BY id', (number,)):
                    message = _message(row, rows)
                    if message is not None:
                        yield message

    def messages(self, warnings: list[str]) -> Iterator[SerializedMessage]:
        """Yield the messages in the order of log time, up to the first damage.

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
                for row in _rows_in_order(database):
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
        with plain_copy(self._part, 'recording.db3') as path:
            yield path


def _rows_in_order(database: sqlite3.Connection) -> Iterator[tuple[Any, Any, Any]]:
    """Yield topic, time and data of all messages in the order of time.

    A recorder numbers the messages nearly in that order, and reading by number needs no memory and
    no index, which a killed recorder has not written.
    """
    if not _numbers_follow_time(database):
        numbers = [row[0] for row in database.execute(_NUMBERS_BY_TIME)]
        for number in numbers:
            yield database.execute(_BY_NUMBER, (number,)).fetchone()
        return
    yield from database.execute(f'{_ROWS} ORDER BY id')


def _numbers_follow_time(database: sqlite3.Connection) -> bool:
    before = None
    try:
        for (time,) in database.execute('SELECT timestamp FROM messages ORDER BY id'):
            if not isinstance(time, int):
                continue
            if before is not None and time < before:
                return False
            before = time
    except DAMAGE:
        return True  # what can be read is read by number
    return True


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
