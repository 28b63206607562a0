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

"""Decides which changes of the parameters the node accepts, and says why it refuses others."""

from collections.abc import Iterable

from rclpy.parameter import Parameter

from lsc_pose_ros.estimation.model_settings import query_points_refusal
from lsc_pose_ros.settings.setting import Change
from lsc_pose_ros.settings.table import SETTINGS


def integers_as_doubles(parameters: Iterable[Parameter]) -> list[Parameter]:
    """Return `parameters` with a double for each integer that is given for a double.

    `ros2 param set /pose_node smoothing_beta 1` sends an integer.
    """
    return [
        Parameter(each.name, Parameter.Type.DOUBLE, float(each.value))
        if each.type_ == Parameter.Type.INTEGER and _is_double(each.name)
        else each
        for each in parameters
    ]


def refusal(changes: Iterable[Parameter], *, configured: bool, points: int) -> str:
    """Return why parameters cannot be changed, beyond type and range; empty if they can.

    Args:
        changes: the new values.
        configured: whether the node is configured.
        points: how many points a silhouette has, 0 if no model is loaded.
    """
    reasons = (_refusal_of_one(change, configured=configured, points=points) for change in changes)
    return next(filter(None, reasons), '')


def _refusal_of_one(change: Parameter, *, configured: bool, points: int) -> str:
    setting = SETTINGS.get(change.name)
    if setting is None:
        return ''  # a parameter that rclpy declares
    if configured and setting.change == Change.UNCONFIGURED:
        return (
            f'parameter {change.name}: it can be set only {setting.change.value}; deactivate and '
            'clean up the node first, or start it with the new value'
        )
    if change.name == 'query_points':
        reason = query_points_refusal(change.value, points)
        return f'parameter query_points: {reason}' if reason else ''
    return setting.unknown_choice(change.value)


def _is_double(name: str) -> bool:
    return name in SETTINGS and isinstance(SETTINGS[name].default, float)
