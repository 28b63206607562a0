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

A plane is written (a, b, c): a point that is seen in the direction (u, v, 1) at depth z lies on
it where z (a u + b v + c) = 1, before it where that is less. |(a, b, c)| is one over the plane's
distance from the camera, and (a, b, c) points from the camera to it. In this form a plane is a
linear function of 1 / z, in which the noise of stereo and structured light is even.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.segmentation.blobs import BARRIER

MOST_PLANES = 6

SAMPLE_COLUMNS = 80
"""The image is searched for planes in so many columns, or as many as it has."""

BAND = 0.03
NOISE = 0.004
"""A point belongs to a plane within BAND + NOISE z^2 cos(ray, normal), metres."""

PLANE_AREA = 1.0
"""Square metres of a wall that are seen at least; no body is so large and flat."""

FLOOR_AREA = 0.2
"""The same for a floor, of which a person who stands close leaves little to see."""

FLOOR_SLOPE = 0.6
"""A plane is a floor where its normal looks down at least so much, as a cosine."""

# Beyond this depth a sample weighs no more: a view through a door is no reason against a wall.
_FARTHEST_WEIGHT = 4.0

# Planes are guessed from rectangles of samples with these rows and columns, one in each place of
# a lattice. The flat one finds a floor of which the camera sees but a strip.
_RECTANGLES = ((2, 10), (4, 4), (8, 8))
_STRIDE = 4


class Samples(NamedTuple):
    """Points of the image on a coarse grid.

    Attributes:
        right: u of each column of the grid, shape (C,), float32.
        down: v of each row, shape (R,), float32.
        depth: metres, 0 where nothing was seen, shape (R, C), float32.
        solid_angle: what one sample stands for, in pixels of the direction (u, v).
    """

    right: NDArray[np.float32]
    down: NDArray[np.float32]
    depth: NDArray[np.float32]
    solid_angle: float


