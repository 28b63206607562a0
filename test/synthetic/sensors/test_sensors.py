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

"""Tests the sensors on simple scenes: noise, shadows and edges."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.synthetic.scene.depth_image import DepthImage
from lsc_pose_ros.synthetic.sensors.sensors import NOISES, SENSORS, apply_sensor
from lsc_pose_ros.synthetic.sensors.time_of_flight import WALL_DISTANCE

STEREO = ('realsense', 'zed')
DISPARITY = ('kinect_v1', *STEREO)
FLIGHT = ('kinect_v2', 'azure', 'tof')
WIDTH, HEIGHT = 320, 240
BODY, WALL = 1.8, 3.4


def camera_of(name: str, width: int = WIDTH, height: int = HEIGHT) -> Intrinsics:
    focal = 0.5 * width / math.tan(math.radians(0.5 * SENSORS[name].field_of_view))
    return Intrinsics(focal, focal, 0.5 * (width - 1), 0.5 * (height - 1))


def wall(distance: float, body: int = 1) -> DepthImage:
    shape = HEIGHT, WIDTH
    return DepthImage(np.full(shape, distance, np.float32), np.full(shape, body, np.int32))


def rotated_wall(distance: float, angle: float, camera: Intrinsics) -> DepthImage:
    """Return a wall in the middle of the image, rotated about the vertical axis."""
    rays = (np.arange(WIDTH) - camera.cx) / camera.fx
    depth = distance / (1 - math.tan(math.radians(angle)) * rays)
    depth = np.where((depth > 0.8 * distance) & (depth < 1.2 * distance), depth, 0)
    depth = np.tile(depth, (HEIGHT, 1)).astype(np.float32)
    return DepthImage(depth, np.where(depth > 0, 1, NO_BODY).astype(np.int32))


def box(*, room: bool, near: float = BODY, far: float = WALL) -> DepthImage:
    """Return a body of 120 by 100 pixels, with or without a wall behind it."""
    depth = np.full((HEIGHT, WIDTH), far if room else 0.0, np.float32)
    labels = np.full((HEIGHT, WIDTH), NO_BODY, np.int32)
    depth[60:180, 110:210] = near
    labels[60:180, 110:210] = 1
    return DepthImage(depth, labels)


def sensed(name: str, image: DepthImage, seed: int = 0) -> DepthImage:
    return apply_sensor(name, image, camera_of(name), np.random.default_rng(seed))


def deviation(name: str, distance: float) -> float:
    """Return the deviation over several images of a wall, because noise is correlated."""
    middle = np.s_[40:-40, 100:-40]  # stereo has no depth at the left margin
    images = [sensed(name, wall(distance), seed).depth[middle] for seed in range(4)]
    values = np.stack(images)
    return float(values[values > 0].std())


@pytest.mark.parametrize('distance', [1.0, 2.0, 4.0])
@pytest.mark.parametrize(
    ('name', 'law'),
    [
        # Khoshelham and Elberink 2012: half a step, 1.425 mm at 1 m.
        ('kinect_v1', lambda z: 0.001425 * z**2),
        # Intel: z² subpixel / (focal baseline), subpixel 0.08.
        ('realsense', lambda z: z**2 * 0.08 / (446.8 * 0.050)),
        # 1 % at 3 m, 5 % at 15 m.
        ('zed', lambda z: 0.01 * 3 * (z / 3) ** 2),
        # Fankhauser et al. 2015.
        ('kinect_v2', lambda z: 0.001 * (1.5 - 0.5 * z + 0.3 * z**2)),
    ],
)
def test_noise_on_a_wall_follows_the_law_of_its_source(name, law, distance) -> None:
    assert deviation(name, distance) == pytest.approx(law(distance), rel=0.1)


def test_noise_on_a_wall_is_within_the_specification() -> None:
    assert deviation('azure', 3.5) < 0.017
    assert deviation('azure', 1.5) == pytest.approx(deviation('kinect_v2', 1.5), rel=0.5)
    assert deviation('azure', 3.5) < 0.8 * deviation('kinect_v2', 3.5)
    assert 0.005 < deviation('tof', 2.5) < 0.02


@pytest.mark.parametrize('distance', [1.0, 2.0, 3.5])
def test_kinect_v1_has_the_measured_steps(distance: float) -> None:
    """Khoshelham and Elberink: 2.85 mm at 1 m, proportional to the square of the distance."""
    levels = np.unique(sensed('kinect_v1', wall(distance)).depth)
    assert len(levels) <= 7
    assert np.diff(levels).mean() == pytest.approx(0.00285 * distance**2, rel=0.03)


def test_steps_agree_with_a_real_kinect_v1(shared) -> None:
    """1/z comes in the same steps, but for whole millimetres and steps that no pixel has."""
    recording = next((shared / 'smoke' / 'skeltrack_upper').glob('depth-data-*'))
    recorded = np.unique(np.fromfile(recording, '<u2')).astype(float) / 1000
    recorded = recorded[(recorded > 0.6) & (recorded < 4)]
    assert len(recorded) > 30
    levels = np.unique(sensed('kinect_v1', wall(2.0)).depth).astype(float)
    steps = [np.median(-np.diff(1 / values)) for values in (recorded, levels)]
    assert steps[0] == pytest.approx(steps[1], rel=0.03)


def correlation(name: str, gap: int) -> float:
    """Return the correlation of the errors of pixels at a horizontal distance of `gap`."""
    sensor = SENSORS[name]
    image = DepthImage(np.full((240, 300), 2.0, np.float32), np.ones((240, 300), np.int32))
    focal = 0.5 * sensor.width / math.tan(math.radians(0.5 * sensor.field_of_view))
    camera = Intrinsics(focal, focal, 149.5, 119.5)
    errors = apply_sensor(name, image, camera, np.random.default_rng(3)).depth[:, 100:] - 2.0
    errors = np.where(np.abs(errors) < 0.5, errors, 0)
    return float(np.mean(errors[:, gap:] * errors[:, :-gap]) / errors.var())


def test_noise_is_correlated_over_the_matching_window_and_independent_in_time_of_flight() -> None:
    for name, width in (('kinect_v1', 2), ('realsense', 9), ('zed', 16)):
        assert correlation(name, 1) > 0.4
        assert abs(correlation(name, 2 * width + 1)) < 0.1
    assert correlation('zed', 4) > correlation('realsense', 4) > correlation('kinect_v1', 4)
    for name in FLIGHT:
        assert abs(correlation(name, 1)) < 0.02


def lost(name: str, distance: float, angle: float) -> float:
    camera = camera_of(name)
    image = rotated_wall(distance, angle, camera)
    # Inside the wall, away from its ends.
    columns = np.flatnonzero(image.depth[0] > 0)
    inner = columns[len(columns) // 4 : max(3 * len(columns) // 4, len(columns) // 4 + 1)]
    images = [apply_sensor(name, image, camera, np.random.default_rng(seed)) for seed in range(3)]
    return float(np.mean([found.depth[:, inner] == 0 for found in images]))


@pytest.mark.parametrize('name', DISPARITY)
def test_losses_of_disparity_increase_with_the_angle(name: str) -> None:
    """The wall faces the second viewpoint, so only the angle causes losses."""
    dropout = 0.03
    assert lost(name, 2.0, -20.0) < dropout
    assert lost(name, 2.0, -60.0) < dropout
    fractions = [lost(name, 2.0, angle) for angle in (-60.0, -80.0, -86.0)]
    assert fractions == sorted(fractions)
    assert fractions[-1] > 0.3


def test_losses_of_light_increase_with_distance_and_angle() -> None:
    for name in FLIGHT:
        assert lost(name, 0.6 * SENSORS[name].farthest, -50.0) == 0
        assert lost(name, 0.95 * SENSORS[name].farthest, 0.0) < 0.01
        assert 0.2 < lost(name, 0.95 * SENSORS[name].farthest, -70.0) < 0.9
        # (1 / 1.2)² of the light remains.
        assert lost(name, 1.2 * SENSORS[name].farthest, 0.0) == pytest.approx(0.306, abs=0.03)


@pytest.mark.parametrize('name', SENSORS)
def test_little_is_measured_out_of_range(name: str) -> None:
    sensor = SENSORS[name]
    assert not sensed(name, wall(0.9 * sensor.nearest)).depth.any()
    assert not sensed(name, wall(3.0 * sensor.farthest)).depth.any() or name in FLIGHT
    assert (sensed(name, wall(3.0 * sensor.farthest)).depth > 0).mean() < 0.15
    middle = sensed(name, wall(1.0)).depth[:, 100:]
    assert (middle > 0).mean() > 0.95
    assert (middle[middle > 0] >= sensor.nearest).all()


@pytest.mark.parametrize('name', DISPARITY)
def test_width_of_the_shadow_on_the_left_follows_the_baseline(name: str) -> None:
    baseline = {'kinect_v1': 0.075, 'realsense': 0.050, 'zed': 0.120}[name]
    camera = camera_of(name)
    found = np.mean([sensed(name, box(room=True), seed).depth == 0 for seed in range(6)], axis=0)
    rows = found[80:160]
    expected = camera.fx * baseline * (1 / BODY - 1 / WALL)
    left = rows[:, 90:115].sum(axis=1).mean()
    # The body grows over a part of it by edge fattening.
    assert left == pytest.approx(expected - growth(name), abs=0.5)
    right = rows[:, 205:230].sum(axis=1).mean()
    assert right < 0.5
    assert rows[:, 130:190].mean() < 0.03


def test_stereo_has_no_depth_at_the_left_margin() -> None:
    for name in STEREO:
        baseline = {'realsense': 0.050, 'zed': 0.120}[name]
        band = camera_of(name).fx * baseline / 1.0
        columns = (sensed(name, wall(1.0)).depth == 0).mean(axis=0)
        assert (columns[: int(band) - 2] > 0.9).all()
        assert columns[int(band) + 3 :].mean() < 0.03
    assert (sensed('kinect_v1', wall(1.0)).depth[:, :30] > 0).all()


def test_body_without_background_keeps_its_middle() -> None:
    for name in DISPARITY:
        found = sensed(name, box(room=False))
        assert (found.depth[70:170, 120:200] > 0).mean() > 0.97
        assert (found.labels[found.depth > 0] == 1).all()


def growth(name: str, seeds: int = 4) -> float:
    """Return by how many pixels the box grows on each side."""
    images = [sensed(name, box(room=False), seed) for seed in range(seeds)]
    count = np.mean([(image.labels == 1).sum() for image in images])
    return float((count - 120 * 100) / (2 * (120 + 100)))


def test_edges_grow_in_stereo_and_most_in_passive_stereo() -> None:
    assert abs(growth('kinect_v1')) < 0.15
    assert 0.2 < growth('realsense') < 1.0
    assert growth('realsense') < growth('zed') < 1.5


def edge_displacement(name: str) -> float:
    """Return the deviation of the position of the box's right edge, pixels of the image."""
    labels = sensed(name, box(room=True)).labels[70:170]
    return float((labels == 1).sum(axis=1).std())


