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


"""Tells people apart: each cell belongs to the person for whose middle it votes.

The network says of each cell how far away the middle of its person is, over what is visible of
the person. The votes of one person meet there, also those of an arm or of legs that something cuts
off from the rest (A. Kendall and R. Cipolla call it a learnt Hough voting; B. Cheng et al.,
"Panoptic-DeepLab", CVPR 2020, group pixels in this way).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.segmentation.person_cells import PersonCells

VOXEL = 0.1
"""Votes are counted in cubes of this size to find where they meet, metres."""

REACH = 0.45
"""Votes farther from a middle do not belong to it, metres."""

SPACING = 0.3
"""The least distance of two people's middles, metres."""

STEPS = 3
"""The number of mean-shift steps to each middle."""

LEAST_AREA = 0.05
"""A body with a smaller visible area is none, square metres."""

LEAST_PERSON = 0.75
"""The least mean probability that the cells of a body show a person."""

SMALL_AREA, SMALL_DOUBT = 0.2, 0.1
"""Of a body with a smaller visible area, square metres, it must be larger by so much."""

FAR, FAR_DOUBT = 4.0, 0.05
"""Of a body at a larger depth, metres, it must be larger by so much per metre of noisy depth."""

MOST_PEOPLE = 32
"""No more people are found in one image."""


class Bodies(NamedTuple):
    """The people that were found, those with the most evidence first.

    Attributes:
        body: the index of the person of each cell, -1 for none, shape (N,), int32.
        area: the visible area of each person, square metres, shape (B,).
        person: the mean probability that the cells of each show a person, shape (B,).
    """

    body: NDArray[np.int32]
    area: NDArray[np.float64]
    person: NDArray[np.float64]


@kernel
def find_bodies(cells: PersonCells) -> Bodies:
    """Return the people in the cells, those with the most evidence first."""
    middles = find_middles(cells)
    body = nearest_middles(cells, middles)
    area, person = measure_bodies(cells, body, middles.shape[0])
    certain = area >= LEAST_AREA
    for b in range(middles.shape[0]):
        certain[b] = certain[b] and person[b] >= least_person(area[b], middles[b, 2])
    order = np.argsort(-area * person)
    rank = np.full(middles.shape[0], -1, np.int32)
    kept = np.empty(middles.shape[0], np.int64)
    count = 0
    for b in order:
        if certain[b]:
            rank[b], kept[count] = count, b
            count += 1
    for n in range(body.shape[0]):
        if body[n] >= 0:
            body[n] = rank[body[n]]
    return Bodies(body, area[kept[:count]], person[kept[:count]])


@kernel
def least_person(area: float, depth: float) -> float:
    """Return the least mean probability of a body that is a person.

    Args:
        area: its visible area, square metres.
        depth: of its middle, metres.
    """
    doubt = SMALL_DOUBT if area < SMALL_AREA else 0.0
    return LEAST_PERSON + doubt + FAR_DOUBT * max(depth - FAR, 0.0)


@kernel
def find_middles(cells: PersonCells) -> NDArray[np.float64]:
    """Return the places where votes meet, metres, shape (B, 3), those with most votes first.

    A vote weighs the probability times the area of its cell. The heaviest cube of votes, with the
    cubes around it, is where a mean-shift begins; the votes near its end are then left out.
    """
    left = cells.person * cells.area
    voxel = np.floor(cells.vote / np.float32(VOXEL)).astype(np.int64)
    middles = np.empty((MOST_PEOPLE, 3))
    count = 0
    while count < MOST_PEOPLE:
        heaviest, weight = heaviest_voxel(voxel, left)
        if weight < LEAST_AREA * LEAST_PERSON:
            break
        middle = middles[count]
        for k in range(3):
            middle[k] = (heaviest[k] + 0.5) * VOXEL
        for _ in range(STEPS):
            shift(cells, left, middle)
        if distance_to_nearest(middle, middles[:count]) >= SPACING:
            count += 1
            leave_out(cells, left, middle)
        else:  # the rest of somebody's votes
            for n in range(left.shape[0]):
                if is_beside(voxel[n], heaviest):
                    left[n] = 0
    return middles[:count]


