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

"""The features of points, by `Settings.feature`: that of the paper and its rivals.

- `3dlsc`: the 3-D Local Shape Context, 360 bins (`shape_context_3d.py`). With `Settings.binning`
  set to 'nearest' each point counts in one bin only (`nearest_bin.py`), as in the paper's Fig. 11.
- `2dsc`: the shape context in the image plane, 60 bins, radii in units of the mean distance of the
  points in the image (`shape_context_2d.py`).
- `dcf`: depth differences at `Settings.offset_pairs` pairs of random offsets, on the smoothed
  depth (`depth_comparison.py`).
- `mixed`: `3dlsc` and `dcf` side by side. This goes beyond the paper: the silhouette shows where
  on the body a point is, the depth around it in which direction a limb points.

All else stays the same: the choice of points, the forest, rho_bar as the unit of offsets, votes
and graph. If `Settings.sample` is 'body', the points are spread over the whole body instead of its
silhouette. The shape contexts then use these points only: each is described by the positions of
the others, and rho_bar is their mean distance.

Girshick et al., "Efficient regression of general-activity human poses from depth images", ICCV
2011, is `dcf` on points of the body with each joint estimated by itself: `lsc_pose train --feature
dcf --sample body`, then `lsc_pose evaluate --no-graph`.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.pose.features.depth_comparison import compare_depths, offset_pool
from lsc_pose_ros.pose.features.nearest_bin import describe_by_nearest_bin, quantise
from lsc_pose_ros.pose.features.shape_context_2d import SIZE, describe_in_image
from lsc_pose_ros.pose.features.shape_context_3d import DESCRIPTOR_SIZE, describe, mean_distance
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.silhouette.silhouette import Silhouette


def feature_size(settings: Settings) -> int:
    """Return F, the number of features of a point."""
    return {
        '3dlsc': DESCRIPTOR_SIZE,
        '2dsc': SIZE,
        'dcf': settings.offset_pairs,
        'mixed': DESCRIPTOR_SIZE + settings.offset_pairs,
    }[settings.feature]


def describe_points(
    silhouette: Silhouette,
    queries: NDArray[np.int64],
    scale: float,
    camera: Intrinsics,
    settings: Settings,
) -> NDArray[np.uint8]:
    """Return the quantised features of some of a body's points, shape (Q, F).

    Args:
        silhouette: the body's points and its smoothed depth.
        queries: the indices of the points to describe, shape (Q,).
        scale: rho_bar, metres.
        camera: the intrinsics.
        settings: which feature, and its parameters.
    """
    return _DESCRIBE[settings.feature](silhouette, queries, scale, camera, settings)


def _local_shape_context(
    silhouette: Silhouette,
    queries: NDArray[np.int64],
    scale: float,
    _camera: Intrinsics,
    settings: Settings,
) -> NDArray[np.uint8]:
    points, radius = silhouette.points, scale * settings.support_radius
    if settings.binning == 'nearest':
        return quantise(describe_by_nearest_bin(points, queries, radius, settings.inner_radius))
    return describe(points, queries, radius, settings.inner_radius)


def _shape_context_in_image(
    silhouette: Silhouette,
    queries: NDArray[np.int64],
    _scale: float,
    _camera: Intrinsics,
    settings: Settings,
) -> NDArray[np.uint8]:
    pixels = np.zeros((len(silhouette.chosen), 3), np.float32)
    pixels[:, 0] = silhouette.columns[silhouette.chosen]
    pixels[:, 1] = silhouette.rows[silhouette.chosen]
    radius = mean_distance(pixels) * settings.support_radius
    return describe_in_image(pixels, queries, radius, settings.inner_radius)


def _depth_comparison(
    silhouette: Silhouette,
    queries: NDArray[np.int64],
    _scale: float,
    camera: Intrinsics,
    settings: Settings,
) -> NDArray[np.uint8]:
    window, kept = silhouette.smoothed, silhouette.chosen[queries]
    rows, columns = silhouette.rows[kept] - window.row, silhouette.columns[kept] - window.column
    pool = offset_pool(settings.offset_pairs, settings.offset_reach, settings.offset_seed)
    pixels = np.stack([rows, columns], axis=1)
    return compare_depths(window, pixels, pool, (float(camera.fx), float(camera.fy)))


def _mixed(
    silhouette: Silhouette,
    queries: NDArray[np.int64],
    scale: float,
    camera: Intrinsics,
    settings: Settings,
) -> NDArray[np.uint8]:
    shape_context = _local_shape_context(silhouette, queries, scale, camera, settings)
    comparisons = _depth_comparison(silhouette, queries, scale, camera, settings)
    return np.hstack((shape_context, comparisons))


_Describe = Callable[
    [Silhouette, NDArray[np.int64], float, Intrinsics, Settings], NDArray[np.uint8]
]
_DESCRIBE: dict[str, _Describe] = {
    '3dlsc': _local_shape_context,
    '2dsc': _shape_context_in_image,
    'dcf': _depth_comparison,
    'mixed': _mixed,
}
