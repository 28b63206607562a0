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

"""The arguments that name a recording's topics: the same in every command that reads one."""

import argparse
from pathlib import Path

from lsc_pose_ros.bags import FrameReader, open_recording
from lsc_pose_ros.bags.topics import Topics
from lsc_pose_ros.cli.options.camera_preset import add_camera_option
from lsc_pose_ros.cli.options.setting_options import add_group_options, settings_from
from lsc_pose_ros.settings.table import FrameSettings

_TOPICS = {
    'depth': 'depth images',
    'camera-info': 'camera infos of the depth images',
    'mask': 'masks',
    'ground-truth': 'labelled skeletons',
}


def add_topic_arguments(parser: argparse.ArgumentParser) -> None:
    """Add --NAME-topic for each topic of a frame, and the settings of how frames are made."""
    group = parser.add_argument_group('topics of the recording')
    add_camera_option(group)
    for name, what in _TOPICS.items():
        group.add_argument(
            f'--{name}-topic',
            default='',
            metavar='TOPIC',
            help=f'the {what} (default: found by type and name)',
        )
    add_group_options(
        parser.add_argument_group(
            'how frames are made', 'The parameters of pose_node have the same names.'
        ),
        FrameSettings,
    )


def open_frames(
    path: Path, arguments: argparse.Namespace, *, need_mask: bool = True
) -> FrameReader:
    """Open the recording at `path` as `arguments` ask for.

    Args:
        path: the recording.
        arguments: the command line.
        need_mask: as `open_recording`.

    Raises:
        InputError: as `open_recording`.
    """
    settings = settings_from(arguments, FrameSettings)
    return open_recording(path, topics_of(arguments), settings=settings, need_mask=need_mask)


def topics_of(arguments: argparse.Namespace) -> Topics:
    """Return the topics that `arguments` name; '' stands for those that they do not."""
    return Topics(
        depth=arguments.depth_topic,
        camera_info=arguments.camera_info_topic,
        mask=arguments.mask_topic,
        ground_truth=arguments.ground_truth_topic,
    )
