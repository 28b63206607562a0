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


"""Files of the forests of body parts: what is saved is loaded, and nothing unusable is."""

import json
from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros.body_parts.context import PLANES, PartForests
from lsc_pose_ros.body_parts.part_forest import CLASSES, PartForest
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.model_io.part_forest_file import (
    FORMAT,
    MOST_SPLITS,
    load_part_forests,
    save_part_forests,
)


def a_forest() -> PartForest:
    """Return two trees of one split each."""
    rng = np.random.default_rng(0)
    return PartForest(
        np.array([0, 3], np.int32),
        rng.uniform(-1, 1, (6, 5)).astype(np.float32),
        np.zeros(6, np.uint8),
        np.array([1, -1, -2, 4, -3, -4], np.int32),
        rng.integers(0, 255, (4, CLASSES)).astype(np.uint8),
    )


def both(forest: PartForest) -> PartForests:
    """Return a usable first forest, and `forest` as the second one."""
    return PartForests(a_forest(), forest)


def in_all_planes() -> PartForest:
    return a_forest()._replace(plane=np.arange(6, dtype=np.uint8) % PLANES)


def test_forests_come_back(tmp_path: Path) -> None:
    saved = both(in_all_planes())
    save_part_forests(tmp_path / 'parts.npz', saved, {'samples': '7'})
    forests, provenance = load_part_forests(tmp_path / 'parts.npz')
    assert provenance == {'samples': '7'}
    for forest, again in zip(saved, forests, strict=True):
        for name, array in forest._asdict().items():
            np.testing.assert_array_equal(getattr(again, name), array, strict=True)
    assert [path.name for path in tmp_path.iterdir()] == ['parts.npz']


def test_the_forests_of_the_package_are_usable() -> None:
    forests, provenance = load_part_forests()
    assert len(forests.first.roots) >= 1
    assert forests.second.plane.max() == PLANES - 1
    assert int(provenance['samples']) > 0


def chain(length: int) -> PartForest:
    """Return a tree whose deepest leaf is below `length` splits."""
    left = np.zeros(2 * length + 1, np.int32)
    left[:-1:2] = np.arange(1, 2 * length, 2)
    left[1::2] = -1
    left[-1] = -1
    # The right child of each split is the next split.
    left[: 2 * length : 2] = np.arange(1, 2 * length, 2)
    return PartForest(
        np.zeros(1, np.int32),
        np.zeros((len(left), 5), np.float32),
        np.zeros(len(left), np.uint8),
        left,
        np.zeros((1, CLASSES), np.uint8),
    )


def test_a_deep_tree_is_usable_up_to_the_limit(tmp_path: Path) -> None:
    save_part_forests(tmp_path / 'good.npz', both(chain(MOST_SPLITS)), {})
    load_part_forests(tmp_path / 'good.npz')
    save_part_forests(tmp_path / 'deep.npz', both(chain(MOST_SPLITS + 1)), {})
    with pytest.raises(InputError, match='below more than'):
        load_part_forests(tmp_path / 'deep.npz')


def changed(name: str, index: tuple[int, ...] | int, value: float) -> PartForest:
    array = getattr(a_forest(), name).copy()
    array[index] = value
    return a_forest()._replace(**{name: array})


@pytest.mark.parametrize(
    ('forest', 'complaint'),
    [
        (changed('roots', 0, -1), 'begin outside'),
        (changed('roots', 1, 6), 'begin outside'),
        (changed('left', 0, 0), 'before its children'),
        (changed('left', 3, 1), 'before its children'),
        (changed('left', 3, 5), 'before its children'),
        (changed('left', 1, -5), 'does not exist'),
        (changed('left', 1, np.iinfo(np.int32).min), 'does not exist'),
        (changed('splits', (0, 4), np.nan), 'not within'),
        (changed('splits', (0, 0), np.inf), 'not within'),
        (changed('splits', (2, 1), 1e9), 'not within'),
        (changed('plane', 3, PLANES), 'plane that does not exist'),
        (a_forest()._replace(plane=np.zeros(5, np.uint8)), 'shapes'),
        (a_forest()._replace(splits=np.zeros((6, 4), np.float32)), 'shapes'),
        (a_forest()._replace(splits=np.zeros((5, 5), np.float32)), 'shapes'),
        (a_forest()._replace(leaves=np.zeros((4, 3), np.uint8)), 'shapes'),
        (a_forest()._replace(leaves=np.zeros((0, CLASSES), np.uint8)), 'shapes'),
        (a_forest()._replace(roots=np.zeros(0, np.int32)), 'trees'),
        (a_forest()._replace(roots=np.zeros(99, np.int32)), 'trees'),
    ],
)
def test_a_forest_whose_parts_do_not_fit_is_refused(
    tmp_path: Path, forest: PartForest, complaint: str
) -> None:
    path = tmp_path / 'parts.npz'
    save_part_forests(path, both(forest), {})
    with pytest.raises(InputError, match=f'parts.npz is not a usable.*{complaint}'):
        load_part_forests(path)


def write(path: Path, header: object, **changes: np.ndarray) -> None:
    text = np.frombuffer(json.dumps(header).encode(), np.uint8)
    arrays = {
        f'{which}_{name}': array
        for which in PartForests._fields
        for name, array in a_forest()._asdict().items()
    }
    np.savez_compressed(path, **({'header': text} | arrays | changes))


HEADER = {
    'format': FORMAT,
    'version': 2,
    'classes': ['no person', *JOINT_NAMES],
    'provenance': {},
}


@pytest.mark.parametrize(
    ('header', 'complaint'),
    [
        ([], 'another kind'),
        (HEADER | {'format': 'x'}, 'another kind'),
        (HEADER | {'version': 1}, 'it has version 1'),
        (HEADER | {'classes': ['no person']}, 'classes'),
        (HEADER | {'provenance': 3}, 'provenance'),
    ],
)
def test_another_header_is_refused(tmp_path: Path, header: object, complaint: str) -> None:
    write(tmp_path / 'parts.npz', header)
    with pytest.raises(InputError, match=complaint):
        load_part_forests(tmp_path / 'parts.npz')


@pytest.mark.parametrize('name', ['roots', 'splits', 'plane', 'left', 'leaves'])
def test_an_array_of_another_type_is_refused(tmp_path: Path, name: str) -> None:
    array = getattr(a_forest(), name)
    write(tmp_path / 'parts.npz', HEADER, **{f'second_{name}': array.astype(np.float64)})
    with pytest.raises(InputError, match=f'its part second_{name} is float64'):
        load_part_forests(tmp_path / 'parts.npz')


def test_pickles_are_not_loaded(tmp_path: Path) -> None:
    write(tmp_path / 'parts.npz', HEADER, first_roots=np.array([{}], object))
    with pytest.raises(InputError, match='not a usable body-part forest'):
        load_part_forests(tmp_path / 'parts.npz')


def test_a_file_that_is_missing_or_damaged_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match='there is no file'):
        load_part_forests(tmp_path / 'none.npz')
    (tmp_path / 'parts.npz').write_bytes(b'PK\x03\x04 nonsense')
    with pytest.raises(InputError, match='not a usable body-part forest'):
        load_part_forests(tmp_path / 'parts.npz')


def test_an_older_file_stays_if_the_new_one_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r'the folder .*missing does not exist'):
        save_part_forests(tmp_path / 'missing' / 'parts.npz', both(a_forest()), {})
