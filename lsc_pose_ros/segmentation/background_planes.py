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

"""Floor, walls and ceiling: the large planes of a depth image with nothing behind them.

A plane is given by (a, b, c): a point in the direction (u, v, 1) at depth z lies on the plane if
z (a u + b v + c) = 1, and in front of it if the value is smaller. |(a, b, c)| is the inverse of
the distance of the plane from the camera, and (a, b, c) points from the camera to the plane. In
this form the plane is linear in 1 / z, in which the noise of stereo and structured light is
uniform.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.rays import ImageRays, image_rays
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.segmentation.blobs import BARRIER

MOST_PLANES = 6

SAMPLE_COLUMNS = 80
"""Number of columns of the grid in which planes are searched; fewer if the image is smaller."""

BAND = 0.03
NOISE = 0.004
"""A point belongs to a plane within BAND + NOISE z^2 cos(ray, normal), metres."""

PLANE_AREA = 1.0
"""The least visible area of a wall, square metres; no body is so large and flat."""

FLOOR_AREA = 0.2
"""The least visible area of a floor, square metres; a person close to the camera hides much."""

FLOOR_SLOPE = 0.6
"""A plane is a floor if the cosine between its normal and down is at least this."""

# Samples beyond this depth have the same weight, so that a view through a door does not exclude a
# wall.
_FARTHEST_WEIGHT = 4.0

# Planes are proposed from rectangles of samples with these numbers of rows and columns, at the
# positions of a lattice. The flat rectangle finds a floor of which only a strip is visible.
_RECTANGLES = ((2, 10), (4, 4), (8, 8))
_STRIDE = 4


class DepthGrid(NamedTuple):
    """A depth image sampled on a coarse grid.

    Attributes:
        right: u of each sample, shape (R, C), float32.
        down: v of each sample, shape (R, C), float32.
        depth: metres, 0 if unknown, shape (R, C), float32.
        area: the area of each sample in the plane of (u, v), shape (R, C), float32.
    """

    right: NDArray[np.float32]
    down: NDArray[np.float32]
    depth: NDArray[np.float32]
    area: NDArray[np.float32]


def sample_depth(depth: NDArray[np.float32], camera: Intrinsics) -> DepthGrid:
    """Return the grid of a depth image, metres, shape (H, W)."""
    height, width = depth.shape
    stride = max(1, width // SAMPLE_COLUMNS)
    samples = slice(stride // 2, None, stride)
    rays = image_rays(camera, height, width)
    right, down, area = (np.ascontiguousarray(each[1:-1, 1:-1][samples, samples]) for each in rays)
    sampled = np.ascontiguousarray(depth[samples, samples])
    return DepthGrid(right, down, sampled, np.float32(stride * stride) * area)


def find_background_planes(depth: NDArray[np.float32], camera: Intrinsics) -> NDArray[np.float32]:
    """Return floor, walls and ceiling of a depth image as planes, shape (P, 3), P <= MOST_PLANES.

    Planes are found greedily: the best one has the most points on it, minus the points behind it,
    which a floor or a wall does not have. The result is deterministic.

    Args:
        depth: metres, 0 if unknown, shape (H, W).
        camera: the intrinsics.
    """
    grid = sample_depth(depth, camera)
    free = grid.depth > 0
    planes = []
    for _ in range(MOST_PLANES):
        proposed, score = propose_plane(grid, free)
        if not score > 0:
            break
        plane = refine_plane(grid, free, refine_plane(grid, free, proposed))
        if is_boundary(grid, free, plane):
            planes.append(plane)
        mark_plane(grid, free, plane)
    return np.array(planes, np.float32).reshape(-1, 3)


@kernel
def propose_plane(grid: DepthGrid, free: NDArray[np.bool_]) -> tuple[NDArray[np.float32], float]:
    """Return the plane through three samples that scores best, shape (3,), and its score.

    The score is the area of the free samples on the plane minus the area of all samples clearly
    behind it, in square metres as if they faced the camera; 0 if there is no plane.

    Args:
        grid: the depth image.
        free: whether a sample is on none of the planes so far, shape (R, C).
    """
    points, weights, costs = _score_points(grid, free)
    best, best_score = np.zeros(3, np.float32), 0.0
    rows, columns = grid.depth.shape
    for high, wide in _RECTANGLES:
        # Upwards from the last row, because the floor is at the bottom.
        for bottom in range(rows - 1, high - 1, -min(high, _STRIDE)):
            row = bottom - high
            for column in range(0, columns - wide, _STRIDE):
                if not (
                    free[row, column]
                    and free[bottom, column]
                    and free[row, column + wide]
                    and free[bottom, column + wide]
                ):
                    continue
                plane = _plane_through(grid, (row, column), (row, column + wide), (bottom, column))
                if abs(_distance(grid, plane, bottom, column + wide)) > 1:
                    continue
                score = _score(points, weights, costs, plane)
                if score > best_score:
                    best, best_score = plane, score
    return best, best_score


@kernel
def _score_points(
    grid: DepthGrid, free: NDArray[np.bool_]
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """Return u, v and z of every second sample of every second row, shape (3, S), and two weights.

    The first weight counts for a plane through the sample, and is 0 if it is not free. The second
    counts against a plane in front of it.
    """
    rows, columns = grid.depth.shape
    points = np.empty((3, rows * columns), np.float32)
    weights, costs = np.empty(rows * columns, np.float32), np.empty(rows * columns, np.float32)
    count = 0
    for row in range(0, rows, 2):
        for column in range(0, columns, 2):
            z = grid.depth[row, column]
            if z > 0:
                points[0, count] = grid.right[row, column]
                points[1, count] = grid.down[row, column]
                points[2, count] = z
                cost = 4 * grid.area[row, column] * min(z, np.float32(_FARTHEST_WEIGHT)) ** 2
                weights[count] = cost if free[row, column] else 0
                costs[count] = cost
                count += 1
    return points[:, :count].copy(), weights[:count], costs[:count]


@kernel
def _plane_through(
    grid: DepthGrid, first: tuple[int, int], second: tuple[int, int], third: tuple[int, int]
) -> NDArray[np.float32]:
    """Return the plane through three samples, given by their rows and columns."""
    inverse = 1 / grid.depth[first]
    u1, v1 = grid.right[second] - grid.right[first], grid.down[second] - grid.down[first]
    u2, v2 = grid.right[third] - grid.right[first], grid.down[third] - grid.down[first]
    rise1, rise2 = 1 / grid.depth[second] - inverse, 1 / grid.depth[third] - inverse
    whole = u1 * v2 - u2 * v1
    plane = np.empty(3, np.float32)
    plane[0] = (rise1 * v2 - rise2 * v1) / whole
    plane[1] = (u1 * rise2 - u2 * rise1) / whole
    plane[2] = inverse - plane[0] * grid.right[first] - plane[1] * grid.down[first]
    return plane


@kernel
def _inverse_depth(grid: DepthGrid, plane: NDArray[np.float32], row: int, column: int) -> float:
    """Return a u + b v + c: 1 / z of the plane in the direction of a sample."""
    right, down = grid.right[row, column], grid.down[row, column]
    inverse: float = plane[0] * right + plane[1] * down + plane[2]
    return inverse


@kernel
def _distance(grid: DepthGrid, plane: NDArray[np.float32], row: int, column: int) -> float:
    """Return the signed distance of a sample behind the plane, in units of the tolerance."""
    z = grid.depth[row, column]
    towards = _inverse_depth(grid, plane, row, column)
    norm = np.sqrt(plane[0] ** 2 + plane[1] ** 2 + plane[2] ** 2)
    distance: float = (z * towards - 1) / (BAND * norm + NOISE * z * z * abs(towards))
    return distance


@kernel
def _score(
    points: NDArray[np.float32],
    weights: NDArray[np.float32],
    costs: NDArray[np.float32],
    plane: NDArray[np.float32],
) -> float:
    a, b, c = plane
    band = np.float32(BAND) * np.sqrt(a * a + b * b + c * c)
    score = np.float32(0)
    right, down, depth = points[0], points[1], points[2]
    for index in range(len(weights)):
        z = depth[index]
        towards = a * right[index] + b * down[index] + c
        behind = z * towards - 1
        allowed = band + np.float32(NOISE) * z * z * abs(towards)
        on_it = weights[index] if abs(behind) <= allowed else np.float32(0)
        score += on_it - (costs[index] if behind > 2 * allowed else np.float32(0))
    return float(score)


@kernel
def refine_plane(
    grid: DepthGrid, free: NDArray[np.bool_], plane: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Return the least-squares plane, in 1 / z, through the free samples on `plane`."""
    suu = suv = su = svv = sv = s1 = ru = rv = r1 = 0.0
    rows, columns = grid.depth.shape
    for row in range(rows):
        for column in range(columns):
            if free[row, column] and abs(_distance(grid, plane, row, column)) <= 1:
                u, v = float(grid.right[row, column]), float(grid.down[row, column])
                inverse = 1.0 / grid.depth[row, column]
                suu, suv, su = suu + u * u, suv + u * v, su + u
                svv, sv, s1 = svv + v * v, sv + v, s1 + 1
                ru, rv, r1 = ru + u * inverse, rv + v * inverse, r1 + inverse
    # Cramer's rule for [[suu suv su] [suv svv sv] [su sv s1]] plane = [ru rv r1].
    xx, xy, xz = svv * s1 - sv * sv, sv * su - suv * s1, suv * sv - svv * su
    yy, yz, zz = suu * s1 - su * su, su * suv - suu * sv, suu * svv - suv * suv
    whole = suu * xx + suv * xy + su * xz
    if not whole > 0:
        return plane
    refined = np.empty(3, np.float32)
    refined[0] = (xx * ru + xy * rv + xz * r1) / whole
    refined[1] = (xy * ru + yy * rv + yz * r1) / whole
    refined[2] = (xz * ru + yz * rv + zz * r1) / whole
    return refined


