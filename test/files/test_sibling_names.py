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

"""Each file has a sibling of its own, however long its name is."""

import os

import pytest

from lsc_pose_ros.files.sibling_names import sibling


def test_name_is_kept_where_there_is_room(tmp_path):
    assert sibling(tmp_path / 'me.npz', '.checkpoint') == tmp_path / 'me.npz.checkpoint'
    assert sibling(tmp_path / 'me.npz', '.part', '.') == tmp_path / '.me.npz.part'


@pytest.mark.parametrize('letter', ['a', 'ü', '\U0001f600', '\udcff'])
def test_long_names_are_cut_and_told_apart(tmp_path, letter):
    most = 255 // len(os.fsencode(letter))
    siblings = set()
    for other in ('x', 'y', 'z'):
        name = letter * (most - 1) + other
        found = sibling(tmp_path / name, '.checkpoint')
        assert len(os.fsencode(found.name)) <= 255
        assert found.name.startswith('' if letter == '\udcff' else letter * 50)
        assert found.name.endswith('.checkpoint')
        assert found == sibling(tmp_path / name, '.checkpoint')
        found.touch()
        siblings.add(found)
    assert len(siblings) == 3
