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

"""The unit of length of whole bodies and of those that are cut off."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.pose.features.shape_context_3d import mean_distance
from lsc_pose_ros.pose.features.unit_of_length import unit_of_length
from lsc_pose_ros.pose.inference.truncation import NO_CUTS, Cuts
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.stages import describe_body

CUTS = Cuts(np.zeros((4, 2), np.float32), np.ones((4, 2), np.float32))


def points(scale: float) -> np.ndarray:
    """Return points whose rho_bar is `scale`."""
    drawn = np.random.default_rng(0).normal(size=(50, 3)).astype(np.float32)
    return drawn * np.float32(scale / mean_distance(drawn))


@pytest.mark.parametrize(
    ('rho_bar', 'cuts', 'least', 'expected'),
    [
        (0.4, NO_CUTS, 0.62, 0.4),
        (0.4, CUTS, 0.0, 0.4),
        (0.4, CUTS, 0.62, 0.62),
        (0.7, CUTS, 0.62, 0.7),
    ],
)
def test_only_the_unit_of_a_body_that_is_cut_off_has_a_least_value(
    rho_bar: float, cuts: Cuts, least: float, expected: float
) -> None:
    found = unit_of_length(points(rho_bar), cuts, Settings(least_cut_scale=least))
    assert found == pytest.approx(expected, rel=1e-5)


def test_fixed_unit_replaces_all_others() -> None:
    settings = Settings(least_cut_scale=0.62, fixed_scale=0.5)
    for cuts in (NO_CUTS, CUTS):
        assert unit_of_length(points(0.4), cuts, settings) == 0.5


def test_body_without_extent_has_no_unit() -> None:
    for some in (np.zeros((9, 3), np.float32), np.zeros((1, 3), np.float32)):
        assert unit_of_length(some, CUTS, Settings(least_cut_scale=0.62)) == 0


def test_unit_survives_if_the_legs_are_hidden(people) -> None:
    frame, settings = people[5], Settings(least_cut_scale=0.62)
    rows = np.flatnonzero((frame.labels >= 0).any(axis=1))
    end = int(rows[0] + 0.4 * len(rows))
    depth, labels = frame.depth.copy(), frame.labels.copy()
    depth[end:], labels[end:] = 0.8 * depth[labels >= 0].min(), NO_BODY
    found = [
        describe_body(*images, frame.camera, 1, each).scale
        for images, each in (
            ((frame.depth, frame.labels), settings),
            ((depth, labels), settings),
            ((depth, labels), settings._replace(least_cut_scale=0)),
        )
    ]
    whole, hidden, collapsed = found
    assert hidden == pytest.approx(0.62)
    assert collapsed < 0.8 * whole
