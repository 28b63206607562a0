"""The launch file, run on stand-ins: the wheels have no launch."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from lsc_pose_ros.resources import resource

FILE = Path(__file__).resolve().parents[2] / 'launch' / 'pose.launch.py'
SOURCES = Path(__file__).resolve().parents[2] / 'lsc_pose_ros' / 'ros'


class Made:
    """Whatever the launch file makes: its arguments, for the test to look at."""

    def __init__(self, *words: Any, **named: Any) -> None:
        self.words = words
        self.named = named


class Argument(Made):
    """A LaunchConfiguration: its value comes from the context."""

    def perform(self, context: dict[str, str]) -> str:
        return context[self.words[0]]


STAND_INS: dict[str, dict[str, Any]] = {
    'ament_index_python': {},
    'ament_index_python.packages': {
        'get_package_share_directory': lambda _package: str(resource('config').parent)
    },
    'launch': {'LaunchContext': dict, 'LaunchDescription': list},
    'launch.actions': dict.fromkeys(
        ('DeclareLaunchArgument', 'OpaqueFunction', 'SetEnvironmentVariable'), Made
    ),
    'launch.substitutions': {'EnvironmentVariable': Made, 'LaunchConfiguration': Argument},
    'launch_ros': {},
    'launch_ros.actions': {'Node': Made},
}


@pytest.fixture
def launch_file(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    for name, contents in STAND_INS.items():
        module = ModuleType(name)
        module.__dict__.update(contents)
        monkeypatch.setitem(sys.modules, name, module)
    spec = importlib.util.spec_from_file_location('pose_launch', FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def started(launch_file: ModuleType, **given: str) -> dict[str, Any]:
    """What the node is started with, where the user gives some arguments."""
    description = launch_file.generate_launch_description()
    declared = [each for each in description if 'default_value' in each.named]
    values = {each.words[0]: each.named['default_value'] for each in declared}
    function = next(each.named['function'] for each in description if 'function' in each.named)
    (node,) = function(values | given)
    return node.named


def test_node_is_started_with_the_documented_parameters(launch_file: ModuleType) -> None:
    node = started(launch_file)
    assert (node['package'], node['executable']) == ('lsc_pose_ros', 'pose_node')
    assert node['parameters'] == [str(resource('config', 'pose_node.yaml'))]


def test_model_of_the_command_line_comes_after_the_file(launch_file: ModuleType) -> None:
    node = started(launch_file, config='mine.yaml', model='me.npz')
    assert node['parameters'] == ['mine.yaml', {'model': 'me.npz'}]


def test_topics_are_remapped_from_what_the_node_listens_to(launch_file: ModuleType) -> None:
    node = started(launch_file, depth_image='/k/z', camera_info='/k/info', mask='/who')
    remapped = dict(node['remappings'])
    assert remapped == {'depth/image': '/k/z', 'depth/camera_info': '/k/info', 'mask': '/who'}
    source = (SOURCES / 'inputs.py').read_text()
    assert all(f"'{topic}'" in source for topic in remapped)


def test_images_use_the_profile_unless_the_user_has_another(launch_file: ModuleType) -> None:
    description = launch_file.generate_launch_description()
    (name, value) = next(each.words for each in description if len(each.words) == 2)
    assert name == 'FASTRTPS_DEFAULT_PROFILES_FILE'
    assert value.words == (name,)
    assert value.named['default_value'] == str(resource('config', 'fastdds_profile.xml'))
