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

"""The bins of the descriptor that is drawn."""

import numpy as np
import pytest
from plain.descriptor import describe

from lsc_pose_ros.pose.features.shape_context_3d import AZIMUTH_BINS, RADIUS_BINS, ZENITH_BINS
from lsc_pose_ros.viz.stages.descriptor_figure import bin_radii, shown_point
from lsc_pose_ros.viz.stages.shown_body import ShownBody


@pytest.mark.parametrize('radius_bin', range(RADIUS_BINS))
def test_bin_radii_are_where_the_descriptors_bins_end(radius_bin: int) -> None:
    radii = bin_radii(0.8, 0.1)
    assert radii[[0, -1]] == pytest.approx([0.08, 0.8])
    middle = np.sqrt(radii[radius_bin] * radii[radius_bin + 1])
    points = np.array([[0, 0, 2], [middle, 0, 2]], np.float32)
    histogram = describe(points, np.arange(1), 0.8, 0.1)[0]
    filled = histogram.reshape(RADIUS_BINS, AZIMUTH_BINS, ZENITH_BINS)
    assert filled.sum(axis=(1, 2))[radius_bin] == pytest.approx(1, abs=1e-3)


def test_shown_descriptor_is_that_of_an_outermost_point(shown: ShownBody) -> None:
    x = shown.result.silhouette.points[:, 0]
    assert x[shown_point(shown)] in (x.min(), x.max())
