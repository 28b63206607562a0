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

"""The files of the package are found."""

from pathlib import Path

import pytest

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources.package_files import (
    default_model,
    find_model,
    resource,
    shipped_models,
)


def test_files_of_the_package_are_found() -> None:
    assert resource('config', 'pose_node.yaml').is_file()
    assert resource('config', 'fastdds_profile.xml').is_file()
    assert resource('bodies', 'body.npz').is_file()


def test_missing_file_is_named() -> None:
    with pytest.raises(InputError, match=r'config/nothing\.yaml'):
        resource('config', 'nothing.yaml')


def test_default_model(shipped: Path) -> None:
    (shipped / 'default.npz').touch()
    assert default_model() == shipped / 'default.npz'


def test_without_a_default_model(shipped: Path) -> None:
    assert shipped
    with pytest.raises(InputError, match='lsc_pose train'):
        default_model()


def test_models_have_names(shipped: Path) -> None:
    for name in ('front.npz', 'default.npz', 'README.md'):
        (shipped / name).touch()
    front, default = shipped / 'front.npz', shipped / 'default.npz'
    assert shipped_models() == {'default': default, 'front': front}
    assert find_model() == find_model('') == find_model('default') == default
    assert find_model('front') == find_model(Path('front')) == front


def test_file_takes_precedence_over_a_model_of_the_package(
    shipped: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (shipped / 'front.npz').touch()
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'front').mkdir()  # a folder is no model
    assert find_model('front') == shipped / 'front.npz'
    (tmp_path / 'front').rmdir()
    (tmp_path / 'front').touch()
    assert find_model('front') == Path('front')


def test_name_with_a_suffix_or_a_folder_is_a_path(shipped: Path) -> None:
    (shipped / 'front.npz').touch()
    for path in ('front.npz', 'folder/front', '/front', '../front'):
        assert find_model(path) == Path(path)


def test_unknown_name_is_refused_with_the_known_names(shipped: Path) -> None:
    with pytest.raises(InputError, match=r'no model file back, .* no model does'):
        find_model('back')
    for name in ('front', 'default'):
        (shipped / f'{name}.npz').touch()
    with pytest.raises(InputError, match='its models are default, front'):
        find_model('back')
