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

"""What the tests of installation share: a copy of the sources, its wheel, fresh environments."""

import importlib.metadata
import re
import shutil
import sys
import venv
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from installed_program import run

ROOT = Path(__file__).parents[2]

_FOLDERS = ('lsc_pose_ros', 'launch', 'resource', 'test', 'experiments', 'benchmarks')
_FILES = (
    *('setup.py', 'setup.cfg', 'pyproject.toml', 'MANIFEST.in', 'package.xml', 'LICENSE'),
    *('README.md', 'CHANGELOG.rst', 'CONTRIBUTING.md', 'SECURITY.md'),
)


def find_version(distribution: str) -> tuple[int, ...]:
    """Return the first two numbers of the installed version, or () if it is not installed."""
    try:
        version = importlib.metadata.version(distribution)
    except importlib.metadata.PackageNotFoundError:
        return ()
    return tuple(int(number) for number in re.findall(r'\d+', version)[:2])


@pytest.fixture(scope='session')
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of the sources, so that no build leaves anything in the repository."""
    folder = tmp_path_factory.mktemp('source') / 'lsc_pose_ros'
    ignore = shutil.ignore_patterns('__pycache__', '*.egg-info')
    for name in _FOLDERS:
        shutil.copytree(ROOT / name, folder / name, ignore=ignore)
    for name in _FILES:
        shutil.copy(ROOT / name, folder)
    return folder


@pytest.fixture(scope='session')
def pip_options() -> list[str]:
    """Return the options with which pip needs no network; skip if it cannot build wheels."""
    versions = {name: find_version(name) for name in ('pip', 'setuptools', 'wheel')}
    if not versions['pip'] or versions['setuptools'] < (64,):
        pytest.skip('pip and setuptools 64 or newer are not both installed')
    if versions['setuptools'] < (70, 1) and not versions['wheel']:
        pytest.skip('setuptools before 70.1 makes wheels only with the package wheel')
    return ['--isolated', '--quiet', '--no-deps', '--no-build-isolation', '--no-index']


@pytest.fixture(scope='session')
def dependencies(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with links to all that is installed here, except this package."""
    folder = tmp_path_factory.mktemp('dependencies')
    for place in map(Path, sys.path):
        if place.name not in {'site-packages', 'dist-packages'} or not place.is_dir():
            continue
        for entry in place.iterdir():
            link = folder / entry.name
            ours = entry.name.startswith(('lsc_pose', '__editable__'))
            if not ours and entry.suffix != '.pth' and not link.exists():
                link.symlink_to(entry)
    return folder


@pytest.fixture(scope='session')
def make_environment(dependencies: Path) -> Callable[[Path], Path]:
    """Return a function that makes a virtual environment and returns its interpreter.

    The environment has the dependencies, and not the package.
    """

    def make(folder: Path) -> Path:
        venv.create(folder, system_site_packages=True, symlinks=True)
        version = f'python{sys.version_info.major}.{sys.version_info.minor}'
        site_packages = folder / 'lib' / version / 'site-packages'
        (site_packages / 'dependencies.pth').write_text(f'{dependencies}\n')
        return folder / 'bin' / 'python'

    return make


@pytest.fixture(scope='session')
def wheel_file(
    source: Path, pip_options: list[str], tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """Return the wheel that pip builds from the sources."""
    target = tmp_path_factory.mktemp('wheel')
    pip = [sys.executable, '-m', 'pip', 'wheel', *pip_options]
    run(*pip, '--wheel-dir', target, source, cwd=target)
    (path,) = target.glob('*.whl')
    return path


@pytest.fixture(scope='session')
def source_archive(
    source: Path, pip_options: list[str], tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """Return the source archive."""
    assert '--no-build-isolation' in pip_options  # the setuptools of this environment is used
    folder = tmp_path_factory.mktemp('archive')
    build = f'from setuptools import build_meta; build_meta.build_sdist({str(folder)!r})'
    run(sys.executable, '-c', build, cwd=source)
    (path,) = folder.glob('*.tar.gz')
    return path


@pytest.fixture(scope='session')
def wheel(wheel_file: Path) -> zipfile.ZipFile:
    """Return the wheel as an archive."""
    return zipfile.ZipFile(wheel_file)
