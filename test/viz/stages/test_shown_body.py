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

"""The body whose stages are drawn."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.viz.stages.shown_body import show_body


def test_body_that_covers_the_most_pixels_is_chosen(people: list[Frame]) -> None:
    labels = people[0].labels.copy()
    labels[:3, :3] = 0
    assert show_body('frame 0', people[0]._replace(labels=labels)).number == 1


def test_error_names_the_missing_body_and_the_present_ones(people: list[Frame]) -> None:
    with pytest.raises(InputError, match=r'frame 0: the mask has no body 5; the bodies in it: 1$'):
        show_body('frame 0', people[0], 5)


def test_empty_mask_is_refused(people: list[Frame]) -> None:
    empty = people[0]._replace(labels=np.full_like(people[0].labels, -1))
    with pytest.raises(InputError, match='frame 4: the mask shows nobody'):
        show_body('frame 4', empty)


@pytest.mark.parametrize('with_model', [False, True])
def test_speck_is_refused(people: list[Frame], model: Model, with_model: bool) -> None:  # noqa: FBT001
    labels = np.full_like(people[0].labels, -1)
    rows, columns = np.nonzero(people[0].labels == 1)
    labels[rows[:4], columns[:4]] = 1
    with pytest.raises(InputError, match='frame 0: too little of body 1 is visible'):
        show_body('frame 0', people[0]._replace(labels=labels), 1, model if with_model else None)
