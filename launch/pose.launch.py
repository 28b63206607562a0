"""Start pose_node, remapped to a camera's and a segmentation's topics."""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch.actions import DeclareLaunchArgument, OpaqueFunction, SetEnvironmentVariable
from launch.substitutions import EnvironmentVariable, LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchContext, LaunchDescription

PROFILE_VARIABLE = 'FASTRTPS_DEFAULT_PROFILES_FILE'

TOPICS = {
    'depth_image': 'depth/image',
    'camera_info': 'depth/camera_info',
    'mask': 'mask',
}


def generate_launch_description() -> LaunchDescription:
    """Return the arguments, the environment and the node."""
    config = Path(get_package_share_directory('lsc_pose_ros')) / 'config'
    arguments = {
        'config': (str(config / 'pose_node.yaml'), 'file of parameters'),
        'model': ('', 'model file; empty for what the file of parameters says'),
        'namespace': ('', 'namespace of the node'),
        **{name: (topic, f'topic to take {topic} from') for name, topic in TOPICS.items()},
    }
    profile = EnvironmentVariable(
        PROFILE_VARIABLE, default_value=str(config / 'fastdds_profile.xml')
    )
    return LaunchDescription(
        [
            *(
                DeclareLaunchArgument(name, default_value=default, description=meaning)
                for name, (default, meaning) in arguments.items()
            ),
            # It works where images are sent: a camera driver belongs into this launch, too, or
            # must be started with the same variable.
            SetEnvironmentVariable(PROFILE_VARIABLE, profile),
            OpaqueFunction(function=pose_node),
        ]
    )


def pose_node(context: LaunchContext) -> list[Node]:
    """Return the node, with the arguments' values put in."""
    value = {
        name: LaunchConfiguration(name).perform(context)
        for name in ('config', 'model', 'namespace', *TOPICS)
    }
    parameters: list[str | dict[str, str]] = [value['config']]
    if value['model']:
        parameters.append({'model': value['model']})
    return [
        Node(
            package='lsc_pose_ros',
            executable='pose_node',
            name='pose_node',
            namespace=value['namespace'],
            parameters=parameters,
            remappings=[(topic, value[name]) for name, topic in TOPICS.items()],
            output='screen',
        )
    ]
