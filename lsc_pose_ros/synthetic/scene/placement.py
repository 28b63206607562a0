"""Where camera and people are: people on one floor, in full view, not touching one another."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.errors import InputError

MARGIN = 3.0
"""Pixels that stay free between a person in full view and the image's edge."""

GAP = 0.05
"""Metres that stay free between two people."""

_TRIES = 200  # heights and tilts of the camera
_PLACES = 8  # for each person with each
_APART = np.radians(9.0)  # bearings of any two people differ by this, so that none is all hidden

# Horizontal directions in which people are held apart.
_ANGLES = np.arange(16) * (np.pi / 8)
_ASIDE = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=1)


class Actor(NamedTuple):
    """The outermost points of a person in T frames.

    In a level frame at the floor under the person's pelvis: x right, y down, z away from the
    camera.

    Attributes:
        points: of the skin, metres, shape (T, P, 3).
        trunk: the middle of the trunk, which stays in view of who may be cropped, (T, 3).
    """

    points: NDArray[np.float64]
    trunk: NDArray[np.float64]


class Stage(NamedTuple):
    """The camera's tilt, and where the N people stand.

    Attributes:
        tilt: from the level frame into the camera's, shape (3, 3).
        offsets: each person's origin in the level frame at the camera, metres, shape (N, 3); y is
            the camera's height over the floor.
    """

    tilt: NDArray[np.float64]
    offsets: NDArray[np.float64]


class View(NamedTuple):
    """What the camera is to see, and from where.

    Attributes:
        camera: the intrinsics.
        width: of the image, pixels.
        height: of the image, pixels.
        distance: the nearest and the farthest that a person stands, metres.
        above: the lowest and the highest that the camera is over the floor, metres.
        tilt: by how little and by how much it looks down, radians; negative is up.
        cropped: only the trunk has to be in view.
    """

    camera: Intrinsics
    width: int
    height: int
    distance: tuple[float, float]
    above: tuple[float, float]
    tilt: tuple[float, float]
    cropped: bool


def set_stage(actors: Sequence[Actor], view: View, random: np.random.Generator) -> Stage:
    """Draw where the camera is and where `actors` stand.

    Raises:
        InputError: no place is found for them.
    """
    framed = [_framed(actor, view) for actor in actors]
    reaches = [_reach(actor.points) for actor in actors]
    # Each try has its own chances, so that it does not depend on how the others ended.
    for chances in random.random((_TRIES, 1 + len(actors) * _PLACES, 2)):
        stage = _try_stage(framed, reaches, view, chances)
        if stage is not None:
            return stage
    near, far = view.distance
    who = 'a person' if len(actors) == 1 else f'{len(actors)} people'
    msg = (
        f'no place found for {who} in full view between {near:g} and {far:g} m; allow a larger '
        f"distance or field of view, more of the camera's heights and tilts, fewer or smaller "
        f'people, or cropped ones'
    )
    raise InputError(msg)


def tilt_matrix(angle: float) -> NDArray[np.float64]:
    """Return the turn from a level frame into that of a camera that looks down by `angle`."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])


def _try_stage(
    framed: list[NDArray[np.float64]],
    reaches: list[NDArray[np.float64]],
    view: View,
    chances: NDArray[np.float64],
) -> Stage | None:
    tilt = tilt_matrix(_between(view.tilt, chances[0, 0]))
    height = _between(view.above, chances[0, 1])
    offsets: list[NDArray[np.float64]] = []
    for person, points in enumerate(framed):
        edge = _Edge(points, tilt, view)
        near, far = edge.distances(height, view.distance)
        if near > far:
            return None
        for sideways, away in chances[1 + person * _PLACES :][:_PLACES]:
            distance = _between((near, far), away)
            left, right = edge.sideways(height, distance)
            offset = np.array([_between((left, right), sideways), height, distance])
            if left <= right and _is_apart(reaches, offsets, offset):
                offsets.append(offset)
                break
        else:
            return None
    return Stage(tilt, np.array(offsets))


def _between(ends: tuple[float, float], chance: float) -> float:
    return float(ends[0] + (ends[1] - ends[0]) * chance)


class _Edge:
    """The four planes through the camera and the image's edges, held against one person.

    A point p is on the inner side of the plane with normal n where n . p <= 0. In the level
    frame, with the person moved by (X, h, Z), this is linear in X, h and Z.
    """

    def __init__(self, points: NDArray[np.float64], tilt: NDArray[np.float64], view: View) -> None:
        camera = view.camera
        free = 0.0 if view.cropped else MARGIN
        left = (camera.cx - free) / camera.fx
        right = (view.width - 1 - free - camera.cx) / camera.fx
        top = (camera.cy - free) / camera.fy
        bottom = (view.height - 1 - free - camera.cy) / camera.fy
        normals = np.array([[-1, 0, -left], [1, 0, -right], [0, -1, -top], [0, 1, -bottom]])
        # n . (R p) = (R^T n) . p
        self.normals = normals @ tilt
        self.reach = (points @ self.normals.T).max(axis=0)

    def distances(self, height: float, within: tuple[float, float]) -> tuple[float, float]:
        """Return how near and how far the person fits between top and bottom of the image."""
        near, far = within
        for normal, reach in zip(self.normals[2:], self.reach[2:], strict=True):
            fixed, slope = reach + normal[1] * height, normal[2]
            if slope < 0:  # the farther, the better
                near = max(near, -fixed / slope)
            elif slope > 0:
                far = min(far, -fixed / slope)
            elif fixed > 0:
                return 1.0, 0.0
        return float(near), float(far)

    def sideways(self, height: float, distance: float) -> tuple[float, float]:
        """Return how far left and how far right the person may stand."""
        moved = self.reach + self.normals @ np.array([0.0, height, distance])
        left = moved[0] / -self.normals[0, 0]
        right = -moved[1] / self.normals[1, 0]
        return float(left), float(right)


def _framed(actor: Actor, view: View) -> NDArray[np.float64]:
    """Return the points that have to be in view, shape (N, 3)."""
    points = actor.points
    if view.cropped:
        corners = np.array([(x, y, 0.0) for x in (-0.15, 0.15) for y in (-0.15, 0.15)])
        points = actor.trunk[:, None] + corners
    return points.reshape(-1, 3)


def _reach(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how far a person reaches in each of the directions `_ASIDE`, shape (T, 16)."""
    level = points[..., [0, 2]]
    reach: NDArray[np.float64] = (level @ _ASIDE.T).max(axis=1)
    return reach


def _is_apart(
    reaches: list[NDArray[np.float64]],
    offsets: list[NDArray[np.float64]],
    offset: NDArray[np.float64],
) -> bool:
    """Tell whether the next person, at `offset`, touches or stands behind none of those before.

    Two people are apart where a vertical plane is between them.
    """
    opposite = (np.arange(len(_ASIDE)) + len(_ASIDE) // 2) % len(_ASIDE)
    own = reaches[len(offsets)][:, opposite]
    for reach, other in zip(reaches, offsets, strict=False):
        bearings = np.arctan2([other[0], offset[0]], [other[2], offset[2]])
        if abs(bearings[0] - bearings[1]) < _APART:
            return False
        gaps = _ASIDE @ (offset - other)[[0, 2]] - reach - own
        if (gaps.max(axis=1) < GAP).any():
            return False
    return True
