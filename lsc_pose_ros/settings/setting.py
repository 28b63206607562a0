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

"""Declares a setting: a dataclass field with its description, unit, range and choices."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from enum import Enum
from numbers import Integral, Real
from typing import Any, TypeAlias, TypeVar

from lsc_pose_ros.errors import InputError

Value: TypeAlias = str | bool | int | float

ValueType = TypeVar('ValueType', str, bool, int, float)

Group = TypeVar('Group')

_METADATA_KEY = 'setting'

# The names that ROS 2 gives to the types of parameters.
_TYPE_NAMES = {bool: 'bool', int: 'integer', float: 'double', str: 'string'}


class Change(Enum):
    """When the value of a setting can change, as the end of a sentence."""

    ANY_TIME = 'at any time'
    UNCONFIGURED = 'while the node is unconfigured'
    START = 'only when the node starts'


@dataclass(frozen=True)
class Setting:
    """What a setting means and which values it can have.

    Attributes:
        name: the name of the ROS parameter; the command-line option has `-` for each `_`.
        default: the value if none is given; it has the type of the setting.
        description: one sentence.
        unit: the unit in words, empty for none.
        lowest: the smallest value of a number, None for no limit.
        highest: the largest value of a number, None for no limit.
        choices: the values of a text and what each means; empty if any text is allowed.
        change: when a running node accepts another value.
        command_line: whether the commands that estimate have the setting as an option.
        details: more sentences for `pose_node.yaml`.
    """

    name: str
    default: Value
    description: str
    unit: str
    lowest: float | None
    highest: float | None
    choices: Mapping[str, str]
    change: Change
    command_line: bool
    details: str

    @property
    def type_name(self) -> str:
        """The type, as ROS 2 names it: bool, integer, double or string."""
        return _TYPE_NAMES[type(self.default)]

    @property
    def option(self) -> str:
        """The command-line option."""
        return f'--{self.name.replace("_", "-")}'

    @property
    def rule(self) -> str:
        """What a value must be, as the end of a sentence."""
        if self.choices:
            return f'it must be {" or ".join(self.choices)}'
        if self.lowest is None:
            return f'it must be of type {self.type_name}'
        return f'it must be of type {self.type_name}, from {self.lowest} to {self.highest}'

    @property
    def read_as_other_type(self) -> bool:
        """Whether ROS 2 reads one of the choices as a bool or a number."""
        return any(choice in ('true', 'false') or choice.isdigit() for choice in self.choices)

    def text_of(self, value: Any) -> Any:  # noqa: ANN401
        """Return the choice that ROS 2 has read as a bool or a number, or `value` itself.

        `-p rectified:=true` on the command line and `rectified: true` in a file give a bool.
        """
        if not self.choices or isinstance(value, str):
            return value
        return str(value).lower()

    def unknown_choice(self, value: object) -> str:
        """Return why `value` is none of the choices; empty if it is one or there are none."""
        if not self.choices or self.text_of(value) in self.choices:
            return ''
        return f'parameter {self.name}: {value!r} is not known; {self.rule}'

    def checked(self, value: Any) -> Any:  # noqa: ANN401
        """Return `value` in the type of the setting.

        Raises:
            InputError: the value has another type, is out of range or none of the choices.
        """
        value = self.text_of(value)
        kind: Any = type(self.default)
        number = Integral if kind is int else Real if kind is float else ()
        if isinstance(value, number) and not isinstance(value, bool):
            value = kind(value)
        if type(value) is kind and self._allows(value):
            return value
        msg = f'the setting {self.name} cannot be {value!r}; {self.rule}'
        raise InputError(msg)

    def _allows(self, value: Any) -> bool:  # noqa: ANN401
        if self.choices:
            return value in self.choices
        return self.lowest is None or self.highest is None or self.lowest <= value <= self.highest


def setting(
    default: ValueType,
    description: str,
    *,
    unit: str = '',
    lowest: float | None = None,
    highest: float | None = None,
    choices: Mapping[str, str] | None = None,
    change: Change = Change.UNCONFIGURED,
    command_line: bool = True,
    details: str = '',
) -> ValueType:
    """Return a dataclass field that declares a setting; the arguments are those of Setting."""
    declared = Setting(
        name='',  # the field does not know it yet
        default=default,
        description=description,
        unit=unit,
        lowest=lowest,
        highest=highest,
        choices=choices or {},
        change=change,
        command_line=command_line,
        details=details,
    )
    return field(default=default, metadata={_METADATA_KEY: declared})


def settings_of(group: type) -> dict[str, Setting]:
    """Return the settings of a dataclass by their names, in the order of its fields."""
    return {
        each.name: replace(each.metadata[_METADATA_KEY], name=each.name) for each in fields(group)
    }


def checked_settings(settings: Group) -> Group:
    """Return `settings`, a dataclass of settings, with each value in the type of its setting.

    Raises:
        InputError: a value has another type, is out of range or none of the choices.
    """
    values = {
        name: each.checked(getattr(settings, name))
        for name, each in settings_of(type(settings)).items()
    }
    return type(settings)(**values)
