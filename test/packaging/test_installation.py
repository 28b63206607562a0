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

"""Each way to install the package: afterwards it finds its model, body and configuration."""

import os
import shutil
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from installed_program import ESTIMATE, check_installation, run

MakeEnvironment = Callable[[Path], Path]


def install(python: Path, options: list[str], *words: object, **variables: str) -> None:
    """Install with the pip that the environment of `python` sees."""
    # The package is installed again even if the system's Python already has it.
    pip = [python, '-m', 'pip', 'install', *options, '--ignore-installed']
    run(*pip, *words, cwd=python.parent, **variables)


def assert_complete(report: dict[str, Any], folder: Path) -> None:
    """Check that the package was imported from below `folder` and found its files."""
    assert Path(report['package']).is_relative_to(folder)
    assert report['joints'] == 20
    assert report['body'] > 1000
    assert report['parameters'] == ['/**']


def find_for_ros2_run(prefix: Path, program: str) -> Path:
    """Return the executable that `ros2 run` starts if `prefix` is in AMENT_PREFIX_PATH."""
    assert (prefix / 'share/ament_index/resource_index/packages/lsc_pose_ros').is_file()
    executable = prefix / 'lib/lsc_pose_ros' / program
    assert os.access(executable, os.X_OK)
    return executable


def test_from_the_sources(
    source: Path, pip_options: list[str], make_environment: MakeEnvironment, tmp_path: Path
) -> None:
    python = make_environment(tmp_path / 'environment')
    install(python, pip_options, source)
    assert_complete(check_installation(python, cwd=tmp_path), tmp_path / 'environment')
    version = run(python.with_name('lsc_pose'), '--version', cwd=tmp_path)
    assert version.startswith('lsc_pose ')
    assert (tmp_path / 'environment/share/lsc_pose_ros/config/pose_node.yaml').is_file()
    for name in ('lsc_pose', 'pose_node'):
        program = find_for_ros2_run(tmp_path / 'environment', name)
        assert run(program, '--version', cwd=tmp_path).startswith(f'{name} ')


def test_editable(
    source: Path, pip_options: list[str], make_environment: MakeEnvironment, tmp_path: Path
) -> None:
    python = make_environment(tmp_path / 'environment')
    install(python, pip_options, '--editable', source)
    assert_complete(check_installation(python, cwd=tmp_path), source)
    assert run(python.with_name('lsc_pose'), '--version', cwd=tmp_path)


def test_wheel_estimates_a_frame(
    wheel_file: Path, pip_options: list[str], make_environment: MakeEnvironment, tmp_path: Path
) -> None:
    python = make_environment(tmp_path / 'environment')
    install(python, pip_options, wheel_file)
    assert_complete(check_installation(python, cwd=tmp_path), tmp_path / 'environment')
    # Interpreted kernels: a small frame takes less time than the compiler would.
    found = run(python, '-c', ESTIMATE, cwd=tmp_path, NUMBA_DISABLE_JIT='1')
    assert found.split('\n')[0] == '(1, 20, 3) True'


def test_below_a_prefix(
    wheel_file: Path, pip_options: list[str], make_environment: MakeEnvironment, tmp_path: Path
) -> None:
    python = make_environment(tmp_path / 'environment')
    prefix = tmp_path / 'prefix'
    install(python, pip_options, '--prefix', prefix, wheel_file)
    (packages,) = prefix.glob('l*/python*/*-packages')
    report = check_installation(python, cwd=tmp_path, PYTHONPATH=str(packages))
    assert_complete(report, prefix)
    assert (prefix / 'bin/lsc_pose').is_file()
    assert (prefix / 'share/lsc_pose_ros/config/pose_node.yaml').is_file()


def test_for_one_user(
    wheel_file: Path, pip_options: list[str], make_environment: MakeEnvironment, tmp_path: Path
) -> None:
    python = make_environment(tmp_path / 'environment')
    home = {'PYTHONUSERBASE': str(tmp_path / 'home')}
    install(python, pip_options, '--user', wheel_file, **home)
    assert_complete(check_installation(python, cwd=tmp_path, **home), tmp_path / 'home')


def test_into_a_folder(
    wheel_file: Path, pip_options: list[str], make_environment: MakeEnvironment, tmp_path: Path
) -> None:
    python = make_environment(tmp_path / 'environment')
    target = tmp_path / 'target'
    install(python, pip_options, '--target', target, wheel_file)
    report = check_installation(python, cwd=tmp_path, PYTHONPATH=str(target))
    assert_complete(report, target)


def test_source_archive_gives_the_same_wheel(
    source_archive: Path, wheel: zipfile.ZipFile, pip_options: list[str], tmp_path: Path
) -> None:
    shutil.unpack_archive(source_archive, tmp_path)
    unpacked = tmp_path / source_archive.name.removesuffix('.tar.gz')
    pip = [sys.executable, '-m', 'pip', 'wheel', *pip_options]
    run(*pip, '--wheel-dir', tmp_path, unpacked, cwd=tmp_path)
    (again,) = tmp_path.glob('*.whl')
    assert sorted(zipfile.ZipFile(again).namelist()) == sorted(wheel.namelist())


def test_wheel_makes_a_recording_and_evaluates_its_model(
    wheel_file: Path, pip_options: list[str], make_environment: MakeEnvironment, tmp_path: Path
) -> None:
    python = make_environment(tmp_path / 'environment')
    install(python, pip_options, wheel_file)
    lsc_pose = python.with_name('lsc_pose')
    version = wheel_file.name.split('-')[1]
    assert run(lsc_pose, '--version', cwd=tmp_path).split() == ['lsc_pose', version]
    # Interpreted kernels: a small frame takes less time than the compiler would.
    words = ('people.mcap', '--frames', '1', '--size', '80x60', '--distance', '2', '3')
    run(lsc_pose, 'synth', *words, cwd=tmp_path, NUMBA_DISABLE_JIT='1')
    report = tmp_path / 'report'
    evaluate = ('evaluate', 'people.mcap', '--report', report)
    found = run(lsc_pose, *evaluate, cwd=tmp_path, NUMBA_DISABLE_JIT='1')
    assert '1 frames' in found
    assert f'lsc_pose_ros {version}' in (report / 'index.html').read_text(encoding='utf-8')
