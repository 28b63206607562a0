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

"""What the package declares to pip, rosdep and ROS agrees with its sources."""

import ast
import configparser
import re
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import lsc_pose_ros

ROOT = Path(__file__).parents[2]

# What may be imported, besides the standard library: the name in setup.py (None: only ROS has
# it) and the rosdep key in package.xml (empty: there is none, and the package is optional).
DEPENDENCIES: dict[str, tuple[str | None, str]] = {
    'PIL': ('pillow', 'python3-pil'),
    'ament_index_python': (None, 'ament_index_python'),
    'argcomplete': ('argcomplete', ''),
    'builtin_interfaces': (None, 'builtin_interfaces'),
    'c3d': ('c3d', ''),
    'diagnostic_msgs': ('ros-jazzy-diagnostic-msgs', 'diagnostic_msgs'),
    'h5py': ('h5py', ''),
    'launch': (None, 'launch'),
    'launch_ros': (None, 'launch_ros'),
    'matplotlib': ('matplotlib', 'python3-matplotlib'),
    'mcap': ('mcap', 'mcap-ros2-support'),
    'numba': ('numba', 'python3-numba'),
    'numpy': ('numpy', 'python3-numpy'),
    'lifecycle_msgs': (None, 'lifecycle_msgs'),
    'pyarrow': ('pyarrow', ''),
    'rcl_interfaces': (None, 'rcl_interfaces'),
    'rclpy': ('ros-jazzy-rclpy', 'rclpy'),
    'rosbags': ('rosbags', 'python3-rosbags-pip'),
    'scipy': ('scipy', 'python3-scipy'),
    'rosgraph_msgs': (None, 'rosgraph_msgs'),
    'sensor_msgs': ('ros-jazzy-sensor-msgs', 'sensor_msgs'),
    'tf2_msgs': (None, 'tf2_msgs'),
    'tqdm': ('tqdm', 'python3-tqdm'),
    'visualization_msgs': ('ros-jazzy-visualization-msgs', 'visualization_msgs'),
    'yaml': ('pyyaml', 'python3-yaml'),
    'zstandard': ('zstandard', 'mcap-ros2-support'),
}

# Messages that are looked up when they are needed, by their package or the name of their type:
# stamps and durations, /diagnostics, `replay --publish --clock`, publish_tf.
IMPORTED_BY_NAME = {'builtin_interfaces', 'diagnostic_msgs', 'rosgraph_msgs', 'tf2_msgs'}


def imported_modules() -> set[str]:
    """Return the top-level names that the package and its launch files import."""
    names: set[str] = set()
    for path in [*(ROOT / 'lsc_pose_ros').rglob('*.py'), *(ROOT / 'launch').rglob('*.py')]:
        for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
            if isinstance(node, ast.Import):
                names.update(alias.name.partition('.')[0] for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names.add(node.module.partition('.')[0])
    return (names | IMPORTED_BY_NAME) - sys.stdlib_module_names - {'lsc_pose_ros'}


def package_xml() -> ET.Element:
    return ET.parse(ROOT / 'package.xml').getroot()  # noqa: S314 - our own file


def text_of(element: ET.Element, name: str) -> str:
    return (element.findtext(name) or '').strip()


def test_version_is_the_same_everywhere() -> None:
    setup = re.search(r"version='([^']+)'", (ROOT / 'setup.py').read_text(encoding='utf-8'))
    assert setup is not None
    assert setup.group(1) == lsc_pose_ros.__version__ == text_of(package_xml(), 'version')


def test_manifest_has_what_ros_needs() -> None:
    package = package_xml()
    assert package.get('format') == '3'
    assert text_of(package, 'name') == 'lsc_pose_ros'
    licenses = {element.text: element.get('file', '') for element in package.iter('license')}
    assert list(licenses) == ['Apache-2.0', 'CC0-1.0']
    assert all((ROOT / file).is_file() for file in licenses.values())
    assert {url.get('type') for url in package.iter('url')} == {
        'website',
        'repository',
        'bugtracker',
    }
    assert package.find('author') is not None
    assert text_of(package, 'export/build_type') == 'ament_python'
    assert (ROOT / 'resource' / 'lsc_pose_ros').is_file()
    scripts = configparser.ConfigParser()
    scripts.read(ROOT / 'setup.cfg')
    assert scripts['develop']['script_dir'] == '$base/lib/lsc_pose_ros'
    assert scripts['install']['install_scripts'] == '$base/lib/lsc_pose_ros'


def test_every_import_is_declared_to_pip_and_to_rosdep() -> None:
    imported = imported_modules()
    assert imported - set(DEPENDENCIES) == set()
    setup = (ROOT / 'setup.py').read_text(encoding='utf-8')
    keys = {text_of(depend, '.') for depend in package_xml() if depend.tag.endswith('depend')}
    for module in imported:
        requirement, key = DEPENDENCIES[module]
        assert requirement is None or re.search(rf"'{requirement}\b", setup), module
        assert not key or key in keys, module


def test_nothing_is_declared_that_is_not_imported() -> None:
    used = {DEPENDENCIES[module][1] for module in imported_modules()} - {''}
    declared = {text_of(depend, '.') for depend in package_xml().iter('exec_depend')}
    assert declared == used
