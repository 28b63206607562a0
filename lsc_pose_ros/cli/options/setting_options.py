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

"""Command-line options that are made from the table of settings."""

import argparse
from collections.abc import Callable
from typing import TypeVar

from lsc_pose_ros.cli.options.numbers import number_between
from lsc_pose_ros.settings.setting import Setting, settings_of
from lsc_pose_ros.settings.table import SETTINGS

Group = TypeVar('Group')


def add_setting_options(
    container: argparse._ActionsContainer, *names: str, note: str = ''
) -> None:
    """Add options to a parser or a group of options.

    Args:
        container: the parser or the group.
        names: the names of the settings.
        note: what the help says in addition.
    """
    for name in names:
        _add_option(container, SETTINGS[name], note)


def add_group_options(container: argparse._ActionsContainer, group: type) -> None:
    """Add the options of all settings of `group` that the command line has."""
    names = [name for name, setting in settings_of(group).items() if setting.command_line]
    add_setting_options(container, *names)


def settings_from(arguments: argparse.Namespace, group: type[Group]) -> Group:
    """Return the settings of `group`: the values of the options, defaults for the others."""
    values = vars(arguments)
    return group(**{name: values[name] for name in settings_of(group) if name in values})


def _add_option(container: argparse._ActionsContainer, setting: Setting, note: str) -> None:
    text = '; '.join(filter(None, (_help(setting), note)))
    if isinstance(setting.default, bool):
        container.add_argument(
            setting.option,
            action=argparse.BooleanOptionalAction,
            default=setting.default,
            help=text,
        )
    elif setting.choices:
        container.add_argument(
            setting.option, choices=tuple(setting.choices), default=setting.default, help=text
        )
    else:
        container.add_argument(
            setting.option,
            type=_value_type(setting),
            default=setting.default,
            metavar=_metavar(setting),
            help=text,
        )


def _value_type(setting: Setting) -> Callable[[str], str | int | float]:
    """Return what converts a word of the command line to a value of the setting."""
    if setting.lowest is None or setting.highest is None:
        return type(setting.default)
    return number_between(type(setting.default), setting.lowest, setting.highest)


def _metavar(setting: Setting) -> str:
    if isinstance(setting.default, str):
        return setting.name.upper()
    return (setting.unit or 'N').upper().replace(' ', '_')


def _help(setting: Setting) -> str:
    """Return description, choices and default in the form of a help text."""
    text = setting.description[0].lower() + setting.description[1:].removesuffix('.')
    if setting.choices:
        meanings = (f'{choice}: {each}' for choice, each in setting.choices.items())
        text = f'{text}. {" ".join(meanings)}'
    text = text.replace('%', '%%')
    return f'{text} (default: %(default)s)' if setting.default != '' else text
