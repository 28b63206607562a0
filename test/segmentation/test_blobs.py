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

"""Connected parts and the sizes of bodies, compared with plain Python."""

from itertools import pairwise

import numpy as np
import pytest

from lsc_pose_ros.camera.projection import back_project
from lsc_pose_ros.camera.rays import image_rays
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.segmentation import blobs as module
from lsc_pose_ros.segmentation.blobs import (
    BARRIER,
    Blobs,
    body_sized,
    connect_pixels,
    find_blobs,
    gap_of,
    label_bodies,
    measure,
    measure_contact,
)

CAMERA = Intrinsics(60.0, 62.0, 31.0, 23.0)
FOCAL_LENGTHS = (CAMERA.fx, CAMERA.fy)
GAP = 3


def line_links(line: list[float], gap: int, focal: float) -> list[tuple[int, int]]:
    """Return the connected pixels of one row or column."""
    links = []
    last = hidden = None
    for index, here in enumerate(line):
        if here < 0:
            last = hidden = None
        if here <= 0:
            continue
        if last is not None:
            before = line[last]
            if abs(here - before) <= module.STEP + module.SLOPE * min(here, before):
                if index - last <= gap:
                    links.append((last, index))
            else:
                if hidden is not None:
                    metres = (index - hidden) * line[hidden] / focal
                    seen = metres <= module.HIDDEN_WIDTH
                else:
                    seen = False
                if here < before:
                    hidden = hidden if seen else last
                elif seen and abs(here - line[hidden]) <= module.HIDDEN_STEP:
                    links.append((hidden, index))
                    hidden = None
        last = index
    return links


def plain_connect(depth: np.ndarray, gap: int, camera: Intrinsics) -> np.ndarray:
    height, width = depth.shape
    neighbours: dict[tuple[int, int], list[tuple[int, int]]] = {
        (row, column): [] for row, column in np.argwhere(depth > 0).tolist()
    }
    pairs = [
        ((row, a), (row, b))
        for row in range(height)
        for a, b in line_links(depth[row].tolist(), gap, camera.fx)
    ] + [
        ((a, column), (b, column))
        for column in range(width)
        for a, b in line_links(depth[:, column].tolist(), gap, camera.fy)
    ]
    for one, other in pairs:
        neighbours[one].append(other)
        neighbours[other].append(one)
    numbers = np.full(depth.shape, -1)
    count = 0
    for start in neighbours:
        if numbers[start] >= 0:
            continue
        reached = [start]
        numbers[start] = count
        while reached:
            for other in neighbours[reached.pop()]:
                if numbers[other] < 0:
                    numbers[other] = count
                    reached.append(other)
        count += 1
    return numbers


def random_depth(seed: int, shape: tuple[int, int] = (24, 32)) -> np.ndarray:
    """Return overlapping slanted patches with holes and barriers."""
    random = np.random.default_rng(seed)
    depth = np.zeros(shape, np.float32)
    rows, columns = np.indices(shape)
    for _ in range(12):
        top, left = random.integers(0, shape[0]), random.integers(0, shape[1])
        high, wide = random.integers(1, 14, 2)
        inside = np.s_[top : top + high, left : left + wide]
        slope = random.normal(0, 0.02, 2)
        patch = random.uniform(0.8, 2.0) + slope[0] * rows + slope[1] * columns
        depth[inside] = patch[inside]
    depth[random.random(shape) < 0.15] = 0
    depth[random.random(shape) < 0.05] = BARRIER
    return np.where((depth < 0.3) & (depth > 0), 0, depth).astype(np.float32)


@pytest.mark.parametrize('seed', range(30))
def test_blobs_are_those_of_plain_python(seed: int) -> None:
    depth = random_depth(seed)
    numbers, count = connect_pixels(depth, GAP, FOCAL_LENGTHS)
    expected = plain_connect(depth, GAP, CAMERA)
    np.testing.assert_array_equal(numbers, expected)
    assert count == expected.max() + 1


