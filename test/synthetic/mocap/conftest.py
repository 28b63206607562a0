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

"""Fixtures of the tests of motion capture."""

import pytest
from captured_poses import AXES
from stick_figure import bvh_text, mapping_text

from lsc_pose_ros.synthetic.body.body_file import BodyModel, load_body
from lsc_pose_ros.synthetic.body.body_mesh import (
    BodyShape,
    RestBody,
    shape_body,
)
from lsc_pose_ros.synthetic.mocap.mocap_clip import read_clip
from lsc_pose_ros.synthetic.mocap.mocap_mapping import load_mapping


@pytest.fixture(scope='module')
def body() -> BodyModel:
    return load_body()


@pytest.fixture(scope='module')
def rest(body: BodyModel) -> RestBody:
    return shape_body(body, BodyShape())


@pytest.fixture
def clip_of(tmp_path):
    def make(frames, up='y', forward='z', extra='', **how):
        (tmp_path / 'clip.bvh').write_text(
            bvh_text(frames, axes=AXES[up, forward], **how), encoding='ascii'
        )
        (tmp_path / 'map.yaml').write_text(mapping_text(up, forward, extra), encoding='ascii')
        return read_clip(tmp_path / 'clip.bvh', load_mapping(tmp_path / 'map.yaml'))

    return make
