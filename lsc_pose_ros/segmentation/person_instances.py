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


"""Tells people apart: each person has a head or a trunk, and each cell belongs to the nearest one.

Distances are those of paths over the cells that show people. A step between neighbouring cells
costs their distance in space, so that a path follows the surface of a body. A step from one
surface to another, as from a hand in front of the chest to the chest, costs more.
"""

import heapq
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.body_parts.smoothing import SURFACE_STEP
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.segmentation.person_cells import PersonCells

NEIGHBOURS = 2
"""Cells are neighbours if their rows and columns differ by at most this: it bridges small gaps."""

JUMP_FACTOR = 3.0
"""A step between two surfaces costs this many times its distance."""

LARGEST_JUMP = 0.7
"""The largest step between two surfaces of one body, metres: a hand towards the camera."""

HEAD_RADIUS = 0.15
TRUNK_RADIUS = 0.25
"""Radius of the sphere in which evidence for a head or a trunk is summed, metres."""

HEAD_SPACING = 0.3
TRUNK_SPACING = 0.4
"""The least distance of two heads, and of two trunks, metres."""

LEAST_PROBABILITY = 0.25
"""The middle of a head or trunk shows the part with at least this probability."""

LEAST_HEAD = 0.008
LEAST_TRUNK = 0.03
"""The least evidence of a head and of a trunk: probability times area, square metres."""

HEAD_TO_TRUNK = 1.3
"""A trunk within this distance of a head belongs to it, along the surface, metres."""

REACH = 2.0
"""Cells at a larger distance from head or trunk belong to nobody, along the surface, metres."""

LEAST_AREA = 0.06
"""A body with a smaller visible area is none, square metres."""

LEAST_PERSON = 0.7
"""The least mean probability that the cells of a body show a person."""

LEAST_EVIDENCE = 0.04
"""The least evidence of head and trunk together of a body, square metres."""


class Bodies(NamedTuple):
    """The people that were found.

    Attributes:
        body: the index of the person of each cell, -1 for none, shape (N,), int32.
        area: the visible area of each person, square metres, shape (B,).
        person: the mean probability that the cells of each show a person, shape (B,).
        evidence: of head and trunk of each person, square metres, shape (B,).
    """

    body: NDArray[np.int32]
    area: NDArray[np.float64]
    person: NDArray[np.float64]
    evidence: NDArray[np.float64]


@kernel
def find_bodies(cells: PersonCells) -> Bodies:
    """Return the people in the cells, those with the most evidence first."""
    heads = find_peaks(cells, cells.head, HEAD_RADIUS, HEAD_SPACING, LEAST_HEAD)
    trunks = find_peaks(cells, cells.trunk, TRUNK_RADIUS, TRUNK_SPACING, LEAST_TRUNK)
    count = cells.area.shape[0]
    distance = np.full(count, np.inf)
    body = np.full(count, -1, np.int32)
    seeds = np.empty(heads.shape[0] + trunks.shape[0], np.int64)
    used = 0
    for head in heads:
        seeds[used] = head
        spread(cells, seeds, used, distance, body)
        used += 1
    for trunk in trunks:
        if distance[trunk] > HEAD_TO_TRUNK:
            seeds[used] = trunk
            spread(cells, seeds, used, distance, body)
            used += 1
    return drop_doubtful(cells, seeds[:used], body)


@kernel
def drop_doubtful(cells: PersonCells, seeds: NDArray[np.int64], body: NDArray[np.int32]) -> Bodies:
    """Return the bodies without those of too little area, probability or evidence.

    The cells of the one with the least evidence go to others in reach; then the rest is judged
    again.

    Args:
        cells: the cells.
        seeds: a cell of each body, shape (B,).
        body: the body of each cell, -1 for none, shape (N,).
    """
    kept = seeds.copy()
    while True:
        area, person, evidence = measure_bodies(cells, body, kept.shape[0])
        worst, least = -1, np.inf
        for b in range(kept.shape[0]):
            doubtful = area[b] < LEAST_AREA or person[b] < LEAST_PERSON
            doubtful = doubtful or evidence[b] < LEAST_EVIDENCE
            if doubtful and evidence[b] < least:
                worst, least = b, evidence[b]
        if worst < 0:
            break
        kept = np.concatenate((kept[:worst], kept[worst + 1 :]))
        distance = np.full(body.shape[0], np.inf)
        body = np.full(body.shape[0], -1, np.int32)
        for b in range(kept.shape[0]):
            spread(cells, kept, b, distance, body)
    order = np.argsort(-evidence)
    rank = np.empty(kept.shape[0], np.int32)
    for r in range(order.shape[0]):
        rank[order[r]] = r
    for n in range(body.shape[0]):
        if body[n] >= 0:
            body[n] = rank[body[n]]
    return Bodies(body, area[order], person[order], evidence[order])


