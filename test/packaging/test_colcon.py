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

"""`colcon build`, with copied and with linked files; `LSC_POSE_COLCON` may name the program."""

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from installed_program import check_installation, run


@pytest.fixture(scope='module')
def colcon() -> str:
    """Return the program colcon; skip if there is none."""
    program = shutil.which(os.environ.get('LSC_POSE_COLCON', 'colcon'))
    if program is None:
        pytest.skip('colcon is not installed; `make test` makes an environment with it')
    return str(Path(program).absolute())


@pytest.mark.parametrize('options', [[], ['--symlink-install']], ids=['copied', 'linked'])
def test_workspace(
    colcon: str,
    options: list[str],
    source: Path,
    make_environment: Callable[[Path], Path],
    tmp_path: Path,
) -> None:
    workspace = tmp_path / 'workspace'
    shutil.copytree(source, workspace / 'src/lsc_pose_ros')
    selected = ['--packages-select', 'lsc_pose_ros']
    run(colcon, 'build', *selected, *options, cwd=workspace)
    python = make_environment(tmp_path / 'environment')
    sourced = ['sh', '-c', '. install/local_setup.sh && exec "$0" "$@"', python]
    report = check_installation(*sourced, cwd=workspace)
    installed = workspace / 'install/lsc_pose_ros'
    assert Path(report['package']).is_relative_to(workspace if options else installed)
    assert report['joints'] == 20
    for name in ('lsc_pose', 'pose_node'):
        program = installed / 'lib/lsc_pose_ros' / name
        assert os.access(program, os.X_OK)
    version = run(*sourced, installed / 'lib/lsc_pose_ros/lsc_pose', '--version', cwd=workspace)
    assert version.startswith('lsc_pose ')
    assert_share(installed / 'share')


def assert_share(share: Path) -> None:
    """Check what ROS looks for: the package's marker, manifest, launch files and configuration."""
    assert (share / 'ament_index/resource_index/packages/lsc_pose_ros').is_file()
    for name in ('package.xml', 'launch/pose.launch.py', 'config/pose_node.yaml'):
        assert (share / 'lsc_pose_ros' / name).is_file()
