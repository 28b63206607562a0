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

"""Builds a Python package of ROS messages from their definitions, with what the middleware needs.

rosidl, which comes with rclpy's wheels and with each ROS, generates the code; the compiler of
this computer compiles it. So the package works like an installed one.
"""

import inspect
import shutil
import subprocess
import sysconfig
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rclpy

DEFINITIONS = Path(__file__).parent / 'hri_definitions'
"""The messages of the package hri_msgs that the node publishes, without the comments."""

_DEPENDENCIES = ('std_msgs', 'builtin_interfaces')

# The generators, and the library that each one's code makes. The middleware looks for these names.
_GENERATORS = {
    'rosidl_generator_c.cli.GenerateC': 'rosidl_generator_c',
    'rosidl_typesupport_fastrtps_c.cli.GenerateFastRTPSCTypesupport': (
        'rosidl_typesupport_fastrtps_c'
    ),
    'rosidl_typesupport_introspection_c.cli.GenerateIntrospectionCTypesupport': (
        'rosidl_typesupport_introspection_c'
    ),
    'rosidl_typesupport_c.cli.GenerateCTypesupport': 'rosidl_typesupport_c',
    'rosidl_generator_py.cli.GeneratePython': 'python',
}
_OPTIONS: dict[str, list[str]] = {
    'rosidl_typesupport_c': [
        'rosidl_typesupport_fastrtps_c',
        'rosidl_typesupport_introspection_c',
    ],
    'python': ['rosidl_typesupport_c'],
}


def build_message_package(package: str, definitions: Path, target: Path) -> None:
    """Build the Python package `package`, with all files *.msg of a folder, in `target`.

    It skips the test if this computer has no compiler.
    """
    if shutil.which('g++') is None:
        pytest.skip('there is no g++, which compiles the messages')
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv('AMENT_PREFIX_PATH', str(_prefix()))
        generated = _generate(package, definitions, target / 'generated')
    shutil.copytree(
        generated['python'] / package, target / package, ignore=shutil.ignore_patterns('*.c')
    )
    (target / package / '__init__.py').touch()
    _compile(package, generated, target / package)


def _prefix() -> Path:
    """Return the folder of the installation of ROS, with include, lib and share."""
    folders = Path(rclpy.__file__).parents
    return next(each for each in (folders[1], folders[4]) if (each / 'share/std_msgs').is_dir())


def _generate(package: str, definitions: Path, target: Path) -> dict[str, Path]:
    """Generate the code; return the folder of each library's code."""
    convert = _find('rosidl_adapter.msg.convert_msg_to_idl')
    interfaces: list[str] = []
    folder = target / 'idl' / package
    (folder / 'msg').mkdir(parents=True)
    for file in sorted(definitions.glob('*.msg')):
        convert(definitions, package, file.relative_to(definitions), folder / 'msg')
        interfaces.append(f'{folder}:msg/{file.stem}.idl')
    shared = [str(_prefix() / 'share')]
    hashes = _find('rosidl_generator_type_description.cli.HashTypeDescription')('hash')
    descriptions = hashes.generate_type_hashes(package, interfaces, shared, folder)
    folders: dict[str, Path] = {}
    for path, library in _GENERATORS.items():
        options = {'typesupport_implementations': _OPTIONS[library]} if library in _OPTIONS else {}
        generate = _find(path)(library, **options).generate
        arguments: dict[str, Any] = {'output_path': target / library / package}
        if 'type_description_files' in inspect.signature(generate).parameters:
            arguments['type_description_files'] = [str(each) for each in descriptions]
        generate(package, interfaces, shared, **arguments)
        folders[library] = target / library
    return folders


def _find(path: str) -> Any:
    """Return the object with this path; skip the test where rosidl is not installed."""
    module, _, name = path.rpartition('.')
    return getattr(pytest.importorskip(module, reason='rosidl is not installed'), name)


def _compile(package: str, generated: dict[str, Path], target: Path) -> None:
    """Compile the libraries; each finds those before it in its own folder."""
    root = _prefix() / 'include'
    includes = [
        *generated.values(), root, *root.iterdir(), sysconfig.get_path('include'),
        np.get_include(),
    ]  # fmt: skip
    libraries = [
        *(
            f'{dependency}__{library}'
            for dependency in _DEPENDENCIES
            for library in (*generated, 'rosidl_generator_py')
            if library != 'python'
        ),
        'rosidl_runtime_c', 'rosidl_typesupport_c', 'rosidl_typesupport_fastrtps_c',
        'rosidl_typesupport_fastrtps_cpp', 'rosidl_typesupport_introspection_c', 'rcutils',
        'fastcdr',
    ]  # fmt: skip
    for library, folder in generated.items():
        name = f'{package}__{library}'
        file = f'lib{name}.so'
        if library == 'python':
            suffix = sysconfig.get_config_var('EXT_SUFFIX')
            file = f'{package}_s__rosidl_typesupport_c{suffix}'
        objects = _compile_sources(folder, includes)
        words = ['g++', '-shared', '-Wl,--no-as-needed,-rpath,$ORIGIN', f'-Wl,-soname,{file}']
        words += ['-o', str(target / file), *objects, f'-L{target}', f'-L{_prefix() / "lib"}']
        subprocess.run([*words, *(f'-l{each}' for each in libraries)], check=True)
        libraries.append(name)


def _compile_sources(folder: Path, includes: list[Any]) -> list[str]:
    objects: list[str] = []
    words = ['-c', '-fPIC', '-O0', '-w', *(f'-I{each}' for each in includes)]
    for compiler, pattern in (('gcc', '*.c'), ('g++', '*.cpp')):
        sources = [str(each) for each in folder.rglob(pattern)]
        if sources:
            subprocess.run([compiler, *words, *sources], check=True, cwd=folder)
            objects += [str(folder / Path(each).with_suffix('.o').name) for each in sources]
    return objects


@pytest.fixture(scope='session')
def hri_packages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the package hri_msgs, built for this test run."""
    folder = tmp_path_factory.mktemp('hri')
    build_message_package('hri_msgs', DEFINITIONS, folder)
    return folder
