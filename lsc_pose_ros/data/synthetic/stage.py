"""Where people stand before the camera: on one floor, in full view, not inside one another."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.core.camera import Intrinsics
from lsc_pose_ros.data.synthetic.solids import RoundCones
from lsc_pose_ros.errors import InputError

STEEPEST = np.radians(12.0)
"""The most by which the camera looks up or down."""

MARGIN = 3.0
"""Pixels that stay free between a person in full view and the image's edge."""

_TRIES = 300
_APART = np.radians(9.0)  # bearings of any two people differ by this, so that none is all hidden


class Spheres(NamedTuple):
    """Spheres that hold a person's solids, in a level frame with the person at its origin.

    Attributes:
        centres: metres, x right, y down, z away from the camera, y = 0 on the floor,
            shape (T, P, 3).
        radii: shape (P,).
    """

    centres: NDArray[np.float64]
    radii: NDArray[np.float64]


class Stage(NamedTuple):
    """The camera's tilt, and where the N people stand.

    Attributes:
        tilt: from the level frame into the camera's, shape (3, 3).
        offsets: each person's origin in the level frame at the camera, metres, shape (N, 3).
    """

    tilt: NDArray[np.float64]
    offsets: NDArray[np.float64]


class View(NamedTuple):
    """What the camera is to see.

    Attributes:
        camera: the intrinsics.
        width: of the image, pixels.
        height: of the image, pixels.
        distance: the nearest and the farthest that a person stands, metres.
        cropped: only the trunk has to be in view.
    """

    camera: Intrinsics
    width: int
    height: int
    distance: tuple[float, float]
    cropped: bool


def holding_spheres(cones: RoundCones) -> Spheres:
    """Return spheres that hold `cones`, origins (T, S, 3): two about the ends of each."""
    outward = np.linalg.inv(cones.inward)
    seconds = cones.origins + cones.length[:, None] * outward[..., 1]
    stretch = np.sqrt((outward[0] ** 2).sum(axis=1)).max(axis=1)
    return Spheres(
        np.concatenate([cones.origins, seconds], axis=1),
        np.concatenate([cones.radii[:, 0] * stretch, cones.radii[:, 1] * stretch]),
    )


def set_stage(people: list[Spheres], view: View, random: np.random.Generator) -> Stage:
    """Draw where `people` stand.

    Raises:
        InputError: no place is found for them.
    """
    framed = [_trunk(person) if view.cropped else person for person in people]
    for _ in range(_TRIES):
        stage = _try_stage(people, framed, view, random)
        if stage is not None:
            return stage
    near, far = view.distance
    who = 'a person' if len(people) == 1 else f'{len(people)} people'
    msg = (
        f'no place found for {who} in full view between {near:g} and {far:g} m; '
        f'allow a larger distance or field of view, fewer or smaller people, or cropped ones'
    )
    raise InputError(msg)


def _try_stage(
    people: list[Spheres], framed: list[Spheres], view: View, random: np.random.Generator
) -> Stage | None:
    tilt = _tilt(STEEPEST * (2 * random.random() - 1))
    edges = [_Edge(person, tilt, view) for person in framed]
    lowest, highest = -np.inf, np.inf
    distances = []
    for edge in edges:
        near = max(view.distance[0], edge.nearest())
        if near > view.distance[1]:
            return None
        distances.append(near + (view.distance[1] - near) * random.random())
        low, high = edge.heights(distances[-1])
        lowest, highest = max(lowest, low), min(highest, high)
    chances = random.random(1 + len(people))
    if lowest > highest:
        return None
    height = lowest + (highest - lowest) * chances[0]
    offsets = []
    for edge, distance, chance in zip(edges, distances, chances[1:], strict=True):
        left, right = edge.sideways(height, distance)
        if left > right:
            return None
        offsets.append((left + (right - left) * chance, height, distance))
    stage = Stage(tilt, np.array(offsets))
    return stage if _apart(people, stage.offsets) else None


class _Edge:
    """The four planes through the camera and the image's edges, held against one person.

    A sphere (p, r) is on the inner side of the plane with normal n where n . p + r |n| <= 0.
    In the level frame, with the person moved by (X, h, Z), this is linear in X, h and Z.
    """

    def __init__(self, person: Spheres, tilt: NDArray[np.float64], view: View) -> None:
        camera = view.camera
        free = 0.0 if view.cropped else MARGIN
        left = (camera.cx - free) / camera.fx
        right = (view.width - 1 - free - camera.cx) / camera.fx
        top = (camera.cy - free) / camera.fy
        bottom = (view.height - 1 - free - camera.cy) / camera.fy
        normals = np.array([[-1, 0, -left], [1, 0, -right], [0, -1, -top], [0, 1, -bottom]])
        # n . (R p) = (R^T n) . p
        self.normals = normals @ tilt
        lengths = np.sqrt((normals**2).sum(axis=1))
        reach = person.centres @ self.normals.T + person.radii[:, None] * lengths
        self.reach = reach.reshape(-1, 4).max(axis=0)

    def nearest(self) -> float:
        """Return the least distance at which the person fits between top and bottom."""
        (_, top_y, top_z), (_, bottom_y, bottom_z) = self.normals[2:]
        # heights(Z) = [(reach_top + top_z Z) / -top_y, -(reach_bottom + bottom_z Z) / bottom_y]
        fixed = -self.reach[3] / bottom_y - self.reach[2] / -top_y
        slope = -bottom_z / bottom_y - top_z / -top_y
        return float(-fixed / slope)

    def heights(self, distance: float) -> tuple[float, float]:
        """Return how low and how high the camera may be over the floor."""
        (_, top_y, top_z), (_, bottom_y, bottom_z) = self.normals[2:]
        low = (self.reach[2] + top_z * distance) / -top_y
        high = -(self.reach[3] + bottom_z * distance) / bottom_y
        return float(low), float(high)

    def sideways(self, height: float, distance: float) -> tuple[float, float]:
        """Return how far left and how far right the person may stand."""
        moved = self.reach + self.normals @ np.array([0.0, height, distance])
        left = moved[0] / -self.normals[0, 0]
        right = -moved[1] / self.normals[1, 0]
        return float(left), float(right)


def _tilt(angle: float) -> NDArray[np.float64]:
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])


def _trunk(person: Spheres) -> Spheres:
    """Return the middle of a person alone: what must stay in view of one who may be cropped."""
    middle = person.centres.mean(axis=1, keepdims=True)
    return Spheres(middle, np.array([0.15]))


def _apart(people: list[Spheres], offsets: NDArray[np.float64]) -> bool:
    """Tell whether no two people touch in any frame or stand in one line of sight."""
    for one in range(len(people)):
        for other in range(one):
            bearings = np.arctan2(offsets[[one, other], 0], offsets[[one, other], 2])
            if abs(bearings[0] - bearings[1]) < _APART:
                return False
            gap = offsets[one] - offsets[other]
            first = people[one].centres[:, :, None] + gap
            away = np.sqrt(((first - people[other].centres[:, None]) ** 2).sum(axis=-1))
            if (away < people[one].radii[:, None] + people[other].radii).any():
                return False
    return True
