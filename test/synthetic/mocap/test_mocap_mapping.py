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

"""Tests the mapping files."""

import pytest
from stick_figure import mapping_text

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.mocap.mocap_mapping import load_mapping


@pytest.mark.parametrize(
    ('old', 'new', 'says'),
    [
        ('up: y', 'up: w', "up is 'w'"),
        ('forward: z', 'forward: -y', 'same axis'),
        ('axes: {up: y, forward: z}', 'axes: up', 'axes must be a table'),
        ('pelvis:', 'pelvic:', 'unknown keys: pelvic'),
        ('  chest: {turns: Chest}\n', '', 'has no chest'),
        ('turns: Chest', 'turn: Chest', 'unknown keys: turn;'),
        ('{turns: Chest}', '{turns: Chest, along: [Chest, Head]}', 'either turns'),
        ('{turns: Chest}', '{along: [Chest, Head]}', 'chest needs turns'),
        ('along: [Leftarm, Leftelbow]', 'turns: Leftarm', 'l_upper_arm needs along'),
        ('[Leftarm, Leftelbow]', '[Leftarm]', 'two joints'),
        ('[0, 0, 90]', '[0, 90]', 'three numbers'),
        ('{turns: Head}', '{turns: Head, bent: 3}', 'forearm and shank'),
        ('[Leftleg, Leftknee]}', '[Leftleg, [Leftknee]]}', 'not the name of a joint'),
        ('[Leftknee, Leftankle]', '[Leftknee, Leftankle], bent: -4', 'bent is -4'),
        ('segments:', 'skip: -1\nsegments:', 'skip is -1'),
        ('segments:', 'neutral: first\nsegments:', "neutral is 'first'"),
        ('segments:', 'segments: {', 'not valid YAML'),
    ],
)
def test_invalid_mapping_is_refused(tmp_path, old, new, says):
    text = mapping_text()
    assert old in text
    path = tmp_path / 'map.yaml'
    path.write_text(text.replace(old, new, 1), encoding='ascii')
    with pytest.raises(InputError, match=rf'map.yaml .*{says}'):
        load_mapping(path)
