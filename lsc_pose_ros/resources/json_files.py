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

"""Reads JSON files that users write or get from strangers."""

import json
from pathlib import Path
from typing import Any

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources.text_files import LARGEST_TEXT, read_text

_LONGEST_INTEGER = 30


def read_json(path: Path, what: str, largest: int = LARGEST_TEXT) -> Any:  # noqa: ANN401
    """Return the contents of a JSON file, without very large integers.

    Args:
        path: the file.
        what: names it in errors, such as 'intrinsics'.
        largest: the most bytes that it may have.

    Raises:
        InputError: it cannot be read, or is not JSON.
    """
    text = read_text(path, what, largest)
    try:
        return json.loads(text, parse_int=_integer)
    except RecursionError as error:
        msg = f'the {what} {path} cannot be read: its lists are nested too deeply'
        raise InputError(msg) from error
    except ValueError as error:
        msg = f'the {what} {path} is not valid JSON: {error}'
        raise InputError(msg) from error


def _integer(digits: str) -> int:
    if len(digits) > _LONGEST_INTEGER:
        msg = f'an integer with {len(digits)} digits'
        raise ValueError(msg)
    return int(digits)
