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

"""The launch file, run on stand-ins (the wheels have no launch), and the files that it reads."""

import importlib.util
import json
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
import yaml

from lsc_pose_ros.resources.package_files import resource
from lsc_pose_ros.settings.table import SETTINGS

ROOT = Path(__file__).resolve().parents[2]
FILE = ROOT / 'launch' / 'pose.launch.py'
SOURCES = ROOT / 'lsc_pose_ros' / 'ros'
CONFIG = ROOT / 'config'

CAMERAS = ('azure', 'kinect', 'none', 'orbbec', 'realsense', 'zed')
TAKEN = {'depth/image', 'depth/camera_info', 'mask'}

# Where the drivers publish, to be sure that no file is changed by accident.
DEPTH_TOPICS = {
    'azure': '/depth/image_raw',
    'kinect': '/kinect/depth/image_raw',
    'none': 'depth/image',
    'orbbec': '/camera/depth/image_raw',
    'realsense': '/camera/camera/depth/image_rect_raw',
    'zed': '/zed/zed_node/depth/depth_registered',
}


class Made:
    """Whatever the launch file makes: its arguments, for the test to look at."""

    def __init__(self, *words: Any, **named: Any) -> None:
        self.words = words
        self.named = named


class Argument(Made):
    """A LaunchConfiguration: its value comes from the context."""

    def perform(self, context: dict[str, str]) -> str:
        return context[self.words[0]]


class PackageNotFoundError(KeyError):
    """The error of ament_index_python."""


def prefix_without_rviz(package: str) -> str:
    raise PackageNotFoundError(package)


