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

"""Which model the node takes."""

import re
from pathlib import Path

import pytest

from lsc_pose_ros.errors import InputError

preparation = pytest.importorskip(
    'lsc_pose_ros.ros.node.preparation', reason='needs ROS 2', exc_type=ImportError
)


def test_models_of_the_package(shipped: Path, small_model_file: Path) -> None:
    with pytest.raises(InputError, match='parameter model: no model comes with'):
        preparation._load('')
    for name, word in (('front', 'front'), ('default', '')):
        (shipped / f'{name}.npz').write_bytes(small_model_file.read_bytes())
        assert len(preparation._load(word).joints) == 8
    with pytest.raises(
        InputError, match=re.escape('parameter model: there is no model file back')
    ) as said:
        preparation._load('back')
    assert 'its models are default, front' in str(said.value)
