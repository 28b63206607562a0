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
import math
from collections.abc import Iterator, Sequence
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import NamedTuple, NoReturn, TextIO

from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.errors import InputError, excerpt
from lsc_pose_ros.labels.limits import FARTHEST, LARGEST_BODY, LATEST
from lsc_pose_ros.labels.tracks import JointSample
from lsc_pose_ros.labels.vocabulary import OWN, Vocabulary

# Larger stamps are nanoseconds: as seconds, it would be the year 5138.
_MOST_SECONDS = 100_000_000_000
_SECOND = 1_000_000_000

_MOMENTS = ('stamp', 'time', 'frame')

# Longer and larger numbers are damage, and would take long to compute with.
_LONGEST_NUMBER = 40
_LARGEST_NUMBER = 10**20
_MOST_FRAMES = 1_000_000_000

_LONGEST_LINE = 1 << 17
"""More characters are no line of a table; a file without line ends would fill the memory."""


class TableRow(NamedTuple):
    """One row of a CSV file of joints.

    Attributes:
        where: the file and the line, for messages.
        stamp: nanoseconds; None if the row has a frame instead.
        frame: the number of the depth image, from 0; None if the row has a stamp instead.
        body: the number of the body.
        joint: an index into the names of the vocabulary.
        values: the other columns, NaN if empty.
    """

    where: str
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
        InputError: the file cannot be read, a row is not valid, or a joint is given twice; the
            message names the line.
    """
    try:
        with path.open(encoding='utf-8-sig', newline='') as stream:
            reader = csv.DictReader(_lines(path, stream), skipinitialspace=True)
            names = reader.fieldnames or []
            _check_columns(path, names, form)
            given = _GivenJoints(form.vocabulary)
            for fields in reader:
                row = _RowReader(path, reader.line_num, fields, form).read()
                given.add(row)
                yield row
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        msg = f'cannot read {path}: {excerpt(error)}'
        raise InputError(msg) from error


def _lines(path: Path, stream: TextIO) -> Iterator[str]:
    number = 0
    while line := stream.readline(_LONGEST_LINE + 1):
        number += 1
        if len(line) > _LONGEST_LINE:
            msg = f'{path}, line {number}: it has more than {_LONGEST_LINE} characters'
            raise InputError(msg)
        yield line


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
        if any(abs(value) > FARTHEST for value in position):
            x, y, z = position
            msg = (
                f'{row.where}: the joint is at ({x:g}, {y:g}, {z:g}) m; give the metres per unit '
                'with --scale'
            )
            raise InputError(msg)
        yield JointSample(row.stamp, frame_id, row.body, row.joint, position)


def _check_columns(path: Path, names: Sequence[str], form: TableFormat) -> None:
    missing = [name for name in ('joint', *form.columns) if name not in names]
    if not set(_MOMENTS) & set(names):
        missing = ['stamp', *missing]
    if missing:
        msg = (
            f'{path} has no column {", ".join(missing)}; its first line must name the columns: '
            f'stamp, body, joint, {", ".join(form.columns)}'
        )
        raise InputError(msg)
    used = {*_MOMENTS, 'body', 'joint', *form.columns, *form.optional}
    twice = sorted(name for name in used if names.count(name) > 1)
    if twice:
        msg = f'{path}: its first line names the column {twice[0]} twice; name each once'
        raise InputError(msg)


class _GivenJoints:
    """Knows which joints the rows so far gave, and refuses to take one twice."""

    def __init__(self, vocabulary: Vocabulary) -> None:
        self._names = vocabulary.names
        # The joints of a body at a moment are the bits of a number: a set would be far larger.
        self._given: dict[tuple[int | None, int | None, int], int] = {}

    def add(self, row: TableRow) -> None:
        key, bit = (row.stamp, row.frame, row.body), 1 << row.joint
        given = self._given.get(key, 0)
        if given & bit:
            msg = (
                f'{row.where}: the joint {excerpt(self._names[row.joint])} of body {row.body} was '
                'given before for the same moment; give each once'
            )
            raise InputError(msg)
        self._given[key] = given | bit


class _RowReader:
    """Reads one row."""

    def __init__(
        self, path: Path, line: int, row: dict[str, str | None], form: TableFormat
    ) -> None:
        self._where = f'{path}, line {line}'
        self._form = form
        surplus = row.pop(None, None)  # type: ignore[call-overload]
        if any(surplus or ()):
            self._fail('it has more fields than the first line names columns')
        if None in row.values():
            self._fail('it has fewer fields than the first line names columns')
        self._row = {name: (value or '').strip() for name, value in row.items()}

    def read(self) -> TableRow:
        stamp, frame = self._moment()
        body = self._number('body', '1')
        if not 0 <= body <= LARGEST_BODY or body != int(body):
            self._fail(f'the body {body:g} is not a number from 0 to {LARGEST_BODY}')
        joint = self._form.vocabulary.number_of(self._row['joint'])
        if joint is None:
            self._fail(self._unknown_joint(self._row['joint']))
        columns = (*self._form.columns, *self._form.optional)
        values = tuple(self._number(name, 'nan') for name in columns)
        return TableRow(self._where, stamp, frame, int(body), joint, values)

    def _unknown_joint(self, word: str) -> str:
        vocabulary = self._form.vocabulary
        if word in JOINT_NAMES:
            known = f'it is one of our own names: take --joints {OWN}'
        else:
            known = f'--joints names the vocabulary, whose joints are {vocabulary.listed}'
        return f'the vocabulary {vocabulary.path.stem} has no joint {word!r:.40}; {known}'

    def _moment(self) -> tuple[int | None, int | None]:
        if self._row.get('stamp'):
            value = self._decimal('stamp')
            return self._stamp('stamp', value if abs(value) > _MOST_SECONDS else value * _SECOND)
        if self._row.get('time'):
            return self._stamp('time', self._form.start + self._decimal('time') * _SECOND)
        if not self._row.get('frame'):
            self._fail('the row has no stamp')
        frame = self._decimal('frame')
        if frame != int(frame) or not 0 <= frame <= _MOST_FRAMES:
            self._fail(f'{self._row["frame"]} in the column frame is not the number of an image')
        return None, int(frame)

    def _stamp(self, name: str, value: Decimal) -> tuple[int, None]:
        if not 0 <= value <= LATEST:
            self._fail(f'{self._row[name]} in the column {name} is no time from 1970 to 2038')
        return int(value), None

    def _decimal(self, name: str) -> Decimal:
        word = self._row[name]
        try:
            value = Decimal(word) if _is_plain(word) else Decimal('nan')
        except InvalidOperation:
            value = Decimal('nan')
        if not value.is_finite() or not -_LARGEST_NUMBER <= value <= _LARGEST_NUMBER:
            self._fail(f'{word!r:.40} in the column {name} is not a number')
        return value

    def _number(self, name: str, default: str) -> float:
        """Return a number, or NaN, which stands for an unknown one."""
        word = self._row.get(name) or default
        try:
            value = float(word) if _is_plain(word) else math.inf
        except ValueError:
            value = math.inf
        if abs(value) > _LARGEST_NUMBER:
            self._fail(f'{word!r:.40} in the column {name} is not a number')
        return value

    def _fail(self, why: str) -> NoReturn:
        msg = f'{self._where}: {why}'
        raise InputError(msg)


def _is_plain(word: str) -> bool:
    """Return whether a number is short and has digits as all programs write them."""
    return len(word) <= _LONGEST_NUMBER and word.isascii() and '_' not in word
