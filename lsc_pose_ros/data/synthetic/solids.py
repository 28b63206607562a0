"""Round cones in space: a body's solids, posed; and how deep points lie in them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data.synthetic.body import Solids
from lsc_pose_ros.data.synthetic.pose import Placement


class RoundCones(NamedTuple):
    """Round cones, each in its own frame, in which it is round and lies along y.

    A point p is at `inward @ (p - origin)` in that frame. There the solid is the hull of the
    sphere of radius `radii[0]` about (0, 0, 0) and the one of radius `radii[1]` about
    (0, length, 0).

    Attributes:
        origins: metres, shape (..., S, 3).
        inward: shape (..., S, 3, 3).
        length: shape (S,).
        radii: shape (S, 2).
    """

    origins: NDArray[np.float64]
    inward: NDArray[np.float64]
    length: NDArray[np.float64]
    radii: NDArray[np.float64]


def pose_solids(solids: Solids, placement: Placement) -> RoundCones:
    """Return `solids` as N poses place them, origins (N, S, 3), in the frame of `placement`."""
    frames = _own_frames(solids)
    rotations = placement.rotations[:, solids.segment]
    origins = placement.origins[:, solids.segment] + np.einsum(
        'nskl,sl->nsk', rotations, solids.ends[:, 0]
    )
    stretch = np.stack([solids.squeeze[:, 0], np.ones(len(frames)), solids.squeeze[:, 1]], axis=1)
    # Columns of `frames` are the solid's axes in the segment; the inverse has them as rows.
    inward = frames.transpose(0, 2, 1) @ rotations.transpose(0, 1, 3, 2) / stretch[:, :, None]
    length: NDArray[np.float64] = np.sqrt(
        ((solids.ends[:, 1] - solids.ends[:, 0]) ** 2).sum(axis=1)
    )
    return RoundCones(origins, inward, length, solids.radii)


def signed_distance(points: NDArray[np.float64], cones: RoundCones) -> NDArray[np.float64]:
    """Return how far points lie outside the surface of each cone; negative inside.

    It is exact for cones that are not squeezed, and too small in size by the squeeze otherwise.

    Args:
        points: metres, shape (N, P, 3).
        cones: S of them in each of the N poses.

    Returns:
        Metres, shape (N, P, S).
    """
    away = points[:, :, None] - cones.origins[:, None]
    own = np.einsum('nskl,npsl->npsk', cones.inward, away)
    across = np.sqrt(own[..., 0] ** 2 + own[..., 2] ** 2)
    along = own[..., 1]
    first, second = cones.radii[:, 0], cones.radii[:, 1]
    length = np.maximum(cones.length, 1e-9)
    sine = np.clip((first - second) / length, -1.0, 1.0)
    cosine = np.sqrt(1 - sine**2)
    # The axis is closest along the normal of the slanted side, which leans by that angle; where
    # one sphere holds the other, that is the end of the larger.
    foot = np.clip(along - across * sine / np.maximum(cosine, 1e-9), 0.0, length)
    radius = first - (first - second) * foot / length
    distance: NDArray[np.float64] = np.sqrt(across**2 + (along - foot) ** 2) - radius
    return distance


def _own_frames(solids: Solids) -> NDArray[np.float64]:
    """Return each solid's axes as the columns of a rotation in its segment's frame, (S, 3, 3)."""
    frames = np.empty((len(solids.segment), 3, 3))
    for index, (start, end) in enumerate(solids.ends):
        axis = end - start
        length = np.sqrt((axis**2).sum())
        y = axis / length if length > 0 else np.array([0.0, 1.0, 0.0])
        # A solid that runs across the segment keeps its z instead.
        if abs(y[0]) < 0.7:
            x = np.array([1.0, 0.0, 0.0]) - y[0] * y
            x /= np.sqrt((x**2).sum())
            z = np.cross(x, y)
        else:
            z = np.array([0.0, 0.0, 1.0]) - y[2] * y
            z /= np.sqrt((z**2).sum())
            x = np.cross(y, z)
        frames[index] = np.stack([x, y, z], axis=1)
    return frames
