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

"""Start pose_node with the topics of a camera, and RViz on request.

All arguments are checked before anything starts. If the node fails, the launch fails.
"""

from pathlib import Path
from typing import Any, NamedTuple

import yaml
from ament_index_python.packages import (
    PackageNotFoundError,
    get_package_prefix,
    get_package_share_directory,
)
from launch.actions import (
    DeclareLaunchArgument,
    OpaqueFunction,
    RegisterEventHandler,
    SetEnvironmentVariable,
)
from launch.event_handlers import OnProcessExit
from launch.events.process import ProcessExited
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

BOOLEAN = ('true', 'false')

# The arguments that set a parameter of the node, and the values of each; () for any. They are
# those of lsc_pose_ros/settings/table.py, which the Python of `ros2 launch` may not find.
PARAMETERS = {
    'model': (),
    'segmentation': ('auto', 'mask', 'people', 'background', 'nearest'),
    'rectified': ('auto', 'true', 'false'),
    'camera_roll': ('auto', '0', '90', '180', '270'),
    'depth_transport': ('raw', 'compressedDepth'),
    'mask_transport': ('raw', 'compressed'),
    'reliability': ('auto', 'best_effort', 'reliable'),
    'smoothing': BOOLEAN,
    'publish_tf': BOOLEAN,
    'publish_ros4hri': BOOLEAN,
    'use_sim_time': BOOLEAN,
}

# The topics of the node that config/lsc_pose.rviz shows.
SHOWN = (f'{NODE}/skeletons', f'{NODE}/joint_markers')

# The words that launch accepts for a truth value.
WORDS = {'true': True, '1': True, 'false': False, '0': False}


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
        **{name: ('', meaning_of(name)) for name in PARAMETERS},
        'rviz': ('false', 'whether to start RViz: true or false'),
        'frame': ('', 'fixed frame of RViz; empty: the frame of the camera'),
        'namespace': ('', 'namespace of the node'),
        **{
            name: ('', f'topic for {topic}; empty: the topic of the camera')
            for name, topic in TOPICS.items()
        },
    }


def meaning_of(name: str) -> str:
    """Return the description of an argument that sets a parameter."""
    values = ' or '.join(PARAMETERS[name])
    if name == 'model':
        values = 'model file, or the name of a model of the package'
    empty = 'the value in the file of the camera or in `config`'
    if name == 'segmentation':
        empty = f'mask if the topic of the mask is given, else {empty}'
    return f'{values}; empty: {empty}'


def nodes(context: LaunchContext) -> list[Any]:
    """Return what is started for the values of the arguments.

    Raises:
        ValueError: an argument cannot be used, so that nothing is started.
    """
    value = {name: LaunchConfiguration(name).perform(context) for name in ('camera', *arguments())}
    if not Path(value['config']).is_file():
        msg = f'config:={value["config"]}: there is no such file'
        raise ValueError(msg)
    path = config() / 'cameras' / f'{value["camera"]}.yaml'
    preset = Preset(**yaml.safe_load(path.read_text(encoding='utf-8')))
    given = {topic: value[name] for name, topic in TOPICS.items() if value[name]}
    topics = preset.topics | given
    node = pose_node(value, preset, topics)
    started = [RegisterEventHandler(OnProcessExit(target_action=node, on_exit=check_exit)), node]
    if boolean('rviz', value['rviz']):
        started.append(rviz(value, preset, topics))
    return started


def pose_node(value: dict[str, str], preset: Preset, topics: dict[str, str]) -> Node:
    """Return the node. It configures and activates itself."""
    parameters = dict(preset.parameters)
    if value['mask']:
        parameters['segmentation'] = 'mask'
    parameters |= {name: typed(name, value[name]) for name in PARAMETERS if value[name]}
    return Node(
        package='lsc_pose_ros',
        executable='pose_node',
        name=NODE,
        namespace=value['namespace'],
        # A single set of values after the file, because a file hides the sets before it.
        parameters=[value['config'], *([quoted(parameters)] if parameters else [])],
        remappings=list(topics.items()),
        output='screen',
    )


def check_exit(event: ProcessExited, context: LaunchContext) -> None:
    """End the launch with an error if the node failed.

    `ros2 launch` returns 1 if an event handler raises an exception, and ends all other processes.

    Raises:
        RuntimeError: the node failed.
    """
    if event.returncode and not context.is_shutdown:
        msg = f'{NODE} failed with exit status {event.returncode}; its log has the reason'
        raise RuntimeError(msg)


def rviz(value: dict[str, str], preset: Preset, topics: dict[str, str]) -> Node:
    """Return RViz, which shows the input and the output of the node.

    Raises:
        ValueError: RViz is not installed.
    """
    try:
        get_package_prefix('rviz2')
    except PackageNotFoundError as error:
        msg = 'rviz:=true needs the package rviz2, which is not installed'
        raise ValueError(msg) from error
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
    )


def typed(name: str, text: str) -> str | bool:
    """Return the value of the parameter `name` for the text of an argument.

    Raises:
        ValueError: the parameter cannot have this value.
    """
    values = PARAMETERS[name]
    if values == BOOLEAN:
        return boolean(name, text)
    if values and text not in values:
        msg = f'{name}:={text}: it must be {" or ".join(values)}'
        raise ValueError(msg)
    return text


def boolean(name: str, text: str) -> bool:
    """Return the truth value that `text` is.

    Raises:
        ValueError: it is none.
    """
    if text.lower() not in WORDS:
        msg = f'{name}:={text}: it must be true or false'
        raise ValueError(msg)
    return WORDS[text.lower()]


def quoted(parameters: dict[str, Any]) -> dict[str, Any]:
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
