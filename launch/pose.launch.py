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

"""Start pose_node with the topics of a camera, and RViz on request."""

from pathlib import Path
from typing import Any, NamedTuple

import yaml
from ament_index_python.packages import get_package_share_directory
from launch.actions import DeclareLaunchArgument, OpaqueFunction, SetEnvironmentVariable
from launch.conditions import IfCondition
from launch.substitutions import EnvironmentVariable, LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

from launch import LaunchContext, LaunchDescription

NODE = 'pose_node'
PROFILE_VARIABLE = 'FASTRTPS_DEFAULT_PROFILES_FILE'

# The arguments that name a topic, and the name of that topic in the node.
TOPICS = {
    'depth_image': 'depth/image',
    'camera_info': 'depth/camera_info',
    'mask': 'mask',
}

# The arguments that set a parameter of the node.
PARAMETERS = ('model', 'segmentation', 'depth_transport')

# The topics of the node that config/lsc_pose.rviz shows.
SHOWN = (f'{NODE}/skeletons', f'{NODE}/joint_markers')


class Preset(NamedTuple):
    """The contents of a camera's file in config/cameras.

    Attributes:
        frame: the frame of the depth images.
        topics: the topics of the driver, by their names in the node.
        parameters: the parameters of the node for this camera.
    """

    frame: str
    topics: dict[str, str]
    parameters: dict[str, Any]


def config() -> Path:
    """Return the folder of the configuration files."""
    return Path(get_package_share_directory('lsc_pose_ros')) / 'config'


def generate_launch_description() -> LaunchDescription:
    """Return the arguments, the environment and the nodes."""
    cameras = sorted(path.stem for path in (config() / 'cameras').glob('*.yaml'))
    profile = EnvironmentVariable(
        PROFILE_VARIABLE, default_value=str(config() / 'fastdds_profile.xml')
    )
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                'camera',
                default_value='none',
                choices=cameras,
                description='the camera whose topics are used: a file in config/cameras',
            ),
            *(
                DeclareLaunchArgument(name, default_value=default, description=meaning)
                for name, (default, meaning) in arguments().items()
            ),
            # The profile takes effect at the sender of images: start the camera driver in the same
            # launch, or with the same variable.
            SetEnvironmentVariable(PROFILE_VARIABLE, profile),
            OpaqueFunction(function=nodes),
        ]
    )


def arguments() -> dict[str, tuple[str, str]]:
    """Return the default and the description of each argument except `camera`."""
    return {
        'config': (
            str(config() / 'pose_node.yaml'),
            'file of parameters; the arguments and the file of the camera override it',
        ),
        'model': (
            '',
            'model file, or the name of a model of the package; empty: the value in `config`',
        ),
        'segmentation': (
            '',
            'mask, background or nearest; empty: mask if `mask` is given, else as in the files',
        ),
        'depth_transport': ('', 'raw or compressedDepth'),
        'rviz': ('false', 'whether to start RViz'),
        'frame': ('', 'fixed frame of RViz; empty: the frame of the camera'),
        'namespace': ('', 'namespace of the node'),
        **{
            name: ('', f'topic for {topic}; empty: the topic of the camera')
            for name, topic in TOPICS.items()
        },
    }


def nodes(context: LaunchContext) -> list[Node]:
    """Return the nodes for the values of the arguments."""
    value = {name: LaunchConfiguration(name).perform(context) for name in ('camera', *arguments())}
    path = config() / 'cameras' / f'{value["camera"]}.yaml'
    preset = Preset(**yaml.safe_load(path.read_text(encoding='utf-8')))
    given = {topic: value[name] for name, topic in TOPICS.items() if value[name]}
    topics = preset.topics | given
    return [pose_node(value, preset, topics), rviz(value, preset, topics)]


def pose_node(value: dict[str, str], preset: Preset, topics: dict[str, str]) -> Node:
    """Return the node. It configures and activates itself."""
    parameters = dict(preset.parameters)
    if value['mask']:
        parameters['segmentation'] = 'mask'
    parameters |= {name: value[name] for name in PARAMETERS if value[name]}
    return Node(
        package='lsc_pose_ros',
        executable='pose_node',
        name=NODE,
        namespace=value['namespace'],
        # A single set of values after the file, because a file hides the sets before it.
        parameters=[value['config'], *([typed(parameters)] if parameters else [])],
        remappings=list(topics.items()),
        output='screen',
    )


def rviz(value: dict[str, str], preset: Preset, topics: dict[str, str]) -> Node:
    """Return RViz, which shows the input and the output of the node."""
    shown = topics | {topic: topic for topic in SHOWN}
    return Node(
        package='rviz2',
        executable='rviz2',
        name='rviz2',
        arguments=[
            '-d',
            str(config() / 'lsc_pose.rviz'),
            '-f',
            value['frame'] or preset.frame,
        ],
        remappings=[
            (f'/{topic}', absolute(target, value['namespace'])) for topic, target in shown.items()
        ],
        condition=IfCondition(LaunchConfiguration('rviz')),
    )


def typed(parameters: dict[str, Any]) -> dict[str, Any]:
    """Return `parameters` with texts marked as such, even if they look like numbers."""
    return {
        name: ParameterValue(value, value_type=str) if isinstance(value, str) else value
        for name, value in parameters.items()
    }


def absolute(topic: str, namespace: str) -> str:
    """Return the absolute name of `topic` in `namespace`."""
    if topic.startswith('/'):
        return topic
    return '/' + '/'.join(part for part in (namespace.strip('/'), topic) if part)
