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

"""What PyPI shows of the package, and what the source archive holds."""

import importlib.util
import re
import sys
import tarfile
import zipfile
from email.message import Message
from email.parser import Parser
from pathlib import Path

import pytest
from installed_program import run

import lsc_pose_ros

ROOT = Path(__file__).parents[2]
REPOSITORY = 'https://github.com/lsc-pose-ros/lsc_pose_ros'
RAW = REPOSITORY.replace('github.com', 'raw.githubusercontent.com')


@pytest.fixture(scope='module')
def metadata(wheel: zipfile.ZipFile) -> Message:
    name = f'lsc_pose_ros-{lsc_pose_ros.__version__}.dist-info/METADATA'
    return Parser().parsestr(wheel.read(name).decode())


def test_addresses_lead_to_files_of_the_repository(metadata: Message) -> None:
    lines = metadata.get_all('Project-URL', [])
    addresses = {name: address for name, _, address in (line.partition(', ') for line in lines)}
    assert set(addresses) == {'Documentation', 'Source', 'Issues', 'Changelog'}
    for address in addresses.values():
        assert address.startswith(REPOSITORY)
        _, found, path = address.partition('/blob/main/')
        assert not found or (ROOT / path).is_file(), address


def test_description_has_absolute_addresses_of_existing_files(metadata: Message) -> None:
    """PyPI shows the text of the README alone."""
    text = str(metadata.get_payload())
    pictures = re.findall(r'!\[[^]]+\]\(([^)]+)\)', text)
    assert pictures
    assert all(picture.startswith(f'{RAW}/main/docs/images/') for picture in pictures)
    links = [link for link in re.findall(r'\]\(([^)]+)\)', text) if not link.startswith('#')]
    assert len(links) > 20
    for link in links:
        assert link.startswith('https://'), link
        path = re.sub(r'#.*', '', link).rpartition('/main/')[2]
        assert (ROOT / path).exists(), link


def test_classifiers_name_the_tested_versions(metadata: Message) -> None:
    classifiers = metadata.get_all('Classifier', [])
    for minor in range(10, 15):
        assert f'Programming Language :: Python :: 3.{minor}' in classifiers
    assert metadata['Requires-Python'] == '>=3.10'
    assert metadata['License-File']
    # PyPI refuses a classifier of the licence beside its expression.
    assert not any(classifier.startswith('License') for classifier in classifiers)


def test_description_can_be_rendered(wheel_file: Path, source_archive: Path) -> None:
    if importlib.util.find_spec('twine') is None:
        pytest.skip('twine is not installed')
    said = run(
        sys.executable, '-m', 'twine', 'check', '--strict', wheel_file, source_archive,
        cwd=wheel_file.parent,
    )  # fmt: skip
    assert said.count('PASSED') == 2


def test_source_archive_has_what_a_build_and_a_reader_need(source_archive: Path) -> None:
    with tarfile.open(source_archive) as archive:
        names = {name.partition('/')[2] for name in archive.getnames()}
    documents = {'README.md', 'CHANGELOG.rst', 'CONTRIBUTING.md', 'SECURITY.md', 'LICENSE'}
    build = {'setup.py', 'setup.cfg', 'pyproject.toml', 'package.xml', 'MANIFEST.in'}
    assert documents | build <= names
    package = {
        path.relative_to(ROOT).as_posix()
        for folder in ('lsc_pose_ros', 'launch', 'resource')
        for path in (ROOT / folder).rglob('*')
        if path.is_file() and '__pycache__' not in path.parts
    }
    assert package <= names
    assert not any(name.startswith(('test/', 'experiments/')) for name in names)