@kernel
def measure_bodies(
    cells: PersonCells, body: NDArray[np.int32], count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return area, mean probability and evidence of each body as in Bodies, shape (B,) each."""
    area, person, evidence = np.zeros(count), np.zeros(count), np.zeros(count)
    for n in range(body.shape[0]):
        if body[n] >= 0:
            area[body[n]] += cells.area[n]
            person[body[n]] += cells.area[n] * cells.person[n]
            evidence[body[n]] += cells.area[n] * (cells.head[n] + cells.trunk[n])
    for b in range(count):
        person[b] /= max(area[b], 1e-9)
    return area, person, evidence


@kernel
def find_peaks(
    cells: PersonCells,
    probability: NDArray[np.float32],
    radius: float,
    spacing: float,
    least: float,
) -> NDArray[np.int64]:
    """Return the cells around which there is most evidence for a part, the best first.

    The evidence of a cell is the sum of probability times area in the sphere of `radius`. A cell
    within `spacing` of a better one is none, and one that hardly shows the part itself.

    Args:
        cells: the cells.
        probability: of the part at each cell, shape (N,).
        radius: metres.
        spacing: metres.
        least: the least evidence, square metres.
    """
    evidence = sum_in_spheres(cells, probability, radius)
    peaks = np.empty(evidence.shape[0], np.int64)
    used = 0
    while used < peaks.shape[0]:
        best = int(np.argmax(evidence))
        if evidence[best] < least:
            break
        peaks[used] = best
        used += 1
        for n in range(evidence.shape[0]):
            if squared_distance(cells.points, n, best) < spacing * spacing:
                evidence[n] = -1.0
    return peaks[:used]


@kernel
def sum_in_spheres(
    cells: PersonCells, probability: NDArray[np.float32], radius: float
) -> NDArray[np.float64]:
    """Return the sum of probability times area in the sphere around each cell, shape (N,).

    It is 0 for a cell whose own probability is below LEAST_PROBABILITY.
    """
    sums = np.zeros(cells.area.shape[0])
    height, width = cells.number.shape
    for n in range(sums.shape[0]):
        if probability[n] < LEAST_PROBABILITY:
            continue
        window = window_around(cells.points[n], cells.area[n], radius)
        i, j = cells.row[n], cells.column[n]
        for k in range(max(i - window, 0), min(i + window + 1, height)):
            for m in range(max(j - window, 0), min(j + window + 1, width)):
                other = cells.number[k, m]
                if other >= 0 and squared_distance(cells.points, n, other) <= radius * radius:
                    sums[n] += probability[other] * cells.area[other]
    return sums


@kernel
def window_around(point: NDArray[np.float32], area: float, radius: float) -> int:
    """Return how many rows and columns a point in the sphere around another is away at most.

    With |dx|, |dz| <= r: |(x + dx) / (z + dz) - x / z| <= r (1 + |x / z|) / (z - r).

    Args:
        point: the middle of the sphere, metres, shape (3,).
        area: of a cell at its depth, square metres; a tenth is added for pixels that are not
            square.
        radius: r, metres.
    """
    x, y, z = point
    aside = 1.0 + max(abs(x), abs(y)) / z
    cells_per_metre = 1.1 / np.sqrt(area)
    return int(np.ceil(radius * aside * cells_per_metre * z / max(z - radius, 0.5 * z)))


@kernel
def squared_distance(points: NDArray[np.float32], first: int, second: int) -> float:
    """Return the squared distance of two of the points, square metres."""
    x = points[first, 0] - points[second, 0]
    y = points[first, 1] - points[second, 1]
    z = points[first, 2] - points[second, 2]
    squared: float = x * x + y * y + z * z
    return squared


@kernel
def spread(
    cells: PersonCells,
    seeds: NDArray[np.int64],
    number: int,
    distance: NDArray[np.float64],
    body: NDArray[np.int32],
) -> None:
    """Give the cells that are nearer to a new body's seed than to any other to the new body.

    Dijkstra's algorithm from the seed; it stops at cells that are nearer to other seeds.

    Args:
        cells: the cells.
        seeds: the cell from which each body spreads.
        number: the new body, an index of `seeds`.
        distance: of each cell from its body's seed, metres, infinity for none, shape (N,);
            updated.
        body: the body of each cell, -1 for none, shape (N,); updated.
    """
    height, width = cells.number.shape
    seed = seeds[number]
    distance[seed], body[seed] = 0.0, number
    heap = [(0.0, seed)]
    while len(heap) > 0:
        travelled, n = heapq.heappop(heap)
        if travelled > distance[n] or body[n] != number:
            continue
        i, j = cells.row[n], cells.column[n]
        for k in range(max(i - NEIGHBOURS, 0), min(i + NEIGHBOURS + 1, height)):
            for m in range(max(j - NEIGHBOURS, 0), min(j + NEIGHBOURS + 1, width)):
                other = cells.number[k, m]
                if other < 0 or other == n:
                    continue
                reached = travelled + cost_of_step(cells.points, n, other)
                if reached < distance[other] and reached <= REACH:
                    distance[other], body[other] = reached, number
                    heapq.heappush(heap, (reached, np.int64(other)))


@kernel
def cost_of_step(points: NDArray[np.float32], first: int, second: int) -> float:
    """Return the cost of a step between two cells, metres; infinity for a too large jump."""
    length: float = np.sqrt(squared_distance(points, first, second))
    jump = abs(points[first, 2] - points[second, 2])
    if jump <= SURFACE_STEP:
        return length
    return length * JUMP_FACTOR if jump <= LARGEST_JUMP else np.inf
