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

"""The unit of all learnt lengths: rho_bar, unless the body is cut off."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.pose.features.shape_context_3d import mean_distance
from lsc_pose_ros.pose.inference.truncation import Cuts
from lsc_pose_ros.pose.settings import Settings


def unit_of_length(points: NDArray[np.float32], cuts: Cuts, settings: Settings) -> float:
    """Return the unit of length of a body, metres; 0 if it has fewer than two points.

    rho_bar is the mean distance of all pairs of points. Of a body that is cut off, the points of
    the visible part alone are closer to each other, and rho_bar would squeeze the whole body into
    that part. So it is then at least `Settings.least_cut_scale`.

    Args:
        points: of the body's silhouette, metres, shape (N, 3).
        cuts: where the body is cut off, or hidden by something nearer.
        settings: the least rho_bar of a body that is cut off, or a fixed unit for all bodies.
    """
    if settings.fixed_scale:
        return settings.fixed_scale
    rho_bar = mean_distance(points)
    if rho_bar > 0 and len(cuts.rays):
        return max(rho_bar, settings.least_cut_scale)
    return rho_bar
