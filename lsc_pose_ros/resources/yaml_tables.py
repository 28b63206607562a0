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

"""Reads YAML files that users write: tables of known keys."""

from pathlib import Path
from typing import Any

from lsc_pose_ros.errors import InputError, excerpt
from lsc_pose_ros.resources.bounded_yaml import parse_yaml
from lsc_pose_ros.resources.text_files import read_text


def read_yaml(path: Path, what: str) -> Any:  # noqa: ANN401 - anything that YAML holds
    """Return the contents of a YAML file; `what` names it in errors.

    Raises:
        InputError: the file cannot be read, or is no YAML that `parse_yaml` allows.
    """
    text = read_text(path, what)
    try:
        return parse_yaml(text)
    except ValueError as error:
        msg = f'the {what} {path} is not valid YAML: {error}'
        raise InputError(msg) from error


def table_of(value: object, name: str, keys: tuple[str, ...]) -> dict[str, Any]:
    """Return `value` if it is a table that has no other keys than `keys`.

    Raises:
        ValueError: it is no table, or has others; `name` names it in the message.
    """
    if not isinstance(value, dict):
        msg = f'{name} must be a table of {", ".join(keys)}'
        raise ValueError(msg)  # noqa: TRY004 - the user's error, not the program's
    unknown = [str(key) for key in value if key not in keys]
    if unknown:
        listed = excerpt(', '.join(unknown))
        msg = f'{name} has unknown keys: {listed}; known keys are {", ".join(keys)}'
        raise ValueError(msg)
    return value
