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

"""Kinds of files, which are told by the content and not by the name."""

import codecs
import zipfile
from collections.abc import Callable
from typing import BinaryIO, NamedTuple

_BEGINNING = 4096


class Kind(NamedTuple):
    """A kind of files.

    Attributes:
        name: with its article, for example 'a PNG picture'.
        fits: returns whether an open file is of this kind. It may raise any error for others.
    """

    name: str
    fits: Callable[[BinaryIO], bool]


def begins_with(name: str, *beginnings: bytes) -> Kind:
    """Return the kind of the files with one of `beginnings`, whatever case and space is first."""
    wanted = tuple(each.lower() for each in beginnings)

    def fits(stream: BinaryIO) -> bool:
        return stream.read(_BEGINNING).lstrip().lower().startswith(wanted)

    return Kind(name, fits)


def archive(name: str, member: str, content: bytes = b'') -> Kind:
    """Return the kind of the zip archives whose `member` has `content` at its beginning."""

    def fits(stream: BinaryIO) -> bool:
        with zipfile.ZipFile(stream) as parts, parts.open(member) as part:
            return content in part.read(_BEGINNING)

    return Kind(name, fits)


def _is_text(stream: BinaryIO) -> bool:
    beginning = stream.read(_BEGINNING)
    # The last character may be cut off, which an incremental decoder allows.
    codecs.getincrementaldecoder('utf-8')().decode(beginning)
    return b'\0' not in beginning


PNG = begins_with('a PNG picture', b'\x89PNG\r\n\x1a\n')
JSON = begins_with('a JSON file', b'{', b'[')
HTML = begins_with('a web page', b'<!doctype html', b'<html')
TEXT = Kind('a text', _is_text)