@pytest.mark.parametrize(
    'depth',
    [
        np.zeros((5, 7)),
        np.full((5, 7), BARRIER),
        np.full((1, 1), 2.0),
        np.full((9, 1), 2.0),
        np.full((6, 8), np.inf),
    ],
)
def test_degenerate_images(depth: np.ndarray) -> None:
    depth = depth.astype(np.float32)
    numbers, count = connect_pixels(depth, GAP, FOCAL_LENGTHS)
    if np.isfinite(depth).all():
        np.testing.assert_array_equal(numbers, plain_connect(depth, GAP, CAMERA))
    blobs = measure(depth, numbers, count, image_rays(CAMERA, *depth.shape))
    assert len(blobs.area) == count
    assert (label_bodies(blobs, np.array([], np.int64)) == NO_BODY).all()


def test_spiral_is_one_blob() -> None:
    """Parts that are connected late in the scan become one blob."""
    depth = np.full((41, 41), BARRIER)
    low, high = 0, 40
    while low < high:
        depth[low, low : high + 1] = depth[low : high + 1, high] = 1.5
        depth[high, low : high + 1] = depth[low + 2 : high + 1, low] = 1.5
        depth[low + 2, low : low + 3] = 1.5
        low, high = low + 2, high - 2
    depth = depth.astype(np.float32)
    numbers, count = connect_pixels(depth, 1, FOCAL_LENGTHS)
    assert count == plain_connect(depth, 1, CAMERA).max() + 1 == 1
    assert ((numbers == 0) == (depth > 0)).all()


def test_trunk_behind_an_arm_is_one_but_two_people_are_not() -> None:
    depth = np.full((48, 64), BARRIER)
    depth[4:44, 20:40] = 2.0
    depth[20:24, 10:50] = 1.6  # the arm, 4 / 62 * 2.0 = 13 cm
    arm = depth.astype(np.float32)
    numbers, _ = connect_pixels(arm, GAP, FOCAL_LENGTHS)
    assert numbers[10, 30] == numbers[40, 30] != numbers[22, 30]
    depth[20:32, 10:50] = 1.6  # 39 cm
    numbers, _ = connect_pixels(depth.astype(np.float32), GAP, CAMERA)
    assert numbers[10, 30] != numbers[40, 30]


def test_gap_is_bridged_but_a_barrier_is_not() -> None:
    line = np.full((1, 20), 2.0, np.float32)
    line[0, 5:7] = 0
    assert connect_pixels(line, GAP, FOCAL_LENGTHS)[1] == 1
    line[0, 5:8] = 0
    assert connect_pixels(line, GAP, FOCAL_LENGTHS)[1] == 2
    line[0, 5:8] = 2.0
    line[0, 6] = BARRIER
    assert connect_pixels(line, GAP, FOCAL_LENGTHS)[1] == 2


@pytest.mark.parametrize('seed', range(5))
def test_sizes_are_those_of_the_points(seed: int) -> None:
    depth = random_depth(seed)
    blobs = find_blobs(depth, CAMERA)
    rows, columns = np.indices(depth.shape)
    points = back_project(columns, rows, depth, CAMERA)
    for number in range(len(blobs.area)):
        inside = blobs.numbers == number
        z = depth[inside].astype(float)
        assert blobs.pixels[number] == inside.sum()
        assert blobs.area[number] == pytest.approx((z**2).sum() / (CAMERA.fx * CAMERA.fy))
        assert blobs.depth[number] == pytest.approx(z.mean())
        np.testing.assert_allclose(blobs.low[number], points[inside].min(axis=0), atol=1e-6)
        np.testing.assert_allclose(blobs.high[number], points[inside].max(axis=0), atol=1e-6)


def plain_contact(
    numbers: np.ndarray, ranks: np.ndarray, bodies: int, gap: int
) -> tuple[np.ndarray, np.ndarray]:
    outline = np.zeros(len(ranks), int)
    contact = np.zeros((len(ranks), bodies), int)
    for lines in (numbers, numbers.T):
        for line in lines.tolist():
            for first, second in pairwise(line):
                for one, other in ((first, second), (second, first)):
                    outline[one] += one >= 0 and one != other
            seen = [index for index, number in enumerate(line) if number >= 0]
            for one, other in pairwise(seen):
                if other - one > gap or line[one] == line[other]:
                    continue
                for blob, body in ((line[one], line[other]), (line[other], line[one])):
                    if ranks[body] >= 0:
                        contact[blob, ranks[body]] += 1
    return outline, contact


