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

"""The option `--settings`: a YAML file with values of other options."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from lsc_pose_ros.errors import InputError, excerpt

OPTION = '--settings'

# These name files and inputs, which belong on the command line.
_NOT_SETTINGS = {
    'help',
    'recordings',
    'output',
    'json',
    'calibrate',
    'settings',
    'quiet',
    'verbose',
}


def add_settings_file_option(parser: argparse.ArgumentParser) -> None:
    """Add `--settings`; `use_settings_file` gives it its effect."""
    parser.add_argument(
        OPTION,
        type=Path,
        metavar='YAML',
        help='read settings from this file, by the names of the options without dashes in front, '
        'such as `trees: 5`; options on the command line have precedence',
    )


def use_settings_file(parser: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Make the values of the file that `words` name the defaults of `parser`.

    Raises:
        InputError: the file cannot be read, or has an unknown name or an impossible value.
    """
    actions = {action.dest: action for action in parser._actions}  # noqa: SLF001
    if 'settings' not in actions:
        return
    finder = argparse.ArgumentParser(add_help=False, allow_abbrev=False, exit_on_error=False)
    finder.add_argument(OPTION, nargs='?', type=Path)
    path = finder.parse_known_args(words)[0].settings
    if path is None:
        return
    known = {name: action for name, action in actions.items() if name not in _NOT_SETTINGS}
    defaults: dict[str, object] = {}
    for name, value in _read(path).items():
        action = known.get(str(name).replace('-', '_'))
        if action is None:
            names = ', '.join(sorted(known))
            msg = f'{path}: {excerpt(name)} is not a setting; the settings are {names}'
            raise InputError(msg)
        defaults[action.dest] = _converted(path, action, value)
    parser.set_defaults(**defaults)


def _read(path: Path) -> dict[object, object]:
    # Only this option needs YAML, whose import takes time.
    from lsc_pose_ros.resources.yaml_tables import read_yaml  # noqa: PLC0415

    loaded = read_yaml(path, 'file of settings')
    if not isinstance(loaded, dict):
        msg = f'{path} is no table of settings, such as `trees: 5`'
        raise InputError(msg)
    return loaded


def _converted(path: Path, action: argparse.Action, value: object) -> object:
    """Return `value` as the option `action` would have read it."""
    if action.nargs == 0:  # a switch
        if not isinstance(value, bool):
            msg = f'{path}: {action.dest} is {excerpt(repr(value))}; give true or false'
            raise InputError(msg)
        return value
    several = action.nargs in {'+', '*'}
    parts = value if several and isinstance(value, list) else [value]
    if not parts or not all(isinstance(part, str | int | float) for part in parts):
        msg = f'{path}: {action.dest}: give one value{" or more" if several else ""}'
        raise InputError(msg)
    convert = action.type if callable(action.type) else str
    try:
        converted = [convert(str(part)) for part in parts]
    except (ValueError, argparse.ArgumentTypeError) as error:
        msg = f'{path}: {action.dest}: {excerpt(error, 200)}'
        raise InputError(msg) from error
    if action.choices is not None and not set(converted) <= set(action.choices):
        choices = ', '.join(map(str, action.choices))
        msg = f'{path}: {action.dest} is {excerpt(repr(value))}; give one of {choices}'
        raise InputError(msg)
    return converted if several else converted[0]
