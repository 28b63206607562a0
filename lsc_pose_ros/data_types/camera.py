"""The pinhole camera: pixels to metres and back.

Points are in the optical frame of REP-103: x right, y down, z forward.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Intrinsics(NamedTuple):
    """A pinhole camera's focal lengths and principal point in pixels (K of CameraInfo)."""

    fx: float
    fy: float
    cx: float
    cy: float


def back_project(
    columns: NDArray[np.number],
    rows: NDArray[np.number],
    depth: NDArray[np.floating],
    camera: Intrinsics,
) -> NDArray[np.float32]:
    """Return the points, shape (..., 3), that pixels (columns, rows) show; all in metres."""
    x = (columns - camera.cx) * depth / camera.fx
    y = (rows - camera.cy) * depth / camera.fy
    return np.stack([x, y, depth], axis=-1).astype(np.float32)


def project(points: NDArray[np.floating], camera: Intrinsics) -> NDArray[np.float32]:
    """Return the pixels (column, row), shape (..., 2), of `points`, shape (..., 3) in metres.

    A point at or behind the camera (z <= 0) gives NaN.
    """
    z = np.where(points[..., 2] > 0, points[..., 2], np.nan)
    column = camera.cx + camera.fx * points[..., 0] / z
    row = camera.cy + camera.fy * points[..., 1] / z
    return np.stack([column, row], axis=-1).astype(np.float32)