def test_edges_are_displaced_by_less_than_two_pixels() -> None:
    for name in SENSORS:
        assert 0.1 < edge_displacement(name) < 2.0


def test_passive_stereo_blends_surfaces_at_similar_depths() -> None:
    """Between an arm and the trunk behind it, passive stereo shows a ramp, Kinect v1 a step."""
    depth = np.full((HEIGHT, WIDTH), 2.0, np.float32)
    depth[:, 150:170] = 1.85
    image = DepthImage(depth, np.ones((HEIGHT, WIDTH), np.int32))

    def between(name: str) -> float:
        found = sensed(name, image).depth[:, 100:]
        return float(((found > 1.89) & (found < 1.96)).mean())

    assert between('zed') > 2 * between('kinect_v1')


def distance_to_edge() -> NDArray[np.int64]:
    """Return the distance of each pixel from the nearest side of the box, pixels."""
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    down = np.maximum(60 - rows, rows - 179)
    right = np.maximum(110 - columns, columns - 209)
    outside = np.maximum(down, right)
    return np.where(outside > 0, outside, 1 - outside)


@pytest.mark.parametrize('name', FLIGHT)
def test_flying_pixels_are_at_edges_and_between_the_surfaces(name: str) -> None:
    found = sensed(name, box(room=True))
    flying = (found.depth > BODY + 0.1) & (found.depth < WALL - 0.1)
    assert flying.sum() > 20
    assert distance_to_edge()[flying].max() <= 3
    measured = found.depth > 0
    assert (np.abs(found.depth[measured & ~flying] - BODY) < 0.1).sum() > 10_000
    assert found.depth[measured].min() > BODY - 0.1
    assert found.depth[measured].max() < WALL + 0.15
    # Pixels at the depth of the body or the wall have its label.
    assert (found.labels[measured & (found.depth < BODY + 0.1)] == 1).mean() > 0.999
    assert (found.labels[measured & (found.depth > WALL - 0.1)] == NO_BODY).mean() > 0.999
    assert {1, NO_BODY} == set(found.labels[flying])


