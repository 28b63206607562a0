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

"""Depth comparison features, against their equation."""

import math

import numpy as np
import pytest

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.pose.features.depth_comparison import (
    DEPTH_STEP,
    FAR,
    MIDDLE,
    OFFSETS,
    OffsetPool,
    compare_depths,
    offset_pool,
)
from lsc_pose_ros.pose.silhouette.preprocessing import Window

CAMERA = Intrinsics(120.0, 125.0, 31.5, 23.5)
FOCAL_LENGTHS = (CAMERA.fx, CAMERA.fy)


def compare_twin(depth: np.ndarray, pixels: np.ndarray, pool: OffsetPool) -> np.ndarray:
    """Shotton et al., eq. 1, probe by probe."""

    def probe(row: int, column: int, offset: np.ndarray) -> float:
        metres = float(depth[row, column])
        other_row = math.floor(row + offset[1] * CAMERA.fy / metres + 0.5)
        other_column = math.floor(column + offset[0] * CAMERA.fx / metres + 0.5)
        if 0 <= other_row < depth.shape[0] and 0 <= other_column < depth.shape[1]:
            found = float(depth[other_row, other_column])
            return found if math.isfinite(found) else FAR
        return FAR

    offsets = pool.offsets.astype(float)
    pairs = list(zip(offsets[pool.first], offsets[pool.second], strict=True))
    differences = [
        [probe(*pixel, one) - probe(*pixel, other) for one, other in pairs]
        for pixel in pixels.tolist()
    ]
    quantised = np.array(differences).reshape(len(pixels), len(pairs)) / DEPTH_STEP + MIDDLE
    return np.clip(quantised, 0, 255)


def a_body(seed: int) -> np.ndarray:
    """Return a window with a rough body, holes in it, and unknown borders."""
    rng = np.random.default_rng(seed)
    depth = np.full((48, 40), np.inf, np.float32)
    depth[5:43, 8:30] = rng.uniform(1.5, 2.6, (38, 22))
    depth[rng.random(depth.shape) < 0.1] = np.inf
    depth[0], depth[:, -1] = np.nan, np.nan
    return depth


def check(depth: np.ndarray, pool: OffsetPool) -> None:
    pixels = np.argwhere(np.isfinite(depth)).astype(np.int32)[::7]
    quantised = compare_depths(Window(depth, 3, -1), pixels, pool, FOCAL_LENGTHS)
    assert quantised.shape == (len(pixels), len(pool.first))
    apart = np.abs(quantised - compare_twin(depth, pixels, pool))
    # Half a level by rounding; a position at the very border of two pixels may fall into either.
    assert (apart > 0.51).sum() <= 1e-3 * apart.size


@pytest.mark.parametrize('seed', range(4))
@pytest.mark.parametrize('reach', [0.05, 0.4, 3.0, 1e9])
def test_depth_differences_of_a_random_body(seed: int, reach: float) -> None:
    check(a_body(seed), offset_pool(60, reach, seed))


def test_depth_differences_of_degenerate_bodies() -> None:
    pool = offset_pool(20, 0.3, 0)
    empty, single, flat = (np.full((5, 5), np.inf, np.float32) for _ in range(3))
    single[2, 2] = 2.0
    flat[1:4, 1:4] = 1e-3  # as near as that, every offset leads out of the image
    for depth in (empty, single, flat):
        check(depth, pool)
    assert set(
        compare_depths(Window(flat, 0, 0), np.ones((1, 2), np.int32), pool, FOCAL_LENGTHS)[0]
    ) <= {
        0,
        MIDDLE,
        255,
    }


def test_step_in_depth_gives_its_size() -> None:
    depth = np.full((20, 20), 2.0, np.float32)
    depth[:, 10:] = 2.4
    offsets = np.array([[0, 0], [0.1, 0]], np.float32)  # 6 pixels at 2 m
    right = OffsetPool(offsets, np.array([1], np.int32), np.array([0], np.int32))
    for column, expected in ((8, MIDDLE + 0.4 / DEPTH_STEP), (2, MIDDLE), (15, 255)):
        pixel = np.array([[10, column]], np.int32)
        assert compare_depths(Window(depth, 0, 0), pixel, right, FOCAL_LENGTHS)[0, 0] == expected


def test_twice_as_far_an_offset_is_half_as_many_pixels() -> None:
    pool = offset_pool(50, 0.2, 1)
    near = np.full((41, 41), 2.0, np.float32)
    near[:, 25:] = np.inf
    pixel = np.array([[20, 20]], np.int32)
    whole = compare_depths(Window(near, 0, 0), pixel, pool, FOCAL_LENGTHS)
    doubled = (2 * CAMERA.fx, 2 * CAMERA.fy)
    far = compare_depths(Window(2 * near, 0, 0), pixel, pool, doubled)
    np.testing.assert_array_equal(whole, far)


def test_pool_is_drawn_from_its_seed_and_fills_its_square() -> None:
    pool = offset_pool(1000, 0.5, 3)
    again, other = offset_pool.__wrapped__(1000, 0.5, 3), offset_pool(1000, 0.5, 4)
    for ours, same, different in zip(pool, again, other, strict=True):
        np.testing.assert_array_equal(ours, same)
        assert (ours != different).any()
    assert pool.offsets.shape == (OFFSETS + 1, 2)
    assert pool.offsets.dtype == np.float32
    assert not pool.offsets[0].any()
    assert np.abs(pool.offsets).max() <= 0.5
    np.testing.assert_allclose(
        np.quantile(pool.offsets[1:], [0.25, 0.5, 0.75]), [-0.25, 0, 0.25], atol=0.1
    )
    assert not pool.second[1::2].any()
    assert pool.second[::2].all()
    assert np.unique(pool.first).tolist() == list(range(1, OFFSETS + 1))
    # What a model carries is the seed: these numbers must never change.
    few = offset_pool(2, 1.0, 0)
    np.testing.assert_allclose(
        few.offsets[1:3], [[0.688844, 0.515909], [-0.158857, -0.482166]], atol=1e-6
    )
    assert (few.first.tolist(), few.second.tolist()) == ([96, 84], [90, 0])
