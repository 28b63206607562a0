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

"""Pieces of a body that something cuts off: they are parts of it, other people are not."""

import itertools

import numpy as np
import pytest

from lsc_pose_ros.camera.rays import image_rays
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.image_arguments import check_images
from lsc_pose_ros.tracking.fragments import (
    BODY_RADIUS,
    LEAST_INSIDE,
    MOST_ELSEWHERE,
    STRIDE,
    count_inside,
    fragments_of,
    is_near,
    join_fragments,
)

CAMERA = Intrinsics(80.0, 80.0, 60.0, 60.0)
LIMBS = np.array([[0, 1], [1, 2]], np.int32)


def standing(x: float, z: float = 3.0) -> np.ndarray:
    """Return a straight body: head, pelvis and feet."""
    return np.array([[x, -0.8, z], [x, 0.0, z], [x, 0.8, z]], np.float32)


def images(*pieces: tuple[int, float, float, float, float]):
    """Return images of upright pieces: number, x, first and last y, and z, metres; 0.3 m wide."""
    depth, labels = np.zeros((120, 120), np.float32), np.full((120, 120), NO_BODY, np.int32)
    for number, x, top, bottom, z in pieces:
        left, right = (int(60 + 80 * (x + side) / z) for side in (-0.15, 0.15))
        rows = slice(int(60 + 80 * top / z), int(60 + 80 * bottom / z))
        depth[rows, left:right], labels[rows, left:right] = z, number
    return check_images(depth, labels, CAMERA)


def numbers_in(labels: np.ndarray) -> list[int]:
    return np.unique(labels[labels >= 0]).tolist()


@pytest.mark.parametrize('seed', range(3))
def test_a_point_is_near_a_limb_within_the_radius(seed: int) -> None:
    rng = np.random.default_rng(seed)
    joints = rng.normal(0, 0.3, (4, 3)).astype(np.float32)
    joints[3] = np.nan
    limbs = np.array([[0, 1], [1, 2], [3, 0], [2, 2]], np.int32)
    found = []
    for x, y, z in rng.normal(0, 0.5, (300, 3)):
        point, along = np.array([x, y, z]), np.linspace(0, 1, 2001)[:, None]
        distance = min(
            np.linalg.norm(joints[a] + along * (joints[b] - joints[a]) - point, axis=1).min()
            for a, b in ((0, 1), (1, 2))
        )
        # The steps along a limb are shorter than a millimetre.
        if abs(distance - BODY_RADIUS) > 1e-3:
            found.append(distance < BODY_RADIUS)
            assert is_near(x, y, z, joints, limbs) == found[-1]
    assert any(found)
    assert not all(found)


def test_the_points_of_pieces_near_to_bodies_are_counted() -> None:
    pictures = images((4, 0.0, -0.7, 0.1, 3.0), (9, 0.5, -0.7, 0.6, 3.2))
    pictures.depth[40:50, 55:65] = np.inf
    skeletons = np.array([standing(0.05), standing(0.6)])
    rays = image_rays(CAMERA, 120, 120)
    numbers = np.array([4, 9], np.int32)
    counts, inside = count_inside(*pictures[:2], rays, numbers, skeletons, LIMBS)
    expected, near = np.zeros(2, int), np.zeros((2, 2), int)
    for row, column in itertools.product(range(0, 120, STRIDE), range(0, 120, STRIDE)):
        z = float(pictures.depth[row, column])
        if pictures.labels[row, column] < 0 or not 0 < z < np.inf:
            continue
        piece = numbers.tolist().index(pictures.labels[row, column])
        expected[piece] += 1
        for body, joints in enumerate(skeletons):
            point = (column - 60) / 80 * z, (row - 60) / 80 * z, z
            near[piece, body] += is_near(*point, joints, LIMBS)
    np.testing.assert_array_equal(counts, expected)
    np.testing.assert_array_equal(inside, near)
    assert 0 < near.sum() < 2 * expected.sum()


def test_a_piece_of_a_known_body_is_given_to_its_largest_piece() -> None:
    pictures = images((5, 0.0, -0.8, 0.3, 3.0), (2, 0.0, 0.5, 0.8, 3.0))
    assert numbers_in(pictures.labels) == [2, 5]
    joined = join_fragments(pictures, [standing(0.0)], LIMBS)
    assert numbers_in(joined) == [5]
    np.testing.assert_array_equal(joined >= 0, pictures.labels >= 0)
    assert numbers_in(pictures.labels) == [2, 5]  # the argument is unchanged


@pytest.mark.parametrize(
    'other',
    [
        (2, 0.5, 0.5, 0.8, 3.0),  # beside the body
        (2, 0.0, 0.5, 0.8, 2.5),  # before it
        (2, 0.3, -0.8, 0.8, 3.2),  # somebody behind it
    ],
)
def test_other_pieces_stay_what_they_are(other: tuple[int, float, float, float, float]) -> None:
    pictures = images((5, 0.0, -0.8, 0.3, 3.0), other)
    assert join_fragments(pictures, [standing(0.0)], LIMBS) is pictures.labels
    assert join_fragments(pictures, [], LIMBS) is pictures.labels


def test_a_piece_that_may_be_of_another_body_is_left_alone() -> None:
    pictures = images((5, 0.0, -0.8, 0.3, 3.0), (2, 0.0, 0.5, 0.8, 3.0))
    both = [standing(0.0), standing(0.05)]
    assert join_fragments(pictures, both, LIMBS) is pictures.labels


def test_the_only_piece_of_a_body_is_the_body() -> None:
    counts = np.array([30, 100])
    assert fragments_of(counts, np.array([[30, 0], [0, 100]])) == {}
    assert fragments_of(counts, np.array([[30], [10]])) == {}
    assert fragments_of(counts, np.array([[30], [90]])) == {0: 1}


def plain_fragments(counts: np.ndarray, inside: np.ndarray) -> dict[int, int]:
    fraction = inside / np.maximum(counts, 1)[:, None]
    wholes = {}
    for piece, near in enumerate(fraction):
        body = int(np.argmax(near))
        elsewhere = [fraction for other, fraction in enumerate(near) if other != body]
        if near[body] < LEAST_INSIDE or max(elsewhere, default=0) > MOST_ELSEWHERE:
            continue
        pieces = [
            counts[other] if fraction[other, body] >= LEAST_INSIDE else 0
            for other in range(len(counts))
        ]
        whole = int(np.argmax(pieces))
        if piece != whole:
            wholes[piece] = whole
    return wholes


@pytest.mark.parametrize('seed', range(30))
def test_fragments_are_those_of_the_definition(seed: int) -> None:
    rng = np.random.default_rng(seed)
    counts = rng.integers(0, 12, 40)
    inside = rng.binomial(counts[:, None], rng.choice([0, 0.5, 0.9, 1], (40, 3)))
    expected = plain_fragments(counts, inside)
    assert fragments_of(counts, inside) == expected
    assert expected


def test_pieces_that_no_sampled_pixel_shows_keep_their_numbers() -> None:
    pictures = images((5, 0.0, -0.8, 0.3, 3.0), (2, 0.0, 0.5, 0.8, 3.0))
    pictures.labels[1, 1], pictures.labels[1, 2] = 7, 1
    joined = join_fragments(pictures, [standing(0.0)], LIMBS)
    assert numbers_in(joined) == [1, 5, 7]


def test_a_number_that_is_no_body_takes_no_memory() -> None:
    pictures = images((5, 0.0, -0.8, 0.3, 3.0), (2**31 - 1, 0.0, 0.5, 0.8, 3.0))
    assert join_fragments(pictures, [standing(0.0)], LIMBS) is pictures.labels
