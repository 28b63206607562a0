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

"""Flying pixels, holes and noise of a body's depth, each against its definition."""

import itertools
import math

import numpy as np
import pytest
from ragged_body import ragged_body

from lsc_pose_ros.camera.rays import image_rays
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.silhouette.preprocessing import (
    Window,
    depth_noise,
    drop_flying,
    fill_holes,
    remove_flying_pixels,
)
from lsc_pose_ros.pose.silhouette.silhouette import Silhouette, cut_out, find_silhouette
from lsc_pose_ros.pose.stages import describe_body

CAMERA = Intrinsics(280.0, 285.0, 30.0, 20.0)
RAYS = image_rays(CAMERA, 100, 100)  # no image is larger
BODY = 3


def window_of(depth: np.ndarray, labels: np.ndarray, fewest_seen: int = 0) -> Window:
    """Return the window of BODY."""
    window = cut_out(depth, labels, BODY, fewest_seen)
    assert window is not None
    return window


def ragged_window(seed: int) -> Window:
    return window_of(*ragged_body(seed))


def whole_body(depth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return `depth` in single precision, and labels with BODY at all pixels."""
    return depth.astype(np.float32), np.full(depth.shape, BODY, np.int32)


def drop_flying_twin(depth: np.ndarray, fewest: int, distance: float) -> np.ndarray:
    """Depth without pixels that have fewer than `fewest` neighbours within `distance`.

    They are background, or unknown beside an unknown pixel.
    """
    kept = depth.copy()
    for i, j in np.argwhere(np.isfinite(depth)):
        around = depth[i - 1 : i + 2, j - 1 : j + 2]
        near = np.abs(around - depth[i, j]) <= np.float32(distance)
        if near.sum() - 1 < fewest:
            kept[i, j] = np.nan if np.isnan(around).any() else np.inf
    return kept


def noise_twin(depth: np.ndarray) -> float:
    """The standard deviation of normal noise, from the mean of |a - 2 b + c| < 0.1 m."""
    found = []
    for lines in (depth.astype(float).tolist(), depth.T.astype(float).tolist()):
        for line in lines[1:-1]:
            for before, here, after in zip(line[:-2], line[1:-1], line[2:], strict=True):
                if math.isfinite(before) and math.isfinite(here) and math.isfinite(after):
                    found.append(abs(before - 2 * here + after))
    kept = [each for each in found if each < 0.1]
    return float(np.mean(kept)) / math.sqrt(12 / math.pi) if kept else 0.0


def fill_holes_twin(depth: np.ndarray, labels: np.ndarray, fewest: int) -> np.ndarray:
    """The body's depth; a pixel without depth gets the median of its neighbours on the body.

    The pixels are those of the smallest box around what is seen of the body.
    """
    seen = (labels == BODY) & (depth > 0)
    image = np.where(seen, depth, np.inf).astype(np.float32)
    rows, columns = (np.flatnonzero(seen.any(axis=axis)) for axis in (1, 0))
    box = itertools.product(range(rows[0], rows[-1] + 1), range(columns[0], columns[-1] + 1))
    filled = image.copy()
    for i, j in box:
        around = np.s_[max(i - 1, 0) : i + 2, max(j - 1, 0) : j + 2]
        neighbours = sorted(image[around][seen[around]].tolist())
        if not depth[i, j] > 0 and len(neighbours) >= fewest:
            filled[i, j] = neighbours[len(neighbours) // 2]
    return filled


@pytest.mark.parametrize('seed', range(5))
@pytest.mark.parametrize('fewest', [0, 1, 3, 8, 9])
def test_flying_pixels_are_those_with_few_neighbours_at_their_depth(
    seed: int, fewest: int
) -> None:
    window = ragged_window(seed)
    kept = drop_flying(window.depth, fewest, 0.1)
    np.testing.assert_array_equal(kept, drop_flying_twin(window.depth, fewest, 0.1))
    assert (np.isfinite(kept).sum() == np.isfinite(window.depth).sum()) == (fewest == 0)


def test_flying_pixels_are_removed_only_if_the_settings_ask_for_it() -> None:
    window = ragged_window(1)
    assert remove_flying_pixels(window, Settings(fewest_neighbours=0)) is window
    solid = remove_flying_pixels(window, Settings(fewest_neighbours=3, neighbour_distance=0.05))
    np.testing.assert_array_equal(solid.depth, drop_flying_twin(window.depth, 3, 0.05))
    assert solid[1:] == window[1:]


def test_silhouette_has_no_flying_pixels_if_the_settings_remove_them() -> None:
    depth = np.zeros((30, 30), np.float32)
    depth[8:22, 8:22] = 2.0
    flying = np.zeros(depth.shape, bool)
    flying[8:22:2, 22] = True  # every other pixel along one side, on the way to the wall
    depth[flying] = 2.6
    window = window_of(*whole_body(depth))
    silhouette = find_silhouette(window, RAYS, Settings(fewest_neighbours=3))
    assert set(silhouette.columns.tolist()) == set(range(8, 22))
    assert len(silhouette.points) == 4 * 13  # corners have three neighbours
    raw = find_silhouette(window, RAYS, Settings(fewest_neighbours=0))
    assert flying[raw.rows, raw.columns].sum() == 7


def test_pixels_at_the_edge_of_the_image_are_not_flying_pixels() -> None:
    window = window_of(*whole_body(np.full((10, 10), 2.0)))
    np.testing.assert_array_equal(drop_flying(window.depth, 3, 0.1), window.depth)


@pytest.mark.parametrize('seed', range(5))
def test_noise_is_the_scaled_mean_of_second_differences(seed: int) -> None:
    depth = ragged_window(seed).depth
    expected = noise_twin(depth)
    assert expected > 0.005
    assert depth_noise(depth) == pytest.approx(expected, rel=1e-4)
    assert depth_noise(np.ascontiguousarray(depth.T)) == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize('cut', ['by the image', 'by the background'])
def test_noise_of_a_slanting_plane_is_found(cut: str) -> None:
    rng = np.random.default_rng(0)
    rows, columns = np.indices((60, 80))
    plane = 2.0 + 0.004 * rows - 0.01 * columns
    plane[:, 40:] += 0.5  # an edge is no noise
    noisy = plane + rng.normal(0, 0.005, plane.shape)
    noisy[rng.random(plane.shape) < 0.05] = 0
    if cut == 'by the background':
        noisy = np.pad(noisy, 3)
    depth = window_of(*whole_body(noisy)).depth
    assert np.isnan(depth[0, 0]) == (cut == 'by the image')
    assert depth_noise(depth) == pytest.approx(0.005, rel=0.1)


def test_flat_surface_has_no_noise_and_quantisation_is_noise() -> None:
    rows, columns = np.indices((60, 80))
    flat = 2.0 + 0.004 * rows - 0.01 * columns
    assert depth_noise(window_of(*whole_body(flat)).depth) < 1e-6
    slanting = 2.0 + 0.0037 * rows - 0.0123 * columns
    stepped = 0.02 * np.round(slanting / 0.02)
    of_a_step = 0.02 / math.sqrt(12)
    assert depth_noise(window_of(*whole_body(stepped)).depth) == pytest.approx(of_a_step, rel=0.3)


SPECKS = np.full((9, 9), np.inf)
SPECKS[1:-1:2, 1:-1:2] = 2.0

CLIFFS = np.full((9, 9), 2.0)  # depths that differ by more than 0.1 m from pixel to pixel
CLIFFS[::2, ::2] = CLIFFS[1::2, 1::2] = 2.2


@pytest.mark.parametrize(
    'depth',
    [
        np.full((1, 1), 2.0),
        np.full((1, 2), 2.0),
        np.full((2, 1), 2.0),
        np.full((5, 5), np.inf),
        np.full((5, 5), np.nan),
        SPECKS,
        CLIFFS,
        np.where(np.isinf(SPECKS), np.nan, SPECKS),
    ],
    ids=[
        'a pixel',
        'two',
        'two upright',
        'holes',
        'unknown',
        'specks',
        'cliffs',
        '?',
    ],
)
@pytest.mark.parametrize('border', [np.inf, np.nan])
def test_depth_without_a_surface_has_no_noise(depth: np.ndarray, border: float) -> None:
    window = np.pad(depth, 1, constant_values=border).astype(np.float32)
    assert depth_noise(window) == noise_twin(window) == 0.0


def test_three_pixels_in_a_row_are_a_surface() -> None:
    window = np.full((3, 5), np.inf, np.float32)
    window[1, 1:-1] = [2.0, 2.05, 2.03]
    assert depth_noise(window) == pytest.approx(0.07 / math.sqrt(12 / math.pi), rel=1e-4)


def same_silhouette(first: Silhouette, second: Silhouette) -> bool:
    return all(
        np.array_equal(one, two, equal_nan=True)
        for one, two in zip(
            (first.smoothed.depth, *first[1:]), (second.smoothed.depth, *second[1:]), strict=True
        )
    )


def uneven_window(seed: int) -> Window:
    """Return a body of small tiles at depths that differ by up to 20 cm, with 5 mm of noise."""
    rng = np.random.default_rng(seed)
    tiles = np.kron(rng.uniform(2.0, 2.2, (10, 15)), np.ones((4, 4)))
    return window_of(*whole_body(tiles + rng.normal(0, 0.005, tiles.shape)))


@pytest.mark.parametrize(
    ('least', 'sigma', 'threshold'),
    [(0.01, 0.02, 0.04), (0.03, 0.03, 0.04), (0.06, 0.06, 0.06), (0.08, 0.08, 0.08)],
)
def test_sigma_and_the_edge_threshold_are_at_least_a_multiple_of_the_noise(
    least: float, sigma: float, threshold: float
) -> None:
    window = uneven_window(0)
    factor = least / depth_noise(window.depth)
    found = find_silhouette(window, RAYS, Settings(noise_factor=factor))
    asked = Settings(smoothing_sigma=sigma, edge_threshold=threshold)
    expected = find_silhouette(window, RAYS, asked)
    np.testing.assert_allclose(found.smoothed.depth, expected.smoothed.depth, atol=1e-5)
    np.testing.assert_array_equal(found.rows, expected.rows)
    np.testing.assert_array_equal(found.columns, expected.columns)
    # Neither of the two could be another.
    rougher = find_silhouette(window, RAYS, asked._replace(smoothing_sigma=0.8 * sigma))
    assert not np.allclose(found.smoothed.depth, rougher.smoothed.depth, atol=1e-3)
    lower = find_silhouette(window, RAYS, asked._replace(edge_threshold=0.8 * threshold))
    assert len(lower.rows) > len(found.rows) > 0


def test_body_without_noise_is_smoothed_with_the_usual_sigma() -> None:
    window = window_of(*whole_body(np.full((9, 9), 2.0)))
    plain = find_silhouette(window, RAYS, Settings())
    assert same_silhouette(find_silhouette(window, RAYS, Settings(noise_factor=4.0)), plain)


def test_flying_pixels_are_no_noise() -> None:
    rng = np.random.default_rng(3)
    depth = np.pad(2.0 + rng.normal(0, 0.005, (20, 20)), 4)
    depth[5:23:2, 24] = depth[24, 5:23:2] = 2.08  # a fringe that hangs beside the body
    settings = Settings(fewest_neighbours=4, neighbour_distance=0.05, noise_factor=10.0)
    window = window_of(*whole_body(depth))
    solid = remove_flying_pixels(window, settings)
    assert depth_noise(window.depth) > 1.15 * depth_noise(solid.depth)
    least = 10.0 * depth_noise(solid.depth)
    asked = Settings(smoothing_sigma=least, edge_threshold=least)
    assert same_silhouette(
        find_silhouette(window, RAYS, settings), find_silhouette(solid, RAYS, asked)
    )


@pytest.mark.parametrize('seed', range(5))
@pytest.mark.parametrize('fewest', [0, 1, 3, 5, 8, 9])
def test_holes_take_the_median_of_enough_neighbours(seed: int, fewest: int) -> None:
    depth, labels = ragged_body(seed)
    cut, window = window_of(depth, labels), window_of(depth, labels, fewest)
    assert window[1:] == cut[1:]
    expected = fill_holes_twin(depth, labels, fewest or 9)  # 0: none, not even those of eight
    expected = np.pad(expected, 1, constant_values=np.nan)
    height, width = window.depth.shape
    np.testing.assert_array_equal(
        window.depth, expected[window.row + 1 :, window.column + 1 :][:height, :width]
    )
    filled = np.isfinite(window.depth).sum() - np.isfinite(cut.depth).sum()
    assert filled > 0 if fewest in {1, 3, 5} else fewest == 8 or filled == 0


def plane_with(holes: list[tuple[int, int]]) -> tuple[np.ndarray, np.ndarray]:
    """Return a slanting body that fills an image of 8 x 8, with holes."""
    depth, labels = whole_body(2.0 + 0.001 * np.arange(64.0).reshape(8, 8))
    for hole in holes:
        depth[hole] = 0
    return depth, labels


def pixel(window: Window, position: tuple[int, int]) -> float:
    return float(window.depth[position[0] - window.row, position[1] - window.column])


@pytest.mark.parametrize('unseen', [0.0, np.nan])
def test_hole_in_the_body_is_filled_for_any_value_of_the_mask(unseen: float) -> None:
    hole = (4, 4)
    for label in (BODY, NO_BODY, BODY + 1):
        depth, labels = plane_with([])
        depth[hole], labels[hole] = unseen, label
        window = window_of(depth, labels, 8)
        assert pixel(window, hole) == pytest.approx(2.037)  # below and left, of eight the fifth
        assert np.isinf(pixel(window_of(depth, labels), hole))


def test_pixel_with_a_depth_beside_the_body_is_not_a_hole() -> None:
    for label in (NO_BODY, BODY + 1):
        depth, labels = plane_with([])
        labels[4, 4] = label
        window = window_of(depth, labels, 1)
        assert np.isinf(pixel(window, (4, 4)))
        np.testing.assert_array_equal(window.depth, window_of(depth, labels).depth)


def test_hole_between_two_bodies_belongs_to_the_surrounding_body() -> None:
    depth, labels = plane_with([(4, 4)])
    labels[:, 5:] = BODY + 1
    depth[:, 5:] += np.float32(0.5)
    assert pixel(window_of(depth, labels, 5), (4, 4)) < 2.1
    assert np.isinf(pixel(window_of(depth, labels, 6), (4, 4)))
    for fewest in (1, 3, 5):
        other = cut_out(depth, labels, BODY + 1, fewest)
        assert other is not None
        # The hole lies on the border of the other's window, in which there is no body.
        assert np.isinf(pixel(other, (4, 4)))
        assert np.isinf(other.depth[:, 0]).all() == (other.row >= 0)


@pytest.mark.parametrize(('hole', 'seen'), [((0, 3), 5), ((3, 7), 5), ((0, 0), 3), ((7, 0), 3)])
def test_pixels_outside_of_the_image_neither_count_nor_are_filled(
    hole: tuple[int, int], seen: int
) -> None:
    depth, labels = plane_with([hole])
    window = window_of(depth, labels, seen)
    assert np.isfinite(pixel(window, hole))
    assert np.isinf(pixel(window_of(depth, labels, seen + 1), hole))
    rim = window.depth.copy()
    rim[1:-1, 1:-1] = np.nan
    assert np.isnan(rim).all()


def test_filled_pixels_fill_no_others() -> None:
    """Two holes side by side have seven neighbours each, a row of three has six in its middle."""
    depth, labels = plane_with([(4, 3), (4, 4), (4, 5)])
    assert np.isinf(window_of(depth, labels, 8).depth[1:-1, 1:-1]).sum() == 3
    assert np.isinf(window_of(depth, labels, 7).depth[1:-1, 1:-1]).sum() == 1
    assert np.isfinite(window_of(depth, labels, 6).depth[1:-1, 1:-1]).all()


def test_single_pixel_does_not_grow() -> None:
    depth, labels = np.zeros((5, 5), np.float32), np.full((5, 5), BODY, np.int32)
    depth[2, 2] = 2.0
    assert np.isfinite(window_of(depth, labels, 1).depth).sum() == 1
    assert cut_out(np.zeros_like(depth), labels, BODY, 1) is None


def test_filling_does_not_change_its_argument() -> None:
    depth, labels = plane_with([(4, 4)])
    window = window_of(depth, labels)
    before = window.depth.copy()
    assert np.isfinite(pixel(fill_holes(window, depth, 5), (4, 4)))
    np.testing.assert_array_equal(window.depth, before)


def test_scattered_missing_pixels_make_edges_unless_they_are_filled() -> None:
    rng = np.random.default_rng(4)
    depth = np.zeros((50, 60), np.float32)
    body = np.s_[5:45, 10:50]
    depth[body] = 2.0
    labels = np.where(depth > 0, BODY, NO_BODY).astype(np.int32)
    holes = np.zeros(depth.shape, bool)
    holes[8:42:3, 13:47:3] = rng.random((12, 12)) < 0.5
    depth[holes] = 0
    outline = (labels == BODY).copy()
    outline[6:44, 11:49] = False
    for fewest, inner in ((5, 0), (0, 8 * holes.sum())):
        settings = Settings(fill_holes=fewest, points=10_000)
        shape = describe_body(depth, labels, CAMERA, BODY, settings)
        assert shape is not None
        found = np.zeros(depth.shape, bool)
        found[shape.silhouette.rows, shape.silhouette.columns] = True
        assert found[outline].all()
        assert found[~outline].sum() == inner
