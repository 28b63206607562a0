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

"""YAML and JSON files of strangers are refused before they take much time or memory."""

import tracemalloc
from pathlib import Path

import pytest

from lsc_pose_ros.datasets.image_folder import read_intrinsics
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.labels.extrinsic import load_extrinsic
from lsc_pose_ros.labels.sources.tf_frames import load_joint_frames
from lsc_pose_ros.labels.vocabulary import load_vocabulary
from lsc_pose_ros.resources.bounded_yaml import parse_yaml
from lsc_pose_ros.resources.json_files import read_json
from lsc_pose_ros.resources.text_files import LARGEST_TEXT, read_text
from lsc_pose_ros.resources.yaml_tables import read_yaml
from lsc_pose_ros.synthetic.mocap.mocap_mapping import load_mapping


@pytest.mark.parametrize(
    ('text', 'reason'),
    [
        ('a: &x [1, 2]', 'line 1: anchors'),
        ('a: 1\nb: *x', 'line 2: anchors'),
        ('a: {b: 1,\n c: &x 1}', 'line 2: anchors'),
        ('x: ' + '1:' * 30 + '1', 'line 1: a number with 61 digits'),
        ('9' * 5000, 'a number with 5000 digits'),
        ('!!int ' + '9' * 5000, 'a number with 5000 digits'),
        ('.' + '9' * 5000, 'a number with 5001 digits'),
        ('[' * 60 + ']' * 60, 'nested more than 50 deep'),
        ('- ' * 60, 'nested more than 50 deep'),
        ('\n' + '- 1\n' * 50_001, 'line 50001: more than 50000 values'),
        ('a: 1\nb: 2\na: 3', 'line 3: the key a occurs twice'),
        ('a: [', 'line 1: '),
        ('2001-99-99', 'month must be in 1..12'),
        ('!!float x', 'could not convert'),
        ('!!int ""', 'index out of range'),
        ('!!bool x', 'x'),
        ('!!timestamp x', 'no attribute'),
        ('!!python/object:os.system x', 'could not determine a constructor'),
        ('!' + 'x' * 5000, 'could not determine a constructor'),
        ('? [a]\n: b', 'unhashable'),
        ('\0', 'special characters are not allowed'),
    ],
)
def test_yaml_is_refused(text: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason) as caught:
        parse_yaml(text)
    assert len(str(caught.value)) < 300


def test_ordinary_yaml_is_read() -> None:
    text = 'a: [1, 2.5, -3, 1e-3]\nb: {c: true, d: null}\ne: "&x *y"\nf: 2001-01-01'
    loaded = parse_yaml(text)
    assert loaded['a'][:3] == [1, 2.5, -3]
    assert loaded['b'] == {'c': True, 'd': None}
    assert loaded['e'] == '&x *y'


def test_merged_keys_may_be_given_again() -> None:
    assert parse_yaml('a: 1\n<<: {a: 2, b: 3}') == {'a': 1, 'b': 3}


ALIASES = 'a: &a [1]\nb: *a\n'


@pytest.mark.parametrize(
    'read',
    [
        load_extrinsic,
        load_mapping,
        load_vocabulary,
        lambda path: load_joint_frames(path, load_vocabulary('lsc_pose')),
    ],
)
@pytest.mark.parametrize('text', [ALIASES, '[' * 100_000, '2001-99-99', '9' * 5000, '!!float x'])
def test_each_reader_of_yaml_refuses(read, text: str, tmp_path: Path) -> None:
    path = tmp_path / 'strange.yaml'
    path.write_text(text)
    with pytest.raises(InputError, match=r'strange\.yaml is not valid YAML: ') as caught:
        read(path)
    assert len(str(caught.value)) < 400


@pytest.mark.parametrize(
    ('text', 'reason'),
    [
        ('[' * 100_000, 'nested too deeply'),
        ('{"a":' * 100_000, 'nested too deeply'),
        ('[' + '1' * 31 + ']', 'an integer with 31 digits'),
        ('{', 'not valid JSON'),
    ],
)
def test_json_is_refused(text: str, reason: str, tmp_path: Path) -> None:
    path = tmp_path / 'strange.json'
    path.write_text(text)
    with pytest.raises(InputError, match=reason) as caught:
        read_json(path, 'table')
    assert 'strange.json' in str(caught.value)
    with pytest.raises(InputError, match=reason):
        read_intrinsics(path)


@pytest.mark.parametrize(
    'text', ['[]', '1', '"K"', 'null', '{"K": [1]}', '{"K": {}}', '{"fx": 1}', '{"K": [[]]}',
             '{"fx": [], "fy": 1, "cx": 1, "cy": 1}', '{"K": ["a"]}', '{"K": [1e999]}'],
)  # fmt: skip
def test_json_without_intrinsics_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / 'strange.json'
    path.write_text(text)
    with pytest.raises(InputError, match=r'strange\.json has no intrinsics'):
        read_intrinsics(path)