@kernel
def distance_to_nearest(position: NDArray[np.float64], others: NDArray[np.float64]) -> float:
    """Return the distance to the nearest of the other positions, infinity if there are none."""
    nearest = np.inf
    for b in range(others.shape[0]):
        nearest = min(nearest, squared_distance(position, others[b]))
    distance: float = np.sqrt(nearest)
    return distance


@kernel
def leave_out(
    cells: PersonCells, weight: NDArray[np.float32], middle: NDArray[np.float64]
) -> None:
    """Set the weights of the votes within SPACING of a middle to 0."""
    for n in range(weight.shape[0]):
        if squared_distance(cells.vote[n], middle) < SPACING * SPACING:
            weight[n] = 0


@kernel
def is_beside(first: NDArray[np.int64], second: NDArray[np.int64]) -> bool:
    """Return whether two cubes are the same or have a corner in common."""
    apart = 0
    for k in range(3):
        apart = max(apart, abs(first[k] - second[k]))
    return apart <= 1


@kernel
def heaviest_voxel(
    voxel: NDArray[np.int64], weight: NDArray[np.float32]
) -> tuple[NDArray[np.int64], float]:
    """Return the cube with the most weight in it and in the 26 around it, and this weight.

    Args:
        voxel: the cube of each vote, shape (N, 3).
        weight: of each vote, shape (N,).
    """
    first, last = np.full(3, np.iinfo(np.int64).max), np.full(3, np.iinfo(np.int64).min)
    for n in range(weight.shape[0]):
        if weight[n] > 0:
            for k in range(3):
                first[k], last[k] = min(first[k], voxel[n, k]), max(last[k], voxel[n, k])
    if first[0] > last[0]:
        return np.zeros(3, np.int64), 0.0
    sums = np.zeros((last[0] - first[0] + 3, last[1] - first[1] + 3, last[2] - first[2] + 3))
    for n in range(weight.shape[0]):
        if weight[n] > 0:
            i, j, k = voxel[n] - first
            sums[i : i + 3, j : j + 3, k : k + 3] += weight[n]
    best = np.argmax(sums)
    heaviest = np.empty(3, np.int64)
    heaviest[0] = best // (sums.shape[1] * sums.shape[2])
    heaviest[1] = best // sums.shape[2] % sums.shape[1]
    heaviest[2] = best % sums.shape[2]
    return heaviest - 1 + first, sums.flat[best]


@kernel
def shift(cells: PersonCells, weight: NDArray[np.float32], middle: NDArray[np.float64]) -> None:
    """Move a middle to the weighted mean of the votes within SPACING, if there are any.

    Args:
        cells: the cells.
        weight: of each vote, shape (N,).
        middle: metres, shape (3,); updated.
    """
    total, x, y, z = 0.0, 0.0, 0.0, 0.0
    for n in range(weight.shape[0]):
        vote = cells.vote[n]
        if weight[n] > 0 and squared_distance(vote, middle) < SPACING * SPACING:
            total += weight[n]
            x += weight[n] * vote[0]
            y += weight[n] * vote[1]
            z += weight[n] * vote[2]
    if total > 0:
        middle[0], middle[1], middle[2] = x / total, y / total, z / total


@kernel
def nearest_middles(cells: PersonCells, middles: NDArray[np.float64]) -> NDArray[np.int32]:
    """Return the index of the middle that is nearest to each vote, -1 if none is within REACH."""
    body = np.full(cells.area.shape[0], -1, np.int32)
    for n in range(body.shape[0]):
        nearest = REACH * REACH
        for b in range(middles.shape[0]):
            squared = squared_distance(cells.vote[n], middles[b])
            if squared < nearest:
                nearest, body[n] = squared, b
    return body


@kernel
def squared_distance(first: NDArray[np.floating], second: NDArray[np.floating]) -> float:
    """Return the squared distance of two positions, square metres."""
    x, y, z = first[0] - second[0], first[1] - second[1], first[2] - second[2]
    squared: float = x * x + y * y + z * z
    return squared


@kernel
def measure_bodies(
    cells: PersonCells, body: NDArray[np.int32], count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return area and mean probability of each body as in Bodies, shape (B,) each."""
    area, person = np.zeros(count), np.zeros(count)
    for n in range(body.shape[0]):
        if body[n] >= 0:
            area[body[n]] += cells.area[n]
            person[body[n]] += cells.area[n] * cells.person[n]
    for b in range(count):
        person[b] /= max(area[b], 1e-9)
    return area, person
