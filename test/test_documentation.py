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

"""The documents: their links, the size of the README, and the options that they name."""

import argparse
import re
from functools import cache
from pathlib import Path

import pytest

from lsc_pose_ros.cli.main import COMMANDS, load

ROOT = Path(__file__).parents[1]
DOCS = sorted((ROOT / 'docs').glob('*.md'))
RELIABILITY = ROOT / 'docs' / 'reliability.md'
PAGES_OF_FOLDERS = [
    ROOT / 'models' / 'README.md',
    ROOT / 'benchmarks' / 'README.md',
    ROOT / 'lsc_pose_ros' / 'resources' / 'bodies' / 'README.md',
]
DOCUMENTS = [*sorted(ROOT.glob('*.md')), *DOCS, *PAGES_OF_FOLDERS]

# Options of other programs that the documents name.
OTHER_OPTIONS = {
    '--break-system-packages',
    '--child-frame-id',
    '--clock',
    '--delay',
    '--draw',
    '--frame-id',
    '--from-paths',
    '--ignore-src',
    '--memory',
    '--no-deps',
    '--packages-select',
    '--params-file',
    '--rate',
    '--real',
    '--ros-args',
    '--seconds',
    '--share',
    '--show-args',
    '--size',
    '--skip-keys',
    '--user',
}

# Names of other programs that the pages mention.
OTHER_NAMES = {
    'depth_image_proc',
    'fix_depth_scale',
    'image_proc',
    'node_names',
    'robot_state_publisher',
    'rqt_robot_monitor',
}


def name_of(document: Path) -> str:
    return str(document.relative_to(ROOT))


def text_of(document: Path) -> str:
    return document.read_text(encoding='utf-8')


@cache
def anchors_of(document: Path) -> set[str]:
    """Return the anchors of the headings in a document, as GitHub forms them."""
    prose = re.sub(r'^```.*?^```', '', text_of(document), flags=re.MULTILINE | re.DOTALL)
    headings = re.findall(r'^#+ (.+)$', prose, re.MULTILINE)
    plain = [re.sub(r'\[([^]]*)\]\([^)]*\)', r'\1', heading).lower() for heading in headings]
    return {re.sub(r'[^\w\- ]', '', heading.strip()).replace(' ', '-') for heading in plain}


def links_of(document: Path) -> list[str]:
    return re.findall(r'\]\(([^)\s]+)\)', text_of(document))


def options_of_the_commands() -> set[str]:
    """Return the options of all commands of `lsc_pose`."""
    options = {'--help', '--version', '--quiet', '--verbose'}
    for command in COMMANDS.values():
        parser = argparse.ArgumentParser()
        load(command).add_arguments(parser)
        parsers = [parser]
        while parsers:
            for action in parsers.pop()._actions:
                options |= set(action.option_strings)
                if isinstance(action, argparse._SubParsersAction):
                    parsers.extend(action.choices.values())
    return options


@cache
def words_of_the_sources() -> set[str]:
    """Return the identifiers in the sources of the package and of the programs."""
    sources = [
        *(ROOT / 'lsc_pose_ros').rglob('*.py'),
        *(ROOT / 'lsc_pose_ros').rglob('*.yaml'),
        *(ROOT / 'experiments').rglob('*.py'),
        *(ROOT / 'benchmarks').glob('*.py'),
    ]
    return {word for source in sources for word in re.findall(r'\w+', text_of(source))}


def test_readme_has_at_most_150_lines() -> None:
    assert len(text_of(ROOT / 'README.md').splitlines()) <= 150


@pytest.mark.parametrize('document', DOCUMENTS, ids=name_of)
def test_links_lead_somewhere(document: Path) -> None:
    for link in links_of(document):
        if '://' in link:
            continue
        path, _, anchor = link.partition('#')
        target = (document.parent / path).resolve() if path else document
        assert target.exists(), link
        if anchor and target.suffix == '.md':
            assert anchor in anchors_of(target), link


def test_index_lists_every_page() -> None:
    index = ROOT / 'docs' / 'README.md'
    listed = {(index.parent / link).resolve() for link in links_of(index)}
    assert {page.resolve() for page in DOCS if page != index} <= listed


# CONTRIBUTING.md names the options of many other programs.
@pytest.mark.parametrize('document', [ROOT / 'README.md', *DOCS, *PAGES_OF_FOLDERS], ids=name_of)
def test_options_that_are_named_exist(document: Path) -> None:
    named = set(re.findall(r'(?<![\w-])--[a-z][a-z-]+', text_of(document)))
    assert named - options_of_the_commands() - OTHER_OPTIONS == set()


@pytest.mark.parametrize('document', DOCUMENTS, ids=name_of)
def test_code_that_is_linked_by_name_is_in_the_linked_file(document: Path) -> None:
    for name, link in re.findall(r'\[`([\w.]+)`\]\(([^)]+\.py)\)', text_of(document)):
        target = document.parent / link
        if name == target.name:
            continue
        definition = rf'^\s*(?:def |class )?{name.split(".")[-1]}\b'
        assert re.search(definition, text_of(target), re.MULTILINE), f'{name}: {link}'


@pytest.mark.parametrize('document', DOCS, ids=name_of)
def test_identifiers_that_are_named_exist(document: Path) -> None:
    names = re.findall(r'`([a-z]+(?:_[a-z]+)+)`', text_of(document))
    named = {name for name in names if not name.startswith('test_')}
    assert named - words_of_the_sources() - OTHER_NAMES == set()


def test_each_row_of_the_table_of_faults_names_a_test() -> None:
    rows = re.findall(r'^\| (?!fault|---)(.+) \|$', text_of(RELIABILITY), re.MULTILINE)
    assert len(rows) > 30
    for row in rows:
        assert re.search(r'\[`test_\w+`\]\(\.\./test/', row), row


def test_each_test_of_a_fault_is_in_the_table() -> None:
    """Whether the tests that the table names exist is tested with the other links."""
    folder = ROOT / 'test' / 'ros' / 'faults'
    tests = {
        (name, path.name)
        for path in folder.glob('test_*.py')
        for name in re.findall(r'^def (test_\w+)', text_of(path), re.MULTILINE)
    }
    assert len(tests) > 30
    links = re.findall(r'\[`(test_\w+)`\]\([^)]*/(\w+\.py)\)', text_of(RELIABILITY))
    assert tests <= set(links)