STAND_INS: dict[str, dict[str, Any]] = {
    'ament_index_python': {},
    'ament_index_python.packages': {
        'PackageNotFoundError': PackageNotFoundError,
        'get_package_prefix': lambda _package: '/opt/ros',
        'get_package_share_directory': lambda _package: str(ROOT),
    },
    'launch': {'LaunchContext': dict, 'LaunchDescription': list},
    'launch.actions': dict.fromkeys(
        (
            'DeclareLaunchArgument',
            'OpaqueFunction',
            'RegisterEventHandler',
            'SetEnvironmentVariable',
        ),
        Made,
    ),
    'launch.event_handlers': {'OnProcessExit': Made},
    'launch.events': {},
    'launch.events.process': {'ProcessExited': Made},
    'launch.substitutions': {'EnvironmentVariable': Made, 'LaunchConfiguration': Argument},
    'launch_ros': {},
    'launch_ros.actions': {'Node': Made},
    'launch_ros.parameter_descriptions': {'ParameterValue': Made},
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


def actions(launch_file: ModuleType, **given: str) -> list[Made]:
    """What the launch file starts, where the user gives some arguments."""
    description = launch_file.generate_launch_description()
    declared = [each for each in description if 'default_value' in each.named]
    values = {each.words[0]: each.named['default_value'] for each in declared}
    assert given.keys() <= values.keys()
    function = next(each.named['function'] for each in description if 'function' in each.named)
    return function(values | given)


def started(launch_file: ModuleType, **given: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """What the node and RViz are started with, where the user gives some arguments."""
    _handler, node, rviz = actions(launch_file, **{'rviz': 'true'} | given)
    return node.named, rviz.named


def set_in(node: dict[str, Any]) -> dict[str, Any]:
    """The parameters that the node gets besides the file."""
    _file, *rest = node['parameters']
    assert len(rest) <= 1
    return {
        name: value.words[0] if isinstance(value, Made) else value
        for parameters in rest
        for name, value in parameters.items()
    }


def presets() -> dict[str, dict[str, Any]]:
    return {
        path.stem: yaml.safe_load(path.read_text(encoding='utf-8'))
        for path in (CONFIG / 'cameras').iterdir()
    }


def values_in(tree: object) -> Iterator[object]:
    """All keys and values of nested lists and dictionaries."""
    if isinstance(tree, dict):
        for key, value in tree.items():
            yield key
            yield from values_in(value)
    elif isinstance(tree, list):
        for value in tree:
            yield from values_in(value)
    else:
        yield tree


def test_node_is_started_with_the_documented_parameters(launch_file: ModuleType) -> None:
    node, _ = started(launch_file)
    assert (node['package'], node['executable']) == ('lsc_pose_ros', 'pose_node')
    assert node['parameters'] == [str(CONFIG / 'pose_node.yaml')]


def test_model_of_the_command_line_comes_after_the_file(
    launch_file: ModuleType, tmp_path: Path
) -> None:
    mine = tmp_path / 'mine.yaml'
    mine.touch()
    node, _ = started(launch_file, config=str(mine), model='2024')
    assert node['parameters'][0] == str(mine)
    assert set_in(node) == {'model': '2024'}
    # Else launch makes a number of it.
    assert node['parameters'][1]['model'].named == {'value_type': str}


def test_without_a_preset_the_node_listens_to_its_own_names(launch_file: ModuleType) -> None:
    node, _ = started(launch_file)
    assert all(name == target for name, target in node['remappings'])


def test_topics_are_remapped_from_what_the_node_listens_to(launch_file: ModuleType) -> None:
    node, _ = started(launch_file, depth_image='/k/z', camera_info='/k/info', mask='/who')
    assert dict(node['remappings']) == {
        'depth/image': '/k/z',
        'depth/camera_info': '/k/info',
        'mask': '/who',
    }
    source = (SOURCES / 'io' / 'inputs.py').read_text(encoding='utf-8')
    assert all(f"'{topic}'" in source for topic in TAKEN)


@pytest.mark.parametrize('camera', CAMERAS)
def test_preset_connects_the_camera(launch_file: ModuleType, camera: str) -> None:
    node, rviz = started(launch_file, camera=camera)
    preset = presets()[camera]
    remapped = dict(node['remappings'])
    assert remapped.items() >= preset['topics'].items()
    assert remapped['depth/image'] == DEPTH_TOPICS[camera]
    assert set_in(node) == preset['parameters']
    assert rviz['arguments'] == ['-d', str(CONFIG / 'lsc_pose.rviz'), '-f', preset['frame']]


def test_azure_kinect_brings_its_own_mask(launch_file: ModuleType) -> None:
    node, _ = started(launch_file, camera='azure')
    assert dict(node['remappings'])['mask'] == '/body_index_map/image_raw'
    assert set_in(node)['mask_background'] == 255
    assert set_in(node)['segmentation'] == 'mask'


def test_mask_that_is_named_is_used(launch_file: ModuleType) -> None:
    node, _ = started(launch_file, camera='realsense')
    assert set_in(node)['segmentation'] == 'auto'
    node, _ = started(launch_file, camera='realsense', mask='/people')
    assert set_in(node)['segmentation'] == 'mask'
    assert dict(node['remappings'])['mask'] == '/people'
    node, _ = started(launch_file, camera='zed', mask='/people', segmentation='background')
    assert set_in(node)['segmentation'] == 'background'


def test_command_line_wins_over_the_preset(launch_file: ModuleType) -> None:
    node, rviz = started(
        launch_file,
        camera='zed',
        depth_image='/left/depth',
        depth_transport='compressedDepth',
        model='m.npz',
        frame='left',
    )
    assert dict(node['remappings'])['depth/image'] == '/left/depth'
    assert dict(node['remappings'])['depth/camera_info'] == '/zed/zed_node/depth/camera_info'
    assert set_in(node) == {
        'depth_transport': 'compressedDepth',
        'model': 'm.npz',
        'segmentation': 'auto',
    }
    assert rviz['arguments'][-1] == 'left'


@pytest.mark.parametrize(
    ('word', 'starts'),
    [
        ('true', True),
        ('True', True),
        ('1', True),
        ('false', False),
        ('FALSE', False),
        ('0', False),
    ],
)
def test_rviz_starts_only_if_it_is_asked_for(
    launch_file: ModuleType, word: str, *, starts: bool
) -> None:
    executables = [each.named.get('executable') for each in actions(launch_file, rviz=word)]
    assert executables == [None, 'pose_node', *(['rviz2'] if starts else [])]


def test_rviz_is_not_started_by_default(launch_file: ModuleType) -> None:
    assert len(actions(launch_file)) == 2


@pytest.mark.parametrize(
    ('name', 'value'),
    [
        ('rviz', 'yes'),
        ('rviz', ''),
        ('smoothing', 'on'),
        ('publish_tf', '2'),
        ('publish_ros4hri', 'yes'),
        ('use_sim_time', 'sometimes'),
        ('segmentation', 'guess'),
        ('rectified', 'True'),
        ('camera_roll', '45'),
        ('depth_transport', 'theora'),
        ('mask_transport', 'compressedDepth'),
        ('reliability', 'certain'),
        ('config', '/nowhere/mine.yaml'),
        ('config', '/'),
    ],
)
def test_bad_argument_is_named_before_anything_starts(
    launch_file: ModuleType, name: str, value: str
) -> None:
    with pytest.raises(ValueError, match=f'^{name}:={value}: '):
        actions(launch_file, **{name: value})


def test_rviz_that_is_not_installed_is_named_before_anything_starts(
    launch_file: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(launch_file, 'get_package_prefix', prefix_without_rviz)
    with pytest.raises(ValueError, match='rviz2, which is not installed'):
        actions(launch_file, rviz='true')
    assert len(actions(launch_file)) == 2


def test_arguments_set_the_parameters_of_the_node(launch_file: ModuleType) -> None:
    texts = {
        'model': 'front',
        'segmentation': 'background',
        'rectified': 'true',
        'camera_roll': '90',
        'depth_transport': 'compressedDepth',
        'mask_transport': 'compressed',
        'reliability': 'best_effort',
    }
    words = {'smoothing': 'true', 'publish_tf': '1', 'publish_ros4hri': 'True'}
    node, _ = started(launch_file, **texts, **words, use_sim_time='False')
    booleans = {'smoothing': True, 'publish_tf': True, 'publish_ros4hri': True}
    booleans |= {'use_sim_time': False}
    assert set_in(node) == texts | booleans


def test_values_of_the_arguments_are_those_of_the_parameters(launch_file: ModuleType) -> None:
    for name, values in launch_file.PARAMETERS.items():
        if name == 'use_sim_time' or isinstance(SETTINGS[name].default, bool):
            assert values == launch_file.BOOLEAN, name
        else:
            assert set(values) == set(SETTINGS[name].choices), name


def test_launch_fails_if_the_node_fails(launch_file: ModuleType) -> None:
    handler, node = actions(launch_file)
    (on_exit,) = handler.words
    assert on_exit.named['target_action'] is node
    check = on_exit.named['on_exit']
    running, ending = SimpleNamespace(is_shutdown=False), SimpleNamespace(is_shutdown=True)
    check(SimpleNamespace(returncode=0), running)
    # While a launch ends, it kills processes that are slow to end.
    check(SimpleNamespace(returncode=-9), ending)
    for status in (1, 2, -11):
        with pytest.raises(RuntimeError, match=f'pose_node failed with exit status {status}'):
            check(SimpleNamespace(returncode=status), running)


def test_rviz_shows_the_topics_that_the_node_has(launch_file: ModuleType) -> None:
    _, rviz = started(launch_file, camera='azure', namespace='robot', mask='people')
    shown = dict(rviz['remappings'])
    assert shown['/depth/image'] == '/depth/image_raw'
    assert shown['/mask'] == '/robot/people'
    assert shown['/pose_node/skeletons'] == '/robot/pose_node/skeletons'
    assert shown['/pose_node/joint_markers'] == '/robot/pose_node/joint_markers'
    _, rviz = started(launch_file)
    assert all(name == target for name, target in rviz['remappings'])


def test_cameras_to_choose_from_are_the_files(launch_file: ModuleType) -> None:
    description = launch_file.generate_launch_description()
    (camera,) = (each for each in description if each.words == ('camera',))
    assert tuple(camera.named['choices']) == CAMERAS
    assert camera.named['default_value'] == 'none'


def test_images_use_the_profile_unless_the_user_has_another(launch_file: ModuleType) -> None:
    description = launch_file.generate_launch_description()
    (name, value) = next(each.words for each in description if len(each.words) == 2)
    assert name == 'FASTRTPS_DEFAULT_PROFILES_FILE'
    assert value.words == (name,)
    assert value.named['default_value'] == str(CONFIG / 'fastdds_profile.xml')


@pytest.mark.parametrize('camera', CAMERAS)
def test_preset_names_topics_of_the_node_and_its_source(camera: str) -> None:
    path = CONFIG / 'cameras' / f'{camera}.yaml'
    text = path.read_text(encoding='utf-8')
    preset = presets()[camera]
    assert preset.keys() == {'frame', 'topics', 'parameters'}
    assert {'depth/image', 'depth/camera_info'} <= preset['topics'].keys() <= TAKEN
    if camera == 'none':
        return
    assert all(topic.startswith('/') for topic in preset['topics'].values())
    # Without a mask the node must know another way.
    has_mask = 'mask' in preset['topics']
    assert preset['parameters']['segmentation'] == ('mask' if has_mask else 'auto')
    assert re.search(r'^# Topics, .*\n?.*https://', text, re.MULTILINE)
    assert f'pose.launch.py camera:={camera}' in text
    assert re.search(r'^#     ros2 (launch|run) (?!lsc_pose_ros)', text, re.MULTILINE)


@pytest.mark.parametrize('name', ['lsc_pose.rviz', 'foxglove_layout.json'])
def test_views_show_all_that_the_node_takes_and_gives(name: str) -> None:
    text = (CONFIG / name).read_text(encoding='utf-8')
    tree = json.loads(text) if name.endswith('json') else yaml.safe_load(text)
    named = {value for value in values_in(tree) if isinstance(value, str)}
    outputs = (SOURCES / 'io' / 'outputs.py').read_text(encoding='utf-8')
    given = set(re.findall(r"'~/(\w+)'", outputs))
    assert given == {'skeletons', 'joint_markers'}
    assert {f'/pose_node/{topic}' for topic in given} | {'/depth/image', '/mask'} <= named


def test_foxglove_layout_places_every_panel_once() -> None:
    tree = json.loads((CONFIG / 'foxglove_layout.json').read_text(encoding='utf-8'))

    def panels(place: object) -> Iterator[str]:
        if isinstance(place, str):
            yield place
        else:
            assert place['direction'] in {'row', 'column'}
            yield from panels(place['first'])
            yield from panels(place['second'])

    placed = list(panels(tree['layout']))
    assert sorted(placed) == sorted(tree['configById'])
    assert {panel.partition('!')[0] for panel in placed} == {
        '3D', 'Image', 'DiagnosticSummary', 'DiagnosticStatusPanel',
    }  # fmt: skip
    diagnostics = (SOURCES / 'health' / 'diagnostics.py').read_text(encoding='utf-8')
    status = tree['configById']['DiagnosticStatusPanel!pose_node']
    assert f"'{status['topicToRender']}'" in diagnostics
    assert status['selectedName'].removeprefix('pose_node: ') in diagnostics


def test_files_are_found_where_the_package_is_installed() -> None:
    for parts in (('cameras', 'azure.yaml'), ('lsc_pose.rviz',), ('foxglove_layout.json',)):
        assert resource('config', *parts).is_file()
