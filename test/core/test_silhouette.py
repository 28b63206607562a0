import numpy as np
import pytest

from lsc_pose_ros.core.camera import Intrinsics, back_project
from lsc_pose_ros.core.frame import NO_BODY
from lsc_pose_ros.core.plain import silhouette as plain
from lsc_pose_ros.core.settings import Settings
from lsc_pose_ros.core.silhouette import (
    Window,
    choose_uniformly,
    cut_out,
    drop_flying,
    find_edges,
    find_silhouette,
    smooth,
)

CAMERA = Intrinsics(280.0, 285.0, 30.0, 20.0)


def random_body(seed: int, shape: tuple[int, int] = (40, 60)) -> tuple[np.ndarray, np.ndarray]:
    """Return a ragged body with holes and steps in depth, and its labels."""
    rng = np.random.default_rng(seed)
    depth = rng.choice([2.0, 2.03, 2.2, 3.0], shape) + rng.normal(0, 0.01, shape)
    depth[rng.random(shape) < 0.1] = 0
    labels = np.where(rng.random(shape) < 0.7, 3, NO_BODY).astype(np.int32)
    return depth.astype(np.float32), labels


def smooth_twin(depth: np.ndarray, window: Window, sigma: float) -> np.ndarray:
    """Equation 1 with all points back-projected first."""
    rows, columns = np.indices(depth.shape)
    flat = np.where(np.isfinite(depth), depth, 0)
    points = back_project(columns + window.column, rows + window.row, flat, CAMERA).astype(float)
    result = depth.copy()
    for i, j in np.argwhere(np.isfinite(depth)):
        near = np.s_[i - 1 : i + 2, j - 1 : j + 2]
        inside = np.isfinite(depth[near])
        distance = np.linalg.norm(points[near] - points[i, j], axis=-1)
        weight = np.where(inside, np.exp(-(distance**2) / (2 * sigma**2)), 0)
        result[i, j] = (weight * flat[near]).sum() / weight.sum()
    return result


def drop_flying_twin(depth: np.ndarray, fewest: int, distance: float) -> np.ndarray:
    """What has fewer than `fewest` of its eight neighbours within `distance` of its depth."""
    kept = depth.copy()
    for i, j in np.argwhere(np.isfinite(depth)):
        near = np.abs(depth[i - 1 : i + 2, j - 1 : j + 2] - depth[i, j]) <= np.float32(distance)
        if near.sum() - 1 < fewest:
            kept[i, j] = np.inf
    return kept


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
    depth, labels = random_body(seed)
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
    depth, labels = random_body(0)
    assert cut_out(depth, labels, 4) is None
    assert cut_out(np.zeros_like(depth), labels, 3) is None


@pytest.mark.parametrize('seed', range(5))
@pytest.mark.parametrize('sigma', [0.005, 0.02, 1.0])
def test_smooth_is_equation_1(seed: int, sigma: float) -> None:
    depth, labels = random_body(seed)
    window = cut_out(depth, labels, 3)
    assert window is not None
    expected = smooth_twin(window.depth, window, sigma)
    for function in (smooth, plain.smooth):
        np.testing.assert_allclose(function(window, CAMERA, sigma), expected, atol=2e-5)


@pytest.mark.parametrize('seed', range(5))
@pytest.mark.parametrize('fewest', [0, 1, 3, 8, 9])
def test_flying_pixels_are_those_with_few_neighbours_at_their_depth(
    seed: int, fewest: int
) -> None:
    depth, labels = random_body(seed)
    window = cut_out(depth, labels, 3)
    assert window is not None
    kept = drop_flying(window.depth, fewest, 0.1)
    np.testing.assert_array_equal(kept, drop_flying_twin(window.depth, fewest, 0.1))
    assert (np.isfinite(kept).sum() == np.isfinite(window.depth).sum()) == (fewest == 0)


def test_a_silhouette_is_found_without_flying_pixels_where_the_settings_say_so() -> None:
    depth = np.zeros((30, 30), np.float32)
    depth[8:22, 8:22] = 2.0
    flying = np.zeros(depth.shape, bool)
    flying[8:22:2, 22] = True  # every other pixel along one side, on the way to the wall
    depth[flying] = 2.6
    window = cut_out(depth, np.zeros(depth.shape, np.int32), 0)
    assert window is not None
    silhouette = find_silhouette(window, CAMERA, Settings(fewest_neighbours=3))
    assert set(silhouette.columns.tolist()) == set(range(8, 22))
    assert len(silhouette.points) == 4 * 13  # corners have three neighbours
    raw = find_silhouette(window, CAMERA, Settings(fewest_neighbours=0))
    assert flying[raw.rows, raw.columns].sum() == 7


def test_flying_pixels_are_no_reason_to_take_out_what_the_image_cuts() -> None:
    depth = np.full((10, 10), 2.0, np.float32)
    window = cut_out(depth, np.ones((10, 10), np.int32), 1)
    assert window is not None
    np.testing.assert_array_equal(drop_flying(window.depth, 3, 0.1), window.depth)


def test_smooth_with_sigma_zero_and_of_one_pixel_changes_nothing() -> None:
    depth = np.zeros((5, 5), np.float32)
    depth[0, 4] = 2.5
    labels = np.zeros((5, 5), np.int32)
    window = cut_out(depth, labels, 0)
    assert window is not None
    for sigma in (0.0, 0.02):
        np.testing.assert_array_equal(smooth(window, CAMERA, sigma), window.depth)


@pytest.mark.parametrize('seed', range(5))
def test_edges_are_equation_2(seed: int) -> None:
    depth, labels = random_body(seed)
    window = cut_out(depth, labels, 3)
    assert window is not None
    np.testing.assert_array_equal(find_edges(window.depth, 0.04), edges_twin(window.depth, 0.04))


def test_a_flat_body_that_fills_the_image_has_no_edge() -> None:
    depth = np.full((10, 10), 2.0, np.float32)
    window = cut_out(depth, np.ones((10, 10), np.int32), 1)
    assert window is not None
    assert len(find_edges(window.depth, 0.04)) == 0


def test_an_inner_edge_is_found_on_its_near_side_only() -> None:
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


def test_silhouette_points_are_the_back_projected_pixels() -> None:
    depth, labels = random_body(1)
    window = cut_out(depth, labels, 3)
    assert window is not None
    silhouette = find_silhouette(window, CAMERA, Settings(points=50))
    assert silhouette.points.shape == (50, 3)
    rows, columns = silhouette.rows[silhouette.chosen], silhouette.columns[silhouette.chosen]
    z = silhouette.points[:, 2]
    np.testing.assert_allclose(
        silhouette.points[:, 0], (columns - CAMERA.cx) * z / CAMERA.fx, rtol=1e-5
    )
    np.testing.assert_allclose(
        silhouette.points[:, 1], (rows - CAMERA.cy) * z / CAMERA.fy, rtol=1e-5
    )
    smoothed = smooth(window, CAMERA, Settings().smoothing_sigma)
    np.testing.assert_allclose(z, smoothed[rows - window.row, columns - window.column])
