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

"""The option `--camera`: the topics and parameters of a camera as defaults of other options."""

import argparse
from collections.abc import Sequence
from typing import Any

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources.package_files import resource
from lsc_pose_ros.settings.table import MASK

OPTION = '--camera'
_MASK_OPTION = '--mask-topic'

# The preset of the launch file for topics with their own names.
_NO_CAMERA = 'none'

# The options for the topics of the node.
_TOPIC_OPTIONS = {
    'depth/image': 'depth_topic',
    'depth/camera_info': 'camera_info_topic',
    'mask': 'mask_topic',
}


def add_camera_option(group: argparse._ArgumentGroup) -> None:
    """Add `--camera`; `use_camera_preset` gives it its effect."""
    group.add_argument(
        OPTION,
        default='',
        metavar='CAMERA',
        help=f'topics and settings of a camera: {", ".join(camera_names())}; '
        'other options have precedence',
    )


def camera_names() -> list[str]:
    """Return the names of the cameras that have a preset, sorted."""
    names = sorted(path.stem for path in resource('config', 'cameras').glob('*.yaml'))
    return [name for name in names if name != _NO_CAMERA]


def use_camera_preset(parser: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Make the preset that `words` name the defaults of `parser`, so that options override it.

    Raises:
        InputError: there is no such preset.
    """
    if not any(OPTION in action.option_strings for action in parser._actions):  # noqa: SLF001
        return
    finder = argparse.ArgumentParser(add_help=False, allow_abbrev=False, exit_on_error=False)
    for option in (OPTION, _MASK_OPTION):
        finder.add_argument(option, default='', nargs='?', const='')
    found = finder.parse_known_args(words)[0]
    if found.camera:
        defaults = preset_defaults(found.camera)
        if found.mask_topic:
            defaults['segmentation'] = MASK  # as `mask:=` of the launch file
        parser.set_defaults(**defaults)


def preset_defaults(name: str) -> dict[str, Any]:
    """Return the values of the options that a camera's file sets, by the options' names.

    Raises:
        InputError: there is no preset of this name.
    """
    if name not in camera_names():
        msg = f'{OPTION} {name}: there is no such camera; there are {", ".join(camera_names())}'
        raise InputError(msg)
    # Only this option needs YAML, whose import takes time.
    from lsc_pose_ros.resources.yaml_tables import read_yaml  # noqa: PLC0415

    preset = read_yaml(resource('config', 'cameras', f'{name}.yaml'), 'preset of the camera')
    defaults: dict[str, Any] = dict(preset['parameters'])
    return defaults | {_TOPIC_OPTIONS[role]: topic for role, topic in preset['topics'].items()}