@pytest.mark.parametrize('name', FLIGHT)
def test_flying_pixels_without_background_keep_the_label_of_the_body(name: str) -> None:
    found = sensed(name, box(room=False))
    flying = found.depth > BODY + 0.1
    assert flying.sum() > 5
    assert distance_to_edge()[flying].max() <= 3
    assert found.depth.max() < BODY + WALL_DISTANCE[1]
    np.testing.assert_array_equal(found.labels == NO_BODY, found.depth == 0)
    # The body returns more light than the wall, so it wins in more than half of the mixed pixels.
    assert abs(growth(name)) < 1.0


def test_sensors_drop_different_fractions_of_flying_pixels() -> None:
    def count(name: str) -> int:
        found = sensed(name, box(room=True))
        return int(((found.depth > BODY + 0.1) & (found.depth < WALL - 0.1)).sum())

    assert count('azure') < count('kinect_v2') < count('tof')
    for name in DISPARITY:
        found = sensed(name, box(room=True))
        assert ((found.depth > BODY + 0.3) & (found.depth < WALL - 0.4)).sum() < 10


def test_no_noise_leaves_the_image_unchanged() -> None:
    image = box(room=True)
    random = np.random.default_rng(0)
    assert apply_sensor('none', image, camera_of('tof'), random) is image
    assert random.random() == np.random.default_rng(0).random()