@kernel
def is_boundary(grid: DepthGrid, free: NDArray[np.bool_], plane: NDArray[np.float32]) -> bool:
    """Return whether a plane bounds the room: much of it is visible, and little is behind it."""
    norm = np.sqrt(plane[0] ** 2 + plane[1] ** 2 + plane[2] ** 2)
    area = score = 0.0
    rows, columns = grid.depth.shape
    for row in range(rows):
        for column in range(columns):
            z = grid.depth[row, column]
            if not z > 0:
                continue
            distance = _distance(grid, plane, row, column)
            weight = min(z, np.float32(_FARTHEST_WEIGHT)) ** 2
            if distance > 2:
                score -= weight
            elif abs(distance) <= 1 and free[row, column]:
                score += weight
                cosine = abs(_inverse_depth(grid, plane, row, column)) / norm
                area += z * z * grid.area[row, column] / max(cosine, 0.05)
    floor = plane[1] > FLOOR_SLOPE * norm
    return score > 0 and area >= (FLOOR_AREA if floor else PLANE_AREA)


@kernel
def mark_plane(grid: DepthGrid, free: NDArray[np.bool_], plane: NDArray[np.float32]) -> None:
    """Mark the samples on a plane as not free."""
    rows, columns = grid.depth.shape
    for row in range(rows):
        for column in range(columns):
            if free[row, column] and abs(_distance(grid, plane, row, column)) <= 1:
                free[row, column] = False


