"""What the forest can see of a point: the paper's feature and its rivals, by `Settings.feature`.

- `3dlsc`: the 3-D Local Shape Context, 360 bins (`descriptor.py`). With `Settings.binning` each
  point can count in one bin only (`plain/descriptor.py`), which the paper measures in its Fig. 11.
- `2dsc`: the shape context in the image plane, 60 bins, radii in units of the mean distance of the
  points in the image (`shape_context_2d.py`).
- `dcf`: depth differences at pairs of random offsets, `Settings.offset_pairs` of them, on the
  smoothed depth (`depth_difference.py`).
- `mixed`: `3dlsc` and `dcf` side by side, which goes beyond the paper: the silhouette tells where
  on the body a point is, the depth around it which way a limb goes.

All else stays the same: how points are chosen, the forest, rho_bar as the unit of offsets, votes
and graph. With `Settings.sample` the points can be taken from the whole body instead of its
silhouette. Then these points are all that the shape contexts know: each is described by where the
others of them lie, and rho_bar is their mean distance.

Girshick et al., "Efficient regression of general-activity human poses from depth images", ICCV
2011, is `dcf` on points of the body with each joint on its own: `lsc_pose train --feature dcf
--sample body`, then `lsc_pose evaluate --no-graph`.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.plain.descriptor import describe_by_nearest_bin, quantise
from lsc_pose_ros.pose.features.depth_comparison import compare_depths, offset_pool
from lsc_pose_ros.pose.features.shape_context_2d import SIZE, describe_in_image
from lsc_pose_ros.pose.features.shape_context_3d import DESCRIPTOR_SIZE, describe, mean_distance
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.silhouette.silhouette import Silhouette


class Seen(NamedTuple):
    """What features are computed from.

    Attributes:
        silhouette: the body's points and its smoothed depth.
        scale: rho_bar, metres.
        camera: the intrinsics.
        settings: which feature, and its parameters.
    """

    silhouette: Silhouette
    scale: float
    camera: Intrinsics
    settings: Settings


def feature_size(settings: Settings) -> int:
    """Return F, how many numbers describe a point."""
    return {
        '3dlsc': DESCRIPTOR_SIZE,
        '2dsc': SIZE,
        'dcf': settings.offset_pairs,
        'mixed': DESCRIPTOR_SIZE + settings.offset_pairs,
    }[settings.feature]


def describe_points(seen: Seen, queries: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Return what the forest sees of some of the points, as levels, shape (Q, F).

    Args:
        seen: the body.
        queries: which of its points, shape (Q,).
    """
    return _DESCRIBE[seen.settings.feature](seen, queries)


def _local_shape_context(seen: Seen, queries: NDArray[np.int64]) -> NDArray[np.uint8]:
    points, settings = seen.silhouette.points, seen.settings
    reach = seen.scale * settings.support_radius
    if settings.binning == 'nearest':
        return quantise(describe_by_nearest_bin(points, queries, reach, settings.inner_radius))
    return describe(points, queries, reach, settings.inner_radius)


def _shape_context_in_image(seen: Seen, queries: NDArray[np.int64]) -> NDArray[np.uint8]:
    silhouette, settings = seen.silhouette, seen.settings
    pixels = np.zeros((len(silhouette.chosen), 3), np.float32)
    pixels[:, 0] = silhouette.columns[silhouette.chosen]
    pixels[:, 1] = silhouette.rows[silhouette.chosen]
    reach = mean_distance(pixels) * settings.support_radius
    return describe_in_image(pixels, queries, reach, settings.inner_radius)


def _depth_comparison(seen: Seen, queries: NDArray[np.int64]) -> NDArray[np.uint8]:
    silhouette, settings = seen.silhouette, seen.settings
    window, kept = silhouette.smoothed, silhouette.chosen[queries]
    rows, columns = silhouette.rows[kept] - window.row, silhouette.columns[kept] - window.column
    pool = offset_pool(settings.offset_pairs, settings.offset_reach, settings.offset_seed)
    return compare_depths(window, np.stack([rows, columns], axis=1), pool, seen.camera)


def _mixed(seen: Seen, queries: NDArray[np.int64]) -> NDArray[np.uint8]:
    return np.hstack((_local_shape_context(seen, queries), _depth_comparison(seen, queries)))


_DESCRIBE: dict[str, Callable[[Seen, NDArray[np.int64]], NDArray[np.uint8]]] = {
    '3dlsc': _local_shape_context,
    '2dsc': _shape_context_in_image,
    'dcf': _depth_comparison,
    'mixed': _mixed,
}