@pytest.mark.parametrize('seed', range(10))
def test_outline_and_contact_are_those_of_plain_python(seed: int) -> None:
    random = np.random.default_rng(seed)
    numbers = random.integers(-2, 6, (6, 8)).clip(-1).repeat(3, 0).repeat(3, 1).astype(np.int32)
    ranks = np.array([-1, 0, -1, 1, -1, -1], np.int32)
    outline, contact = measure_contact(numbers, ranks, 2, 4)
    expected_outline, expected_contact = plain_contact(numbers, ranks, 2, 4)
    np.testing.assert_array_equal(outline, expected_outline)
    np.testing.assert_array_equal(contact, expected_contact)


def box(size: tuple[float, float, float], area: float) -> Blobs:
    return Blobs(
        np.zeros((1, 1), np.int32),
        np.array([1000]),
        np.array([area]),
        np.array([2.0]),
        np.zeros((1, 3)),
        np.array([size]),
    )


@pytest.mark.parametrize(
    ('size', 'area', 'body'),
    [
        ((0.5, 1.8, 0.3), 0.7, True),
        ((1.8, 1.7, 0.3), 0.8, True),
        ((0.5, 0.6, 0.3), 0.2, True),  # head and shoulders
        ((0.4, 1.0, 0.2), 0.25, True),  # a child
        ((0.2, 0.3, 0.2), 0.05, False),  # a ball
        ((1.9, 0.1, 0.1), 0.05, False),  # a broom
        ((4.0, 2.4, 0.1), 9.0, False),  # a wall
        ((1.0, 2.0, 0.1), 1.9, False),  # a door
        ((0.5, 1.8, 3.0), 0.7, False),  # a corridor's side
    ],
)
def test_size_of_a_body(*, size: tuple[float, float, float], area: float, body: bool) -> None:
    assert (len(body_sized(box(size, area))) == 1) == body


def scene_with_hand(depth_of_hand: float, column: int) -> np.ndarray:
    """A body, 0.67 m x 1.3 m at 2 m, and a hand in front of it, beside it or behind it."""
    depth = np.full((48, 64), BARRIER, np.float32)
    depth[4:44, 20:40] = 2.0
    depth[20:25, column : column + 5] = depth_of_hand
    return depth


@pytest.mark.parametrize(
    ('depth_of_hand', 'column', 'belongs'),
    [
        (1.4, 28, True),  # held towards the camera
        (1.4, 38, True),  # at the body's edge
        (1.4, 50, False),  # away from it
        (0.9, 28, False),  # farther in front of it than the length of an arm
        (2.5, 38, False),  # behind it, at its edge: part of another object
    ],
)
def test_hand_in_front_of_a_body_belongs_to_it(
    *, depth_of_hand: float, column: int, belongs: bool
) -> None:
    blobs = find_blobs(scene_with_hand(depth_of_hand, column), CAMERA)
    bodies = body_sized(blobs)
    assert len(bodies) == 1
    labels = label_bodies(blobs, bodies)
    assert labels[10, 30] == 1
    assert labels[22, column + 2] == (1 if belongs else NO_BODY)


def test_bodies_are_numbered_as_they_are_given() -> None:
    depth = np.full((48, 64), BARRIER, np.float32)
    depth[4:44, 4:20] = 2.0
    depth[4:44, 40:60] = 3.0
    blobs = find_blobs(depth, CAMERA)
    labels = label_bodies(blobs, np.array([1, 0]))
    assert (labels[10, 50], labels[10, 10], labels[0, 0]) == (1, 2, NO_BODY)


def test_gap_grows_with_the_image() -> None:
    assert (gap_of(160), gap_of(320), gap_of(640)) == (3, 5, 9)