def take_samples(depth: NDArray[np.float32], camera: Intrinsics) -> Samples:
    """Return samples of a depth image, metres, shape (H, W)."""
    height, width = depth.shape
    stride = max(1, width // SAMPLE_COLUMNS)
    columns = np.arange(stride // 2, width, stride)
    rows = np.arange(stride // 2, height, stride)
    return Samples(
        ((columns - camera.cx) / camera.fx).astype(np.float32),
        ((rows - camera.cy) / camera.fy).astype(np.float32),
        np.ascontiguousarray(depth[rows[0] :: stride, columns[0] :: stride]),
        stride * stride / (camera.fx * camera.fy),
    )


def room_planes(depth: NDArray[np.float32], camera: Intrinsics) -> NDArray[np.float32]:
    """Return the planes of the room that a depth image shows, shape (P, 3), P <= MOST_PLANES.

    One after the other the plane is taken that has the most points on it, less those behind it,
    which a floor or a wall has not. The same image always gives the same planes.

    Args:
        depth: metres, 0 where the sensor saw nothing, shape (H, W).
        camera: the intrinsics.
    """
    samples = take_samples(depth, camera)
    free = samples.depth > 0
    planes = []
    for _ in range(MOST_PLANES):
        guessed, score = guess_plane(samples, free)
        if not score > 0:
            break
        plane = refine_plane(samples, free, refine_plane(samples, free, guessed))
        if is_boundary(samples, free, plane):
            planes.append(plane)
        take_away(samples, free, plane)
    return np.array(planes, np.float32).reshape(-1, 3)


@kernel
def guess_plane(samples: Samples, free: NDArray[np.bool_]) -> tuple[NDArray[np.float32], float]:
    """Return the plane through three samples that scores best, shape (3,), and its score.

    The score is the square metres, as if they faced the camera, of free samples on the plane,
    less those of any samples clearly behind it; 0 where there is no plane.
    """
    points, weights, costs = _score_points(samples, free)
    best, best_score = np.zeros(3, np.float32), 0.0
    rows, columns = samples.depth.shape
    for high, wide in _RECTANGLES:
        # From the last row up, for the floor is there.
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
                plane = _plane_through(samples, (row, bottom), (column, column + wide))
                if abs(_distance(samples, plane, bottom, column + wide)) > 1:
                    continue
                score = _score(points, weights, costs, plane)
                if score > best_score:
                    best, best_score = plane, score
    return best, best_score


@kernel
def _score_points(
    samples: Samples, free: NDArray[np.bool_]
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """Return every second sample of every second row: u, v and z, shape (3, S), and its weights.

    The first weight is for being on a plane, 0 where it is not free; the second for being behind.
    """
    rows, columns = samples.depth.shape
    points = np.empty((3, rows * columns), np.float32)
    weights, costs = np.empty(rows * columns, np.float32), np.empty(rows * columns, np.float32)
    count = 0
    for row in range(0, rows, 2):
        for column in range(0, columns, 2):
            z = samples.depth[row, column]
            if z > 0:
                points[0, count] = samples.right[column]
                points[1, count] = samples.down[row]
                points[2, count] = z
                cost = 4 * samples.solid_angle * min(z, np.float32(_FARTHEST_WEIGHT)) ** 2
                weights[count] = cost if free[row, column] else 0
                costs[count] = cost
                count += 1
    return points[:, :count].copy(), weights[:count], costs[:count]


@kernel
def _plane_through(
    samples: Samples, rows: tuple[int, int], columns: tuple[int, int]
) -> NDArray[np.float32]:
    """Return the plane through three corners of a rectangle of samples, all but the last."""
    u0, u1 = samples.right[columns[0]], samples.right[columns[1]]
    v0, v1 = samples.down[rows[0]], samples.down[rows[1]]
    here = 1 / samples.depth[rows[0], columns[0]]
    plane = np.empty(3, np.float32)
    plane[0] = (1 / samples.depth[rows[0], columns[1]] - here) / (u1 - u0)
    plane[1] = (1 / samples.depth[rows[1], columns[0]] - here) / (v1 - v0)
    plane[2] = here - plane[0] * u0 - plane[1] * v0
    return plane


@kernel
def _towards(samples: Samples, plane: NDArray[np.float32], row: int, column: int) -> float:
    """Return a u + b v + c: the plane's 1 / z in the direction of a sample."""
    towards: float = plane[0] * samples.right[column] + plane[1] * samples.down[row] + plane[2]
    return towards


@kernel
def _distance(samples: Samples, plane: NDArray[np.float32], row: int, column: int) -> float:
    """Return how far a sample is behind the plane, in units of what is allowed for being on it."""
    z = samples.depth[row, column]
    towards = _towards(samples, plane, row, column)
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
    samples: Samples, free: NDArray[np.bool_], plane: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Return the plane of least squares, in 1 / z, through the free samples on `plane`."""
    suu = suv = su = svv = sv = s1 = ru = rv = r1 = 0.0
    rows, columns = samples.depth.shape
    for row in range(rows):
        v = float(samples.down[row])
        for column in range(columns):
            if free[row, column] and abs(_distance(samples, plane, row, column)) <= 1:
                u = float(samples.right[column])
                inverse = 1.0 / samples.depth[row, column]
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
def is_boundary(samples: Samples, free: NDArray[np.bool_], plane: NDArray[np.float32]) -> bool:
    """Return whether a plane bounds the room: enough of it is seen, and little behind it."""
    norm = np.sqrt(plane[0] ** 2 + plane[1] ** 2 + plane[2] ** 2)
    area = score = 0.0
    rows, columns = samples.depth.shape
    for row in range(rows):
        for column in range(columns):
            z = samples.depth[row, column]
            if not z > 0:
                continue
            distance = _distance(samples, plane, row, column)
            weight = min(z, np.float32(_FARTHEST_WEIGHT)) ** 2
            if distance > 2:
                score -= weight
            elif abs(distance) <= 1 and free[row, column]:
                score += weight
                cosine = abs(_towards(samples, plane, row, column)) / norm
                area += z * z * samples.solid_angle / max(cosine, 0.05)
    floor = plane[1] > FLOOR_SLOPE * norm
    return score > 0 and area >= (FLOOR_AREA if floor else PLANE_AREA)


@kernel
def take_away(samples: Samples, free: NDArray[np.bool_], plane: NDArray[np.float32]) -> None:
    """Let the samples on a plane be free no longer."""
    rows, columns = samples.depth.shape
    for row in range(rows):
        for column in range(columns):
            if free[row, column] and abs(_distance(samples, plane, row, column)) <= 1:
                free[row, column] = False


@kernel
def without_planes(
    depth: NDArray[np.float32],
    planes: NDArray[np.float32],
    camera: Intrinsics,
    nearest: float,
    farthest: float,
) -> NDArray[np.float32]:
    """Return a depth image, shape (H, W), with a BARRIER at what can be no body.

    That is what lies on one of the planes, under a floor, or out of range.

    Args:
        depth: metres, 0 where the sensor saw nothing, shape (H, W).
        planes: the room's, shape (P, 3).
        camera: the intrinsics.
        nearest: metres; what is nearer is no body.
        farthest: metres; what is farther is no body.
    """
    height, width = depth.shape
    kept = np.empty((height, width), np.float32)
    right = np.empty(width, np.float32)
    for column in range(width):
        right[column] = (column - camera.cx) / camera.fx
    for row in range(height):
        line, given = kept[row], depth[row]
        down = np.float32((row - camera.cy) / camera.fy)
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
    down: np.float32,
    plane: NDArray[np.float32],
) -> None:
    """Put a BARRIER wherever one row of the image shows a plane, or something under a floor."""
    a, b, c = plane
    norm = np.sqrt(a * a + b * b + c * c)
    band, start = np.float32(BAND) * norm, b * down + c
    highest = np.float32(np.inf) if b > np.float32(FLOOR_SLOPE) * norm else np.float32(1)
    for column in range(len(line)):
        z = line[column]
        towards = start + a * right[column]
        behind = (z * towards - 1) / (band + np.float32(NOISE) * z * z * abs(towards))
        if z > 0 and -1 <= behind <= highest:
            line[column] = BARRIER
