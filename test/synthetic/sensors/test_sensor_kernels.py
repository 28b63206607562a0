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

"""Tests each kernel of the noise models against a reference written from the equations."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.synthetic.scene.depth_image import DepthImage
from lsc_pose_ros.synthetic.sensors.correlated_noise import (
    correlated_field,
    grid_interpolation,
    interpolate_grid,
)
from lsc_pose_ros.synthetic.sensors.optics import DepthRange, focal_length, nearest_pixel, slope
from lsc_pose_ros.synthetic.sensors.time_of_flight import (
    KINECT_V2,
    MAX_ANGLE,
    MIXED_PIXEL_DEPTH,
    TOF,
    RandomFields,
    TimeOfFlight,
    expose,
    noise_deviation,
)
from lsc_pose_ros.synthetic.sensors.triangulation import (
    HALF_PIXEL,
    LOGISTIC_SCALE,
    RANGE_FADING,
    InverseDepth,
    average_window,
    match_windows,
    normal_quantile,
    quantise,
    see_surfaces,
)
from lsc_pose_ros.synthetic.sensors.triangulation_sensors import (
    KINECT_V1,
    REALSENSE,
    ZED,
    Triangulation,
)

WIDTH, HEIGHT = 40, 30
CAMERA = Intrinsics(36.0, 34.0, 19.0, 15.5)
DEPTH_RANGE = DepthRange(1.2, 3.0)


def random_image(seed: int) -> DepthImage:
    """Return a wavy slope with holes, a box in front of it, and an empty margin."""
    random = np.random.default_rng(seed)
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    depth = 2 + 0.03 * rows + 0.1 * np.sin(columns / 3)
    depth[8:20, 15:25] = 1.4
    depth[2:6, 12:16] = 1.0
    depth[25:, 30:] = 4.5
    depth[random.random(depth.shape) < 0.1] = 0.0
    depth[:, :8] = 0.0
    labels = np.where(depth > 0, 1 + (columns > 20), NO_BODY)
    labels[depth > 2.5] = NO_BODY
    return DepthImage(depth.astype(np.float32), labels.astype(np.int32))


def normal(seed: int, *shape: int) -> NDArray[np.float32]:
    return np.random.default_rng(seed).standard_normal(shape).astype(np.float32)


def naive_slope(depth: NDArray[np.float32], row: int, column: int, focal: float) -> float:
    changes = []
    for down, right in ((1, 0), (0, 1)):
        own = []
        for sign in (-1, 1):
            at = row + sign * down, column + sign * right
            inside = 0 <= at[0] < depth.shape[0] and 0 <= at[1] < depth.shape[1]
            if inside and depth[at] > 0:
                own.append(abs(float(depth[at]) - float(depth[row, column])))
        changes.append(min(own, default=0.0))
    return math.hypot(*changes) * focal / float(depth[row, column])


def test_slope_agrees_with_its_reference() -> None:
    depth = random_image(3).depth
    for row, column in np.argwhere(depth > 0):
        found = slope(depth, row, column, 36.0)
        assert found == pytest.approx(naive_slope(depth, row, column, 36.0), rel=1e-6)


@pytest.mark.parametrize('angle', [0.0, 30.0, 60.0, 80.0])
def test_slope_of_a_rotated_wall_is_the_tangent_of_its_angle(angle: float) -> None:
    tangent = math.tan(math.radians(angle))
    rays = (np.arange(101) - 50) / 1000.0
    row = (2.0 / (1.0 - tangent * rays)).astype(np.float32)
    depth = np.tile(row, (3, 1))
    assert slope(depth, 1, 50, 1000.0) == pytest.approx(tangent, rel=0.01, abs=1e-6)


@pytest.mark.parametrize(
    ('position', 'pixel'), [(-7.0, 0), (-0.5, 0), (0.49, 0), (0.5, 1), (3.2, 3), (9.0, 4)]
)
def test_nearest_pixel_is_within_the_image(position: float, pixel: int) -> None:
    assert nearest_pixel(position, 5) == pixel


def test_focal_length_gives_the_field_of_view() -> None:
    assert focal_length(640, 90.0) == pytest.approx(320.0)
    assert 2 * math.degrees(math.atan(88 / focal_length(176, 43.6))) == pytest.approx(43.6)


@pytest.mark.parametrize('spacing', [1.3, 3.0, 7.7, 100.0])
def test_interpolation_agrees_with_its_reference(spacing: float) -> None:
    rows, columns = (
        grid_interpolation(HEIGHT, spacing, 0.3),
        grid_interpolation(WIDTH, spacing, 0.9),
    )
    values = normal(1, int(rows.first[-1]) + 2, int(columns.first[-1]) + 2)
    found = np.empty((HEIGHT, WIDTH), np.float32)
    interpolate_grid(values, rows, columns, found)

    expected = np.empty((HEIGHT, WIDTH))
    for row in range(HEIGHT):
        for column in range(WIDTH):
            y, x = row / spacing + 0.3, column / spacing + 0.9
            down, right = y - math.floor(y), x - math.floor(x)
            patch = values[math.floor(y) : math.floor(y) + 2, math.floor(x) : math.floor(x) + 2]
            weights = np.outer([1 - down, down], [1 - right, right])
            expected[row, column] = (weights * patch).sum() / np.sqrt((weights**2).sum())
    np.testing.assert_allclose(found, expected, atol=1e-5)


def correlation(gap: float) -> float:
    """Return the mean correlation of two positions at a distance of `gap` grid spacings."""
    position = np.linspace(0, 1, 2001)[:, None] + np.array([0, gap])
    # The weight of a node decreases linearly to zero at its neighbours.
    weights = np.maximum(1 - np.abs(position[..., None] - np.arange(-1, 5)), 0)
    weights /= np.linalg.norm(weights, axis=-1, keepdims=True)
    return float((weights[:, 0] * weights[:, 1]).sum(axis=-1).mean()) if gap < 1 else 0.0


@pytest.mark.parametrize('spacing', [0.4, 2.5, 6.0])
def test_correlated_field_has_deviation_one_and_the_given_correlation_length(
    spacing: float,
) -> None:
    random = np.random.default_rng(0)
    fields = np.stack([correlated_field((24, 26), spacing, random) for _ in range(1500)])
    assert fields.dtype == np.float32
    np.testing.assert_allclose(fields.std(axis=0), 1.0, atol=0.1)
    inverse_depth = (fields[:, :, 1:] * fields[:, :, :-1]).mean()
    gap = math.ceil(2 * spacing)
    far = (fields[:, :, gap:] * fields[:, :, :-gap]).mean()
    assert abs(far) < 0.02
    assert inverse_depth == pytest.approx(correlation(1 / spacing), abs=0.02)


def naive_surfaces(
    image: DepthImage, sensor: Triangulation, lost_noise: NDArray[np.float32]
) -> NDArray[np.float64]:
    inverse_depth = np.zeros((HEIGHT, WIDTH))
    gone = np.zeros((HEIGHT, WIDTH), bool)
    move, focal = CAMERA.fx * sensor.baseline, (CAMERA.fx + CAMERA.fy) / 2
    steep = math.tan(math.radians(sensor.grazing_angle))
    chance = 1 / (1 + np.exp(-LOGISTIC_SCALE * lost_noise.astype(float)))
    for row, column in np.argwhere(image.depth > 0):
        z = float(image.depth[row, column])
        position = column - move / z
        farther_right = range(column + 1, WIDTH)
        hidden = any(
            image.depth[row, other] > 0
            and other - move / float(image.depth[row, other]) - HALF_PIXEL < position
            for other in farther_right
        )
        outside = sensor.cameras == 2 and position < -HALF_PIXEL
        tilt = naive_slope(image.depth, row, column, focal)
        loss = sensor.dropout + max(0, 1 - steep / tilt if tilt > 0 else 0)
        loss += max(0, (z / DEPTH_RANGE.farthest - 1) / RANGE_FADING)
        inverse_depth[row, column] = 1 / z
        gone[row, column] = (
            hidden or outside or z < DEPTH_RANGE.nearest or chance[row, column] < loss
        )
    return np.where(gone, -inverse_depth, inverse_depth)


@pytest.mark.parametrize(
    'sensor',
    [
        KINECT_V1._replace(baseline=0.4, grazing_angle=40.0),
        REALSENSE._replace(baseline=0.2, grazing_angle=30.0, dropout=0.1),
        ZED._replace(baseline=0.3),
    ],
)
def test_visible_surfaces_agree_with_the_reference(sensor: Triangulation) -> None:
    image, lost_noise = random_image(1), normal(2, HEIGHT, WIDTH)
    found = np.empty((HEIGHT, WIDTH), np.float32)
    see_surfaces(image.depth, sensor, DEPTH_RANGE, CAMERA, lost_noise, found)
    expected = naive_surfaces(image, sensor, lost_noise)
    np.testing.assert_allclose(found, expected, rtol=1e-6)
    missing = found < 0
    assert 20 < missing.sum() < 0.7 * (image.depth > 0).sum()


def test_quantile_of_the_normal_distribution() -> None:
    values = np.random.default_rng(0).standard_normal(100_000)
    for probability in (0.02, 0.2, 0.5, 0.9):
        assert (values < normal_quantile(probability)).mean() == pytest.approx(
            probability, abs=0.012
        )
    assert normal_quantile(0.0) == -math.inf
    assert normal_quantile(1.0) == normal_quantile(7.0) == math.inf


@pytest.mark.parametrize('scale', [0.0, 0.7, 3.0, 500.0])
@pytest.mark.parametrize('growth', [0.0, 0.8, 2.5])
def test_matching_agrees_with_its_reference(scale: float, growth: float) -> None:
    image = random_image(4)
    with np.errstate(divide='ignore'):
        inverse_depth = np.where(image.depth > 0, 1 / image.depth, 0).astype(np.float32)
    inverse_depth[normal(15, HEIGHT, WIDTH) < -1] *= -1  # lost
    shifts, fattening = np.float32(scale) * normal(5, 2, HEIGHT, WIDTH), normal(6, HEIGHT, WIDTH)
    fattening = np.float32(growth) * (1 + fattening)
    found = InverseDepth(np.empty_like(inverse_depth), np.empty_like(image.labels))
    match_windows(InverseDepth(inverse_depth, image.labels), shifts, fattening, 0.1, found)

    for row in range(HEIGHT):
        for column in range(WIDTH):
            middle = np.array([row, column]) + np.floor(shifts[:, row, column].astype(float) + 0.5)
            middle = np.clip(middle, 0, [HEIGHT - 1, WIDTH - 1]).astype(int)
            radius = max(0, math.floor(float(fattening[row, column]) + 0.5))
            depth_range = radius * np.array([[-1, 0], [1, 0], [0, -1], [0, 1]])
            places = np.clip(middle + depth_range, 0, [HEIGHT - 1, WIDTH - 1])
            values = inverse_depth[places[:, 0], places[:, 1]]
            own = tuple(middle)
            grows = values.max() > abs(float(inverse_depth[own])) + 0.1
            best = tuple(places[np.argmax(values)]) if grows else own
            assert found.inverse_depth[row, column] == max(inverse_depth[best], 0)
            assert found.labels[row, column] == image.labels[best]


@pytest.mark.parametrize('radius', [0, 1, 4, 100])
def test_averaging_agrees_with_its_reference(radius: int) -> None:
    inverse_depth = random_image(7).depth.copy()
    found = average_window(inverse_depth, radius, 0.2)
    expected = inverse_depth.astype(float)
    for axis in (1, 0):
        before = expected.astype(np.float32).astype(float)
        lines = before if axis == 1 else before.T
        averaged = np.zeros_like(lines)
        for line, values in enumerate(lines):
            for position, middle in enumerate(values):
                window = values[max(position - radius, 0) : position + radius + 1]
                window = window[(window > 0) & (abs(window - middle) <= 0.2)]
                averaged[line, position] = window.mean() if middle > 0 else 0
        expected = averaged if axis == 1 else averaged.T
    np.testing.assert_allclose(found, expected, rtol=1e-5)


@pytest.mark.parametrize('sensor', [KINECT_V1, REALSENSE, ZED])
@pytest.mark.parametrize('scale', [0.0, 1.0, 300.0])
def test_quantisation_agrees_with_its_reference(sensor: Triangulation, scale: float) -> None:
    image, noise = random_image(8), np.float32(scale) * normal(9, HEIGHT, WIDTH)
    found = DepthImage(np.empty_like(image.depth), image.labels.copy())
    quantise(image.depth, noise, sensor, found)
    inverse_depth = image.depth.astype(float)
    whole = np.floor((inverse_depth + sensor.deviation * noise) / sensor.step + 0.5)
    measured = (inverse_depth > 0) & (whole >= 1)
    expected = np.where(measured, 1 / (np.where(measured, whole, 1) * sensor.step), 0)
    np.testing.assert_allclose(found.depth, expected, rtol=1e-6)
    np.testing.assert_array_equal(found.labels, np.where(measured, image.labels, NO_BODY))


def naive_mix(
    depth: NDArray[np.float32], middle: NDArray[np.float64], half: float, gap: float
) -> tuple[float, tuple[int, int]]:
    """Integrate the square over all pixels of the image, extended by its edge pixels."""
    margin = 3 + math.ceil(half)
    wide = np.pad(depth.astype(float), margin, mode='edge')
    cells = []
    for count, position in zip(wide.shape, middle + margin, strict=True):
        low = np.maximum(np.arange(count) - 0.5, position - half)
        cells.append(np.maximum(np.minimum(np.arange(count) + 0.5, position + half) - low, 0))
    filled = np.outer(*cells)
    solid = wide > 0
    light = np.where(solid, filled, 0) / np.where(solid, wide, 1) ** 2
    wall = wide[(filled > 0) & solid].max() + gap
    behind = filled[~solid].sum() / wall**2
    if behind >= light.sum():
        return 0.0, (0, 0)
    row, column = np.unravel_index(np.argmax(light), light.shape)
    at = (
        int(np.clip(row - margin, 0, depth.shape[0] - 1)),
        int(np.clip(column - margin, 0, depth.shape[1] - 1)),
    )
    return float(((light * wide).sum() + behind * wall) / (light.sum() + behind)), at


@pytest.mark.parametrize('sensor', [TOF, KINECT_V2._replace(area=3.3), TOF._replace(area=40.0)])
def test_exposure_agrees_with_its_reference(sensor: TimeOfFlight) -> None:
    sensor = sensor._replace(focal=60.0)
    clean = random_image(10)
    random = np.random.default_rng(11)
    fields = RandomFields(
        np.float32(0.6) * normal(12, 2, HEIGHT, WIDTH),
        normal(13, HEIGHT, WIDTH),
        random.random((HEIGHT, WIDTH)).astype(np.float32),
        1.7,
    )
    found = DepthImage(np.zeros_like(clean.depth), np.full_like(clean.labels, NO_BODY))
    expose(clean, sensor, DEPTH_RANGE, CAMERA, fields, found)

    half = sensor.area * CAMERA.fx / sensor.focal / 2
    last = np.array([HEIGHT - 1, WIDTH - 1])
    flying = 0
    for row in range(HEIGHT):
        for column in range(WIDTH):
            middle = np.array([row, column]) + fields.shifts[:, row, column].astype(float)
            sides = [np.clip(np.floor(middle + s + 0.5), 0, last) for s in (-half, half)]
            (above, left), (below, right) = np.array(sides).astype(int)
            corners = clean.depth[[above, above, below, below], [left, right, left, right]]
            drop = float(fields.drop[row, column])
            at = tuple(np.clip(np.floor(middle + 0.5), 0, last).astype(int))
            z = float(clean.depth[at])
            if np.ptp(corners) > MIXED_PIXEL_DEPTH:
                flying += 1
                z, at = naive_mix(clean.depth, middle, half, fields.gap)
                z = 0.0 if drop < sensor.filtered_fraction else z
            expected, label = 0.0, NO_BODY
            if z >= DEPTH_RANGE.nearest:
                tilt = naive_slope(clean.depth, *at, (CAMERA.fx + CAMERA.fy) / 2)
                if drop < (DEPTH_RANGE.farthest / z) ** 2 * math.cos(math.atan(tilt)):
                    spread = noise_deviation(sensor, z, tilt)
                    expected = max(z + spread * fields.noise[row, column], DEPTH_RANGE.nearest)
                    label = clean.labels[at]
            assert found.depth[row, column] == pytest.approx(expected, rel=1e-5)
            assert found.labels[row, column] == label
    assert flying > 100


@pytest.mark.parametrize('angle', [0.0, 30.0, 60.0, 79.0, 89.0])
def test_time_of_flight_deviation_agrees_with_its_formula(angle: float) -> None:
    turned = min(math.radians(angle), MAX_ANGLE)
    z = 2.3
    expected = 1.5 - 0.5 * z + 0.3 * z**2
    expected += 0.1 * z**1.5 * turned**2 / (math.pi / 2 - turned) ** 2
    found = 1000 * noise_deviation(KINECT_V2, z, math.tan(math.radians(angle)))
    assert found == pytest.approx(expected, rel=1e-6)
