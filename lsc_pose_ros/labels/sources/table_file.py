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

"""Rows of joints in CSV files."""

import csv
from collections.abc import Iterator, Sequence
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import NamedTuple, NoReturn

from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.tracks import JointSample
from lsc_pose_ros.labels.vocabulary import OWN, Vocabulary

# Larger stamps are nanoseconds: as seconds, it would be the year 5138.
_MOST_SECONDS = 100_000_000_000
_SECOND = 1_000_000_000

_LARGEST_BODY = 65535


class TableRow(NamedTuple):
    """One row of a CSV file of joints.

    Attributes:
        stamp: nanoseconds; None if the row has a frame instead.
        frame: the number of the depth image, from 0; None if the row has a stamp instead.
        body: the number of the body.
        joint: an index into the names of the vocabulary.
        values: the other columns, NaN if empty.
    """

    stamp: int | None
    frame: int | None
    body: int
    joint: int
    values: tuple[float, ...]


class TableFormat(NamedTuple):
    """How a CSV file of joints is read.

    Attributes:
        vocabulary: the names or numbers of its joints.
        columns: the names of the columns with numbers.
        optional: the names of columns that may be missing; they are then NaN.
        start: the stamp that the column `time` is relative to, nanoseconds.
    """

    vocabulary: Vocabulary
    columns: tuple[str, ...]
    optional: tuple[str, ...]
    start: int


def read_table(path: Path, form: TableFormat) -> Iterator[TableRow]:
    """Yield the rows of a CSV file whose first line names the columns.

    A row has a `stamp` (seconds since 1970, or nanoseconds), a `time` (seconds since the first
    depth image) or a `frame`; a `joint`; the columns of `form`; and optionally a `body`, else 1.

    Raises:
        InputError: the file cannot be read, or a row is not valid; the message names the line.
    """
    try:
        with path.open(encoding='utf-8-sig', newline='') as stream:
            reader = csv.DictReader(stream, skipinitialspace=True)
            names = reader.fieldnames or []
            _check_columns(path, names, form)
            for row in reader:
                yield _RowReader(path, reader.line_num, row, form).read()
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        msg = f'cannot read {path}: {error}'
        raise InputError(msg) from error


def csv_samples(
    path: Path, vocabulary: Vocabulary, frame_id: str, scale: float, start: int
) -> Iterator[JointSample]:
    """Yield the joints of a CSV file with the columns stamp or time, body, joint, x, y, z.

    Args:
        path: the file.
        vocabulary: the names or numbers of its joints.
        frame_id: the frame of the positions.
        scale: metres per unit of the file.
        start: the stamp that the column `time` is relative to, nanoseconds.

    Raises:
        InputError: the file cannot be read, or a row is not valid.
    """
    for row in read_table(path, TableFormat(vocabulary, ('x', 'y', 'z'), (), start)):
        if row.stamp is None:
            msg = f'{path}: give the column stamp or time; frame is for keypoints in images'
            raise InputError(msg)
        position = tuple(scale * value for value in row.values)
        yield JointSample(row.stamp, frame_id, row.body, row.joint, position)


def _check_columns(path: Path, names: Sequence[str], form: TableFormat) -> None:
    missing = [name for name in ('joint', *form.columns) if name not in names]
    if not {'stamp', 'time', 'frame'} & set(names):
        missing = ['stamp', *missing]
    if missing:
        msg = (
            f'{path} has no column {", ".join(missing)}; its first line must name the columns: '
            f'stamp, body, joint, {", ".join(form.columns)}'
        )
        raise InputError(msg)


class _RowReader:
    """Reads one row."""

    def __init__(
        self, path: Path, line: int, row: dict[str, str | None], form: TableFormat
    ) -> None:
        self._where = f'{path}, line {line}'
        self._row = {name: (value or '').strip() for name, value in row.items() if name}
        self._form = form

    def read(self) -> TableRow:
        stamp, frame = self._moment()
        body = self._number('body', '1')
        if not 0 <= body <= _LARGEST_BODY or body != int(body):
            self._fail(f'the body {body:g} is not a number from 0 to {_LARGEST_BODY}')
        joint = self._form.vocabulary.number_of(self._row['joint'])
        if joint is None:
            self._fail(self._unknown_joint(self._row['joint']))
        columns = (*self._form.columns, *self._form.optional)
        values = tuple(self._number(name, 'nan') for name in columns)
        return TableRow(stamp, frame, int(body), joint, values)

    def _unknown_joint(self, word: str) -> str:
        vocabulary = self._form.vocabulary
        if word in JOINT_NAMES:
            known = f'it is one of our own names: take --joints {OWN}'
        else:
            known = (
                f'--joints names the vocabulary, whose joints are {", ".join(vocabulary.names)}'
            )
        return f'the vocabulary {vocabulary.path.stem} has no joint {word!r:.40}; {known}'

    def _moment(self) -> tuple[int | None, int | None]:
        if self._row.get('stamp'):
            seconds = self._decimal('stamp')
            return int(seconds if abs(seconds) > _MOST_SECONDS else seconds * _SECOND), None
        if self._row.get('time'):
            return self._form.start + int(self._decimal('time') * _SECOND), None
        if not self._row.get('frame'):
            self._fail('the row has no stamp')
        return None, int(self._decimal('frame'))

    def _decimal(self, name: str) -> Decimal:
        try:
            value = Decimal(self._row[name])
        except InvalidOperation:
            value = Decimal('nan')
        if not value.is_finite():
            self._fail(f'{self._row[name]!r:.40} in the column {name} is not a number')
        return value

    def _number(self, name: str, default: str) -> float:
        try:
            return float(self._row.get(name) or default)
        except ValueError:
            self._fail(f'{self._row[name]!r:.40} in the column {name} is not a number')

    def _fail(self, why: str) -> NoReturn:
        msg = f'{self._where}: {why}'
        raise InputError(msg)
