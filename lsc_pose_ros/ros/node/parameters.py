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

"""Declares and reads the node's parameters, which are the settings of the table."""

from difflib import get_close_matches

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.node import Node

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.ros.node.parameter_rules import integers_as_doubles
from lsc_pose_ros.settings.setting import Change, Setting
from lsc_pose_ros.settings.table import SETTINGS, NodeSettings

JOINT_NAMES = 'joint_names'
"""The read-only parameter that a configured node has."""

# A file that `ros2 param dump` wrote has joint_names; rclpy reads qos_overrides.
_ALWAYS_ACCEPTED = (JOINT_NAMES, 'qos_overrides.')


def declare_parameters(node: Node) -> NodeSettings:
    """Declare the parameters on `node` and return their values.

    An integer that is given for a double is accepted, as when the parameter is set later.

    Raises:
        InputError: a value has the wrong type, is out of range or is none of the choices.
    """
    overrides = node._parameter_overrides  # noqa: SLF001 - rclpy has no public access
    overrides.update({each.name: each for each in integers_as_doubles(list(overrides.values()))})
    for setting in SETTINGS.values():
        _declare(node, setting)
    parameters = read_parameters(node)
    for name, setting in SETTINGS.items():
        reason = setting.unknown_choice(getattr(parameters, name))
        if reason:
            raise InputError(reason)
    return parameters


def read_parameters(node: Node) -> NodeSettings:
    """Return the current values of the declared parameters."""
    return NodeSettings(
        **{
            name: setting.text_of(node.get_parameter(name).value)
            for name, setting in SETTINGS.items()
        }
    )


def unknown_parameters(node: Node) -> list[str]:
    """Return a sentence for each parameter that was given but is not declared on `node`."""
    given = node._parameter_overrides  # noqa: SLF001 - rclpy has no public access
    return [
        _unknown(name)
        for name in sorted(given)
        if not (node.has_parameter(name) or name.startswith(_ALWAYS_ACCEPTED))
    ]


def descriptor(setting: Setting) -> ParameterDescriptor:
    """Return what `ros2 param describe` shows."""
    described = ParameterDescriptor(
        description=setting.description,
        additional_constraints='; '.join(
            filter(None, (' or '.join(setting.choices), f'can be set {setting.change.value}'))
        ),
        read_only=setting.change == Change.START,
        dynamic_typing=setting.read_as_other_type,
    )
    if setting.lowest is None or setting.highest is None:
        return described
    if isinstance(setting.default, float):
        described.floating_point_range = [
            FloatingPointRange(from_value=setting.lowest, to_value=setting.highest)
        ]
    else:
        described.integer_range = [
            IntegerRange(from_value=int(setting.lowest), to_value=int(setting.highest), step=1)
        ]
    return described


def _unknown(name: str) -> str:
    close = get_close_matches(name, SETTINGS, n=1)
    question = f'; did you mean {close[0]}?' if close else ''
    return f'parameter {name} is not known and is ignored{question}'


def _declare(node: Node, setting: Setting) -> None:
    try:
        node.declare_parameter(setting.name, setting.default, descriptor(setting))
    except (InvalidParameterTypeException, InvalidParameterValueException) as error:
        msg = f'parameter {setting.name}: {setting.rule}'
        raise InputError(msg) from error