@kernel
def remove_planes(
    depth: NDArray[np.float32],
    planes: NDArray[np.float32],
    rays: ImageRays,
    nearest: float,
    farthest: float,
) -> NDArray[np.float32]:
    """Return the depth image with a BARRIER at pixels that cannot be a body, shape (H, W).

    These are on one of the planes, below a floor, or out of range.

    Args:
        depth: metres, 0 if unknown, shape (H, W).
        planes: planes of the room, shape (P, 3).
        rays: the rays of the image.
        nearest: metres; nearer pixels are no body.
        farthest: metres; farther pixels are no body.
    """
    height, width = depth.shape
    kept = np.empty((height, width), np.float32)
    for row in range(height):
        line, given = kept[row], depth[row]
        # The rays have a margin of one pixel.
        right, down = rays.right[row + 1, 1 : width + 1], rays.down[row + 1, 1 : width + 1]
        for column in range(width):
            z = given[column]
            in_range = nearest <= z <= farthest
            line[column] = z if in_range or not z > 0 else BARRIER
        for index in range(len(planes)):
            _block_plane(line, right, down, planes[index])
    return kept


@kernel
def _block_plane(
    line: NDArray[np.float32],
    right: NDArray[np.float32],
    down: NDArray[np.float32],
    plane: NDArray[np.float32],
) -> None:
    """Put a BARRIER at the pixels of one row that are on a plane, or below it if it is a floor."""
    a, b, c = plane
    norm = np.sqrt(a * a + b * b + c * c)
    band = np.float32(BAND) * norm
    highest = np.float32(np.inf) if b > np.float32(FLOOR_SLOPE) * norm else np.float32(1)
    for column in range(len(line)):
        z = line[column]
        towards = a * right[column] + b * down[column] + c
        behind = (z * towards - 1) / (band + np.float32(NOISE) * z * z * abs(towards))
        if z > 0 and -1 <= behind <= highest:
            line[column] = BARRIER
