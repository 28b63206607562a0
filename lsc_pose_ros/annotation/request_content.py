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
"""What requests of the page contain; each is checked before anything is done with it."""

import json
import math
from email.message import Message
from http import HTTPStatus
from io import BufferedIOBase
from typing import NamedTuple, NoReturn

from lsc_pose_ros.errors import InputError

LARGEST_REQUEST = 1_000_000
"""No request has more bytes."""

_LARGEST = 1e6  # pixels or metres
_MOST_DIGITS = 9


class RequestError(InputError):
    """A request cannot be read.

    Attributes:
        status: of its answer.
    """

    def __init__(self, message: str, status: HTTPStatus = HTTPStatus.BAD_REQUEST) -> None:
        """Say in one sentence what is wrong."""
        super().__init__(message)
        self.status = status


class JointRequest(NamedTuple):
    """Where the page puts a joint.

    Attributes:
        pixel: column and row.
        depth: metres; None if it is that of the body there.
        body: its number, if there is no depth.
        joint: its name, if there is no depth.
    """

    pixel: tuple[float, float]
    depth: float | None
    body: int
    joint: str


def read_content(headers: Message, stream: BufferedIOBase) -> dict[str, object]:
    """Return the JSON object of a request.

    Raises:
        RequestError: there is none.
        TimeoutError: the bytes do not come.
    """
    length = _length(headers.get('Content-Length'))
    data = stream.read(length)
    if len(data) < length:
        msg = f'the request ends after {len(data)} of {length} bytes'
        raise RequestError(msg)
    try:
        content = json.loads(data, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        msg = 'the request is no JSON'
        raise RequestError(msg) from error
    if not isinstance(content, dict):
        msg = 'the request is no JSON object'
        raise RequestError(msg)
    return content


def joint_request(content: dict[str, object]) -> JointRequest:
    """Return where a joint is put.

    Raises:
        RequestError: the content does not say that.
    """
    pixel, depth = content.get('pixel'), content.get('depth')
    body, joint = (content.get(name) for name in ('body', 'joint'))
    if depth is not None:  # of any joint
        body, joint = 0, ''
    if isinstance(pixel, list) and len(pixel) == len('xy'):
        column, row, z = (_number(value) for value in (*pixel, 0 if depth is None else depth))
        is_known = all(map(math.isfinite, (column, row, z)))
        if is_known and type(body) is int and isinstance(joint, str):
            return JointRequest((column, row), None if depth is None else z, body, joint)
    msg = 'a joint is placed by pixel, body and joint, or by pixel and depth'
    raise RequestError(msg)


def frame_number(path: str) -> int:
    """Return the number at the end of a path.

    Raises:
        RequestError: there is none.
    """
    word = path.rsplit('/', 1)[1]
    if not _is_number(word):
        msg = 'the address has no number of a frame'
        raise RequestError(msg)
    return int(word)


def _length(word: str | None) -> int:
    if word is None:
        msg = 'a request needs its Content-Length'
        raise RequestError(msg, HTTPStatus.LENGTH_REQUIRED)
    if not (word.isascii() and word.isdigit()):
        msg = 'the Content-Length of a request is a number of bytes'
        raise RequestError(msg)
    if not _is_number(word) or int(word) > LARGEST_REQUEST:
        msg = f'a request has at most {LARGEST_REQUEST} bytes'
        raise RequestError(msg, HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
    return int(word)


def _is_number(word: str) -> bool:
    return word.isascii() and word.isdigit() and len(word) <= _MOST_DIGITS


def _number(value: object) -> float:
    """Return a number of JSON, NaN for anything else and for absurd ones."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return math.nan
    return float(value) if abs(value) <= _LARGEST else math.nan


def _refuse_constant(name: str) -> NoReturn:
    msg = f'{name} is no JSON'
    raise ValueError(msg)
