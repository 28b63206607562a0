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

"""Finds the files of a recording."""

import io
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, NamedTuple, cast

import zstandard

from lsc_pose_ros.bags.storage.damage import DAMAGE, reason
from lsc_pose_ros.bags.storage.piecewise_stream import PiecewiseStream
from lsc_pose_ros.bags.storage.recorded_metadata import METADATA_NAME, read_metadata
from lsc_pose_ros.bags.storage.serialized_messages import TopicSummary
from lsc_pose_ros.errors import InputError, excerpt
from lsc_pose_ros.files.output_place import writing
from lsc_pose_ros.files.temporary import temporary_folder

MCAP_MAGIC = b'\x89MCAP0\r\n'
SQLITE_MAGIC = b'SQLite format 3\0'
ZSTD_MAGIC = b'\x28\xb5\x2f\xfd'
_ROS1_MAGIC = b'#ROSBAG V'
_LONGEST_MAGIC = 16
_PIECE = 1 << 16

_PART_NAME = re.compile(r'\.(mcap|db3)(\.zstd)?$')

# So many files that cannot be read have a warning each.
_SHOWN = 5


class Part(NamedTuple):
    """One file of a recording.

    Attributes:
        path: the file.
        storage: 'mcap' or 'sqlite3'.
        compressed: True if the whole file is compressed with zstd.
    """

    path: Path
    storage: str
    compressed: bool


class Layout(NamedTuple):
    """A recording on disk.

    Attributes:
        path: the file or the bag folder.
        parts: the files in the order of recording.
        topics: the topics according to metadata.yaml, None without metadata.yaml.
        warnings: a sentence for each problem of the folder.
    """

    path: Path
    parts: list[Part]
    topics: dict[str, TopicSummary] | None
    warnings: list[str]


def find_parts(path: Path) -> Layout:
    """Return the files of the recording `path`, a file or a bag folder.

    Raises:
        InputError: there is no recording.
    """
    if not path.exists():
        msg = f'{path}: no such file or folder'
        raise InputError(msg)
    if not path.is_dir():
        return Layout(path, [identify(path)], _topics_beside(path), [])
    warnings: list[str] = []
    metadata = read_metadata(path / METADATA_NAME, warnings)
    parts = _identify_all(_part_paths(path, metadata.files, warnings), warnings)
    if not parts:
        msg = f'{path}: no recording in this folder (.mcap or .db3, with or without .zstd)'
        raise InputError('; '.join([msg, *warnings]))
    return Layout(path, parts, metadata.topics, warnings)


def identify(path: Path) -> Part:
    """Return the storage format of the file `path`, according to its first bytes.

    Raises:
        InputError: it cannot be read or is no recording.
    """
    if path.exists() and not path.is_file():  # a pipe would wait for somebody who writes to it
        msg = f'{path}: is no file'
        raise InputError(msg)
    try:
        with path.open('rb') as stream:
            magic = stream.read(_LONGEST_MAGIC)
        compressed = magic.startswith(ZSTD_MAGIC)
        if compressed:
            with open_part(path, compressed=True) as stream:
                magic = stream.read(_LONGEST_MAGIC)
    except DAMAGE as error:
        msg = f'{path}: cannot be read ({reason(error)})'
        raise InputError(msg) from error
    if magic.startswith(MCAP_MAGIC):
        return Part(path, 'mcap', compressed)
    if magic.startswith(SQLITE_MAGIC):
        return Part(path, 'sqlite3', compressed)
    if magic.startswith(_ROS1_MAGIC):
        msg = f'{path}: a bag of ROS 1; convert it first, for example with rosbags-convert'
        raise InputError(msg)
    what = 'is not a recording: neither MCAP nor SQLite' if magic else 'is empty'
    msg = f'{path}: the file {what}'
    raise InputError(msg)


@contextmanager
def open_part(path: Path, *, compressed: bool) -> Iterator[IO[bytes]]:
    """Open a file of a recording; a compressed file is decompressed while it is read."""
    with path.open('rb') as stream:
        if not compressed:
            yield cast('IO[bytes]', PiecewiseStream(stream))
            return
        with zstandard.ZstdDecompressor().stream_reader(
            stream, read_across_frames=True
        ) as decompressed:
            buffered = io.BufferedReader(cast('io.RawIOBase', decompressed), 1 << 20)
            yield cast('IO[bytes]', PiecewiseStream(buffered))


@contextmanager
def plain_copy(part: Part, name: str) -> Iterator[Path]:
    """Decompress a compressed file into a temporary folder, up to a damage.

    Args:
        part: the file.
        name: the name of the copy.

    Raises:
        InputError: the temporary folder cannot be written, or is full.
    """
    with temporary_folder() as folder:
        path = folder / name
        with writing(path), path.open('wb') as target:
            for piece in _pieces(part):
                target.write(piece)
        yield path


def _pieces(part: Part) -> Iterator[bytes]:
    """Yield the content of a file, up to a damage."""
    with suppress(*DAMAGE), open_part(part.path, compressed=part.compressed) as source:
        while piece := source.read(_PIECE):
            yield piece


def _topics_beside(path: Path) -> dict[str, TopicSummary] | None:
    """Return the topics of the metadata.yaml beside a file, None if it does not list the file."""
    metadata = read_metadata(path.with_name(METADATA_NAME), [])
    listed = {name.removesuffix('.zstd') for name in metadata.files}
    return metadata.topics if path.name.removesuffix('.zstd') in listed else None


def _part_paths(folder: Path, names: Sequence[str], warnings: list[str]) -> list[Path]:
    """Return the files in the order of the metadata, then the others by their numbers."""
    # The suffix .zstd is missing if the recorder was killed during compression.
    listed = list(dict.fromkeys(_with_compression(folder / name) for name in names))
    found = [path for path in folder.iterdir() if _PART_NAME.search(path.name)]
    found.sort(key=lambda path: [*map(int, re.findall(r'\d+', path.name)), 0])
    others = [path for path in found if path not in listed]
    if names and others:
        unlisted = excerpt(', '.join(each.name for each in others), 500)
        warnings.append(f'{METADATA_NAME} does not list {unlisted}; read, too')
    if others and not any(path.exists() for path in listed):
        return others  # the files were renamed
    return [*listed, *others]


def _with_compression(path: Path) -> Path:
    compressed = path.with_name(f'{path.name}.zstd')
    return compressed if not path.exists() and compressed.exists() else path


def _identify_all(paths: list[Path], warnings: list[str]) -> list[Part]:
    """Return the readable files; warn of the others."""
    parts, others = [], []
    for path in paths:
        try:
            parts.append(identify(path))
        except InputError as error:  # noqa: PERF203
            others.append(f'{error}; it was left out')
    warnings += others[:_SHOWN]
    if len(others) > _SHOWN:
        warnings.append(f'{len(others) - _SHOWN} more files were left out')
    return parts
