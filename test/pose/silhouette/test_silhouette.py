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

"""The window and the silhouette of a body, against equations 1 and 2."""

import numpy as np
import pytest
from plain import silhouette as plain
from ragged_body import ragged_body

from lsc_pose_ros.camera.projection import back_project
from lsc_pose_ros.camera.rays import image_rays
from lsc_pose_ros.data_types.camera import RATIONAL_POLYNOMIAL, Intrinsics, Lens
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.silhouette.preprocessing import Window
from lsc_pose_ros.pose.silhouette.silhouette import (
    choose_uniformly,
    cut_out,
    find_edges,
    find_silhouette,
    smooth,
)

CAMERA = Intrinsics(280.0, 285.0, 30.0, 20.0)
LENS = Lens(RATIONAL_POLYNOMIAL, (0.5, -0.3, 0.01, -0.02, 0.1, 0.8, -0.1, 0.02))
CAMERAS = (CAMERA, Intrinsics(80.0, 85.0, 25.0, 20.0, LENS))


def smooth_twin(depth: np.ndarray, window: Window, camera: Intrinsics, sigma: float) -> np.ndarray:
    """Equation 1 with all points back-projected first."""
    rows, columns = np.indices(depth.shape)
    flat = np.where(np.isfinite(depth), depth, 0)
    points = back_project(columns + window.column, rows + window.row, flat, camera).astype(float)
    result = depth.copy()
    for i, j in np.argwhere(np.isfinite(depth)):
        near = np.s_[i - 1 : i + 2, j - 1 : j + 2]
        inside = np.isfinite(depth[near])
        distance = np.linalg.norm(points[near] - points[i, j], axis=-1)
        weight = np.where(inside, np.exp(-(distance**2) / (2 * sigma**2)), 0)
        result[i, j] = (weight * flat[near]).sum() / weight.sum()
    return result


def edges_twin(depth: np.ndarray, threshold: float) -> np.ndarray:
    """Equation 2: the largest difference to a neighbour exceeds the threshold."""
    found = []
    for i, j in np.argwhere(np.isfinite(depth)):
        differences = depth[i - 1 : i + 2, j - 1 : j + 2] - depth[i, j]
        if np.nanmax(differences) > threshold:
            found.append((i, j))
    return np.array(found, np.int32).reshape(-1, 2)


@pytest.mark.parametrize('seed', range(5))
def test_cut_out_gives_the_body_infinity_around_it_and_nan_outside_of_the_image(seed: int) -> None:
    depth, labels = ragged_body(seed)
    window = cut_out(depth, labels, 3)
    assert window is not None
    padded = np.pad(
        np.where((labels == 3) & (depth > 0), depth, np.inf), 1, constant_values=np.nan
    )
    height, width = window.depth.shape
    np.testing.assert_array_equal(
        window.depth,
        padded[window.row + 1 :, window.column + 1 :][:height, :width].astype(np.float32),
    )
    assert np.isfinite(window.depth).sum() == ((labels == 3) & (depth > 0)).sum()


def test_cut_out_of_nobody_is_none() -> None:
    depth, labels = ragged_body(0)
    assert cut_out(depth, labels, 4) is None
    assert cut_out(np.zeros_like(depth), labels, 3) is None


@pytest.mark.parametrize('seed', range(5))
@pytest.mark.parametrize('sigma', [0.005, 0.02, 1.0])
@pytest.mark.parametrize('camera', CAMERAS)
def test_smooth_is_equation_1(seed: int, sigma: float, camera: Intrinsics) -> None:
    depth, labels = ragged_body(seed)
    window = cut_out(depth, labels, 3)
    assert window is not None
    expected = smooth_twin(window.depth, window, camera, sigma)
    rays = image_rays(camera, *depth.shape)
    for function in (smooth, plain.smooth):
        np.testing.assert_allclose(function(window, rays, sigma), expected, atol=2e-5)


def test_smooth_with_sigma_zero_and_of_one_pixel_changes_nothing() -> None:
    depth = np.zeros((5, 5), np.float32)
    depth[0, 4] = 2.5
    labels = np.zeros((5, 5), np.int32)
    window = cut_out(depth, labels, 0)
    assert window is not None
    for sigma in (0.0, 0.02):
        np.testing.assert_array_equal(
            smooth(window, image_rays(CAMERA, 5, 5), sigma), window.depth
        )


@pytest.mark.parametrize('seed', range(5))
def test_edges_are_equation_2(seed: int) -> None:
    depth, labels = ragged_body(seed)
    window = cut_out(depth, labels, 3)
    assert window is not None
    np.testing.assert_array_equal(find_edges(window.depth, 0.04), edges_twin(window.depth, 0.04))


def test_flat_body_that_fills_the_image_has_no_edge() -> None:
    depth = np.full((10, 10), 2.0, np.float32)
    window = cut_out(depth, np.ones((10, 10), np.int32), 1)
    assert window is not None
    assert len(find_edges(window.depth, 0.04)) == 0


def test_inner_edge_is_found_on_its_near_side_only() -> None:
    depth = np.full((10, 10), 2.0, np.float32)
    depth[:, 5:] = 2.5
    window = cut_out(depth, np.ones((10, 10), np.int32), 1)
    assert window is not None
    edges = find_edges(window.depth, 0.04)
    assert set(edges[:, 1].tolist()) == {5}  # column 4 of the image, 5 of the window
    assert len(edges) == 10


@pytest.mark.parametrize(('available', 'wanted'), [(0, 5), (3, 5), (5, 5), (1000, 7), (401, 400)])
def test_points_are_chosen_evenly(available: int, wanted: int) -> None:
    chosen = choose_uniformly(available, wanted)
    assert len(chosen) == min(available, wanted)
    assert len(set(chosen.tolist())) == len(chosen)
    assert all(0 <= index < available for index in chosen)
    gaps = np.diff(chosen)
    assert gaps.size == 0 or gaps.max() - gaps.min() <= 1


@pytest.mark.parametrize('camera', CAMERAS)
def test_silhouette_points_are_the_back_projected_pixels(camera: Intrinsics) -> None:
    depth, labels = ragged_body(1)
    window = cut_out(depth, labels, 3)
    assert window is not None
    rays = image_rays(camera, *depth.shape)
    silhouette = find_silhouette(window, rays, Settings(points=50))
    assert silhouette.points.shape == (50, 3)
    rows, columns = silhouette.rows[silhouette.chosen], silhouette.columns[silhouette.chosen]
    z = silhouette.points[:, 2]
    expected = back_project(columns, rows, z, camera)
    np.testing.assert_allclose(silhouette.points, expected, rtol=1e-5)
    smoothed = smooth(window, rays, Settings().smoothing_sigma)
    np.testing.assert_allclose(z, smoothed[rows - window.row, columns - window.column])
