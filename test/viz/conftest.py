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

"""Fixtures for the tests of figures: a synthetic person, and a model made by hand."""

import pytest
from tiny_model import tiny_model

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames
from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame

_SMALL = SyntheticSettings(frames=3, width=160, height=120, clip_length=1, distance=(2.0, 3.0))


@pytest.fixture(scope='session')
def people() -> list[Frame]:
    """Three frames of one person each."""
    return list(synthetic_frames(_SMALL))


@pytest.fixture(scope='session')
def model() -> Model:
    return tiny_model()


@pytest.fixture(scope='session')
def drawn(people: list[Frame], model: Model) -> list[DrawnFrame]:
    """The three frames with their estimates."""
    estimator = Estimator(model)
    return [
        DrawnFrame(
            f'frame {number}',
            frame,
            estimator.estimate(frame.depth, frame.labels, frame.camera),
            model.settings,
        )
        for number, frame in enumerate(people)
    ]
