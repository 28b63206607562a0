"""Draws round cones into a depth image and a mask, each pixel's ray met analytically."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.core.camera import Intrinsics
from lsc_pose_ros.core.frame import NO_BODY
from lsc_pose_ros.core.jit import kernel
from lsc_pose_ros.data.synthetic.solids import RoundCones


class Image(NamedTuple):
    """What the camera sees.

    Attributes:
        depth: metres, 0 where there is nothing, shape (H, W), float32.
        labels: the body that a pixel shows, or NO_BODY, shape (H, W), int32.
    """

    depth: NDArray[np.float32]
    labels: NDArray[np.int32]


def render(
    cones: RoundCones, bodies: NDArray[np.int32], camera: Intrinsics, width: int, height: int
) -> Image:
    """Draw solids; the nearest surface hides what is behind it.

    Args:
        cones: S solids in the camera's optical frame, origins (S, 3), metres.
        bodies: the number of the body that each belongs to, shape (S,).
        camera: the intrinsics.
        width: of the image, pixels.
        height: of the image, pixels.

    Returns:
        Depth and mask.
    """
    depth = np.full((height, width), np.inf)
    labels = np.full((height, width), NO_BODY, np.int32)
    boxes = bounding_boxes(cones, camera, width, height)
    # The last bits of sines differ between libraries; a nanometre decides nothing.
    rounded = RoundCones(*(np.round(field, 9) for field in cones))
    draw_cones(rounded, boxes, bodies, camera, depth, labels)
    depth[labels == NO_BODY] = 0.0
    return Image(depth.astype(np.float32), labels)


def bounding_boxes(
    cones: RoundCones, camera: Intrinsics, width: int, height: int
) -> NDArray[np.int64]:
    """Return the pixels that each solid may cover: first and last column, first and last row.

    In space a solid is the hull of two ellipsoids with centre c and covariance S; the plane
    x = u z touches one where u solves D_zz u^2 - 2 D_xz u + D_xx = 0 with D = S - c c^T.

    Args:
        cones: S solids in the optical frame.
        camera: the intrinsics.
        width: of the image, pixels.
        height: of the image, pixels.

    Returns:
        Inclusive, within the image, shape (S, 4); the last comes before the first where there is
        nothing to draw. A solid that reaches behind the camera gets the whole image.
    """
    outward = np.linalg.inv(cones.inward)
    spread = outward @ outward.transpose(0, 2, 1)
    first = cones.origins
    second = cones.origins + cones.length[:, None] * outward[:, :, 1]
    lows, highs, behind = [], [], np.zeros(len(first), bool)
    for centre, radius in ((first, cones.radii[:, 0]), (second, cones.radii[:, 1])):
        dual = radius[:, None, None] ** 2 * spread - centre[:, :, None] * centre[:, None, :]
        behind |= (dual[:, 2, 2] >= 0) | (centre[:, 2] <= 0)
        scale = np.where(dual[:, 2, 2] < 0, dual[:, 2, 2], -1.0)
        middle = dual[:, :2, 2] / scale[:, None]
        own = dual[:, [0, 1], [0, 1]] / scale[:, None]
        half = np.sqrt(np.maximum(middle**2 - own, 0))
        lows.append(middle - half)
        highs.append(middle + half)
    focal, principal = np.array(camera[:2]), np.array(camera[2:])
    size = np.array([width, height])
    limit = 1e6  # keeps what is far outside within integers
    low = np.clip(np.ceil(np.minimum(*lows) * focal + principal), -limit, limit)
    high = np.clip(np.floor(np.maximum(*highs) * focal + principal), -limit, limit)
    low = np.where(behind[:, None], 0, np.maximum(low, 0))
    high = np.where(behind[:, None], size - 1, np.minimum(high, size - 1))
    return np.stack([low[:, 0], high[:, 0], low[:, 1], high[:, 1]], axis=1).astype(np.int64)


@kernel
def meet_cone(
    origin: tuple[float, float, float],
    ray: tuple[float, float, float],
    length: float,
    first: float,
    second: float,
) -> float:
    """Return the smallest t > 0 at which origin + t ray meets a round cone, or infinity.

    All in the cone's own frame. The side is rho cos(a) = r0 - y sin(a), sin(a) = (r0 - r1) / h,
    between the circles in which it touches the two spheres.
    """
    ox, oy, oz = origin
    dx, dy, dz = ray
    nearest = math.inf
    # Where one sphere holds the other there is no side.
    if length > abs(first - second):
        sine = (first - second) / length
        cosine2 = 1.0 - sine * sine
        level = first - sine * oy
        a = cosine2 * (dx * dx + dz * dz) - sine * sine * dy * dy
        b = cosine2 * (ox * dx + oz * dz) + level * sine * dy
        c = cosine2 * (ox * ox + oz * oz) - level * level
        inside = b * b - a * c
        if inside >= 0.0 and a != 0.0:
            root = math.sqrt(inside)
            for t in ((-b - root) / a, (-b + root) / a):
                y = oy + t * dy
                if first * sine <= y <= length + second * sine and 0.0 < t < nearest:
                    nearest = t
    dd = dx * dx + dy * dy + dz * dz
    for centre, radius in ((0.0, first), (length, second)):
        py = oy - centre
        b = ox * dx + py * dy + oz * dz
        c = ox * ox + py * py + oz * oz - radius * radius
        inside = b * b - dd * c
        if inside >= 0.0:
            t = (-b - math.sqrt(inside)) / dd
            if 0.0 < t < nearest:
                nearest = t
    return nearest


@kernel
def draw_cones(
    cones: RoundCones,
    boxes: NDArray[np.int64],
    bodies: NDArray[np.int32],
    camera: Intrinsics,
    depth: NDArray[np.float64],
    labels: NDArray[np.int32],
) -> None:
    """Draw solids into `depth` (infinity where empty) and `labels`, both shape (H, W).

    A pixel's ray is (x, y, 1), so where it meets a surface, t is the depth.
    """
    for solid in range(len(boxes)):
        turn, place = cones.inward[solid], cones.origins[solid]
        origin = (
            -(turn[0, 0] * place[0] + turn[0, 1] * place[1] + turn[0, 2] * place[2]),
            -(turn[1, 0] * place[0] + turn[1, 1] * place[1] + turn[1, 2] * place[2]),
            -(turn[2, 0] * place[0] + turn[2, 1] * place[1] + turn[2, 2] * place[2]),
        )
        length, first, second = cones.length[solid], cones.radii[solid, 0], cones.radii[solid, 1]
        for row in range(boxes[solid, 2], boxes[solid, 3] + 1):
            y = (row - camera.cy) / camera.fy
            for column in range(boxes[solid, 0], boxes[solid, 1] + 1):
                x = (column - camera.cx) / camera.fx
                ray = (
                    turn[0, 0] * x + turn[0, 1] * y + turn[0, 2],
                    turn[1, 0] * x + turn[1, 1] * y + turn[1, 2],
                    turn[2, 0] * x + turn[2, 1] * y + turn[2, 2],
                )
                t = meet_cone(origin, ray, length, first, second)
                if t < depth[row, column]:
                    depth[row, column] = t
                    labels[row, column] = bodies[solid]