def test_no_more_than_the_largest_file_is_read(tmp_path: Path) -> None:
    path = tmp_path / 'long.yaml'
    path.write_text('#' * LARGEST_TEXT)
    assert len(read_text(path, 'text')) == LARGEST_TEXT
    path.write_text('#' * (LARGEST_TEXT + 1))
    with pytest.raises(InputError, match=r'long\.yaml has more than 1024 kB'):
        read_yaml(path, 'text')
    with pytest.raises(InputError, match='has more than 1024 kB'):
        read_text(Path('/dev/zero'), 'text')


def test_a_short_file_takes_little_memory(tmp_path: Path) -> None:
    path = tmp_path / 'short.json'
    path.write_text('[1]')
    tracemalloc.start()
    try:
        assert read_json(path, 'table', 1 << 30) == [1]
        assert tracemalloc.get_traced_memory()[1] < 10 << 20
    finally:
        tracemalloc.stop()


def test_unreadable_files_are_named(tmp_path: Path) -> None:
    path = tmp_path / 'latin.yaml'
    path.write_bytes(b'a: \xe9')
    with pytest.raises(InputError, match=r'cannot read the text .*latin\.yaml: .*utf-8'):
        read_text(path, 'text')
    with pytest.raises(InputError, match=r'cannot read the text .*: No such file'):
        read_text(tmp_path / 'gone', 'text')
    with pytest.raises(InputError, match=r'cannot read the text .*: Is a directory'):
        read_text(tmp_path, 'text')


@pytest.mark.parametrize(
    ('text', 'reason'),
    [
        ('translation: [1, 2]\nrotation: [0, 0, 0, 1]', 'give translation'),
        ('translation: [a, 2, 3]\nrotation: [0, 0, 0, 1]', 'give translation'),
        ('translation: {a: 1}\nrotation: [0, 0, 0, 1]', 'give translation'),
        ('translation: [1e300, 0, 0]\nrotation: [0, 0, 0, 1]', 'three numbers of metres'),
        ('translation: [.nan, 0, 0]\nrotation: [0, 0, 0, 1]', 'three numbers of metres'),
        ('translation: [1, 0, 0]\nrotation: [0, 0, 0, 1.0e+300]', 'length 1'),
        ('translation: [1, 0, 0]\nrotation: [0, 0, 0, .nan]', 'length 1'),
        ('translation: [1, 0, 0]\nrotation: [0, 0, 0, 1]\nparent: [a]', 'the name of a frame'),
    ],
)
def test_absurd_extrinsic_is_refused(text: str, reason: str, tmp_path: Path) -> None:
    path = tmp_path / 'camera.yaml'
    path.write_text(text)
    with pytest.raises(InputError, match=reason) as caught:
        load_extrinsic(path)
    assert 'camera.yaml' in str(caught.value)


@pytest.mark.parametrize(
    ('text', 'reason'),
    [
        ('names: [[a], [a]]\njoints: {head: a}', 'a list of names'),
        ('names: [a, a]\njoints: {head: a}', 'different names'),
        ('joints: {head: [[a]]}', 'is not the name of a joint'),
        ('joints: {head: {a: 1.0e+300}}', 'is not a number'),
        ('joints_per_body: 1' + '0' * 30 + '\njoints: {head: a}', 'not a number from 0'),
        ('joints: {head: a}\n' + 'x' * 900 + ': 1', 'unknown keys: xxx'),
        ('joints: {head: a, ' + 'x' * 900 + ': 1}', 'unknown keys: xxx'),
    ],
)
def test_absurd_vocabulary_is_refused(text: str, reason: str, tmp_path: Path) -> None:
    path = tmp_path / 'joints.yaml'
    path.write_text(text)
    with pytest.raises(InputError, match=reason) as caught:
        load_vocabulary(path)
    assert 'joints.yaml' in str(caught.value)
    assert len(str(caught.value)) < 1000


@pytest.mark.parametrize(
    ('text', 'reason'),
    [
        ("bodies: [1, 1]\npattern: '{joint}'", 'different numbers'),
        ("bodies: []\npattern: '{joint}'", 'different numbers'),
        ("bodies: [true]\npattern: '{joint}'", 'True is not a body number'),
        ('bodies: {1: {head: {frame: a, offset: [[1], [2, 3], 4]}}}', 'must be a frame'),
        ('bodies: {1: {head: {frame: a, offset: {x: 1}}}}', 'must be a frame'),
        ('bodies: {1: {head: {frame: a, offset: [1.0e+300, 0, 0]}}}', 'must be a frame'),
        ('bodies: {1: {' + 'x' * 900 + ': a}}', 'unknown joint xxx'),
    ],
)
def test_absurd_mapping_of_frames_is_refused(text: str, reason: str, tmp_path: Path) -> None:
    path = tmp_path / 'frames.yaml'
    path.write_text(text)
    with pytest.raises(InputError, match=reason) as caught:
        load_joint_frames(path, load_vocabulary('lsc_pose'))
    assert 'frames.yaml' in str(caught.value)
    assert len(str(caught.value)) < 1000