def test_noises_have_the_names_of_sensors() -> None:
    assert set(NOISES) == {*SENSORS, 'none'}
    for name, sensor in SENSORS.items():
        assert sensor.name == name
        assert sensor.noise in NOISES
        assert sensor.nearest < sensor.farthest


@pytest.mark.parametrize('name', SENSORS)
def test_noise_depends_only_on_the_state_of_the_generator(name: str) -> None:
    image = box(room=True)
    kept = DepthImage(image.depth.copy(), image.labels.copy())
    first, again, other = (sensed(name, image, seed) for seed in (5, 5, 6))
    np.testing.assert_array_equal(first.depth, again.depth)
    np.testing.assert_array_equal(first.labels, again.labels)
    assert (first.depth != other.depth).any()
    np.testing.assert_array_equal(image.depth, kept.depth)
    np.testing.assert_array_equal(image.labels, kept.labels)
    assert first.depth.dtype == np.float32
    assert first.labels.dtype == np.int32


@pytest.mark.parametrize('name', SENSORS)
@pytest.mark.parametrize('shape', [(1, 1), (1, 40), (40, 1), (17, 16), (300, 500)])
def test_images_of_any_size_are_accepted(name: str, shape: tuple[int, int]) -> None:
    height, width = shape
    camera = camera_of(name, width, height)
    nothing = DepthImage(np.zeros(shape, np.float32), np.full(shape, NO_BODY, np.int32))
    found = apply_sensor(name, nothing, camera, np.random.default_rng(0))
    assert not found.depth.any()
    assert (found.labels == NO_BODY).all()

    solid = DepthImage(np.full(shape, 2.0, np.float32), np.full(shape, 3, np.int32))
    found = apply_sensor(name, solid, camera, np.random.default_rng(0))
    assert found.depth.shape == found.labels.shape == shape
    assert np.isfinite(found.depth).all()
    np.testing.assert_array_equal(found.labels, np.where(found.depth > 0, 3, NO_BODY))


def test_effects_in_pixels_scale_with_the_image() -> None:
    def shadow(width: int) -> float:
        camera = camera_of('zed', width, width * 3 // 4)
        depth = np.full((40, width), 3.4, np.float32)
        depth[:, width // 2 :] = 1.8
        image = DepthImage(depth, np.ones(depth.shape, np.int32))
        found = apply_sensor('zed', image, camera, np.random.default_rng(0)).depth[:, width // 4 :]
        return float((found == 0).sum() / 40)

    assert shadow(1280) == pytest.approx(4 * shadow(320), rel=0.25)
