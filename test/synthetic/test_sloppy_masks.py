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

"""Errors of masks, against their definitions."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames
from lsc_pose_ros.synthetic.sloppy_masks import (
    ERROR,
    MOST_HOLES,
    MaskError,
    distort,
    grow,
    sample_error,
    shifted,
    sloppy_labels,
)


def disc(radius: int, size: int = 41) -> np.ndarray:
    rows, columns = np.indices((size, size)) - size // 2
    return rows**2 + columns**2 <= radius**2


@pytest.mark.parametrize('pixels', [0, 1, 2, 5, 9])
def test_mask_grows_by_an_octagon(pixels: int) -> None:
    point = disc(0)
    grown = grow(point, pixels)
    rows, columns = np.abs(np.indices(point.shape) - 20)
    diagonal = pixels + pixels // 2  # every second step also goes diagonally
    expected = (np.maximum(rows, columns) <= pixels) & (rows + columns <= diagonal)
    np.testing.assert_array_equal(grown, expected)


def test_mask_that_grows_and_shrinks_loses_nothing_of_a_disc() -> None:
    np.testing.assert_array_equal(distort(distort(disc(8), MaskError(4)), MaskError(-4)), disc(8))


@pytest.mark.parametrize('shift', [(0, 0), (3, -2), (-5, 7), (60, 0)])
def test_mask_is_shifted_and_what_leaves_the_image_is_lost(shift: tuple[int, int]) -> None:
    mask = disc(19)
    expected = np.zeros_like(mask)
    for row, column in np.argwhere(mask) + shift:
        if 0 <= row < 41 and 0 <= column < 41:
            expected[row, column] = True
    np.testing.assert_array_equal(shifted(mask, shift), expected)


def test_hole_is_a_disc() -> None:
    mask = np.ones((41, 41), np.bool_)
    np.testing.assert_array_equal(distort(mask, MaskError(holes=((20, 20, 5),))), ~disc(5))


def test_errors_are_in_their_ranges_and_of_all_kinds() -> None:
    random = np.random.default_rng(0)
    mask = np.zeros((240, 320), np.bool_)
    mask[60:200, 120:180] = True
    errors = [sample_error(mask, random) for _ in range(300)]
    low, high = (320 * limit for limit in ERROR)
    growths = np.array([error.growth for error in errors])
    assert low <= growths[growths > 0].min() < growths.max() <= high
    assert -high / 3 <= growths.min() < 0
    distances = np.array([np.hypot(*error.shift) for error in errors])
    assert low - 1 <= distances[distances > 0].min() < distances.max() <= high + 1
    assert not (growths[distances > 0] != 0).any()
    assert {len(error.holes) for error in errors} == set(range(MOST_HOLES + 1))
    assert all(mask[row, column] for error in errors for row, column, _ in error.holes)


def test_each_body_has_its_own_error_and_takes_no_pixel_of_another() -> None:
    labels = np.full((240, 320), NO_BODY, np.int32)
    labels[50:200, 60:120] = 1
    labels[50:200, 125:200] = 4
    before = labels.copy()
    found = [sloppy_labels(labels, np.random.default_rng(seed)) for seed in (0, 0, 1)]
    np.testing.assert_array_equal(labels, before)
    np.testing.assert_array_equal(found[0], found[1])
    assert not np.array_equal(found[0], found[2])
    assert set(np.unique(found[0])) == {NO_BODY, 1, 4}


def test_generator_changes_only_the_masks() -> None:
    settings = SyntheticSettings(frames=2, width=160, height=120, background=True)
    exact = list(synthetic_frames(settings))
    sloppy = list(synthetic_frames(settings._replace(sloppy_masks=True)))
    again = list(synthetic_frames(settings._replace(sloppy_masks=True, frames=1)))
    for before, after in zip(exact, sloppy, strict=True):
        np.testing.assert_array_equal(after.depth, before.depth)
        np.testing.assert_array_equal(after.ground_truth.positions, before.ground_truth.positions)
        assert not np.array_equal(after.labels, before.labels)
        assert ((after.labels == 1) & (before.labels == 1)).any()
    np.testing.assert_array_equal(again[0].labels, sloppy[0].labels)
