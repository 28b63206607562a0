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

"""The numbers of the figures of the stages."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.viz.stages.shown_body import ShownBody, show_body
from lsc_pose_ros.viz.stages.skeleton_figure import skeleton_figure
from lsc_pose_ros.viz.stages.stage_numbers import stage_numbers
from lsc_pose_ros.viz.stages.stage_sheet import stage_sheet


def test_numbers_are_those_in_the_figures(shown: ShownBody) -> None:
    assert shown.model is not None
    numbers = stage_numbers(shown)
    titles = [axes.get_title() for axes in stage_sheet(shown).axes]
    assert f'3. silhouette: {numbers["points"]} of {numbers["edge_pixels"]}' in titles
    drawn = [axes.get_title() for axes in skeleton_figure(shown, shown.model).axes]
    for step, error in numbers['error_m'].items():
        assert f'{step}: {100 * error:.1f} cm' in drawn


def test_numbers_of_the_body(shown: ShownBody) -> None:
    numbers = stage_numbers(shown)
    depth = shown.frame.depth[shown.frame.labels == shown.number]
    near, far = np.percentile(depth[depth > 0], [1, 99])
    assert (numbers['near_m'], numbers['far_m']) == (pytest.approx(near), pytest.approx(far))
    assert numbers['unit_of_length_m'] == pytest.approx(shown.result.scale)
    assert list(numbers['modes']) == names_of(shown.model.joints)
    assert list(numbers['modes'].values()) == shown.result.candidates.counts.tolist()


def test_without_ground_truth_there_are_no_errors(shown: ShownBody, people: list[Frame]) -> None:
    blind = show_body('frame 0', people[0]._replace(ground_truth=None), 1, shown.model)
    assert stage_numbers(blind)['error_m'] == {}
    assert stage_numbers(blind)['joint_error_m'] == {}


def test_without_a_model_only_the_first_stages_have_numbers(people: list[Frame]) -> None:
    assert 'modes' not in stage_numbers(show_body('frame 0', people[0]))
