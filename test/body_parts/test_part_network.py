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


"""The depth grid and the network of body parts, against plain numpy."""

import numpy as np
import pytest
from random_depth import random_depth

from lsc_pose_ros.body_parts.classes import CLASSES, NOT_A_PERSON
from lsc_pose_ros.body_parts.depth_grid import FARTHEST, depth_grid, grid_step, reduce_depth
from lsc_pose_ros.body_parts.part_network import (
    CELL_WIDTH,
    FARTHEST_MIDDLE,
    INPUTS,
    OUTPUTS,
    Layer,
    PartNetwork,
    classify,
    input_planes,
    score_cells,
)
from lsc_pose_ros.data_types.camera import Intrinsics

CAMERA = Intrinsics(140.0, 150.0, 79.5, 59.5)


def random_network(seed: int = 0) -> PartNetwork:
    """Return a network of few planes, with weights that keep the values in their range."""
    rng = np.random.default_rng(seed)

    def layer(outputs: int, inputs: int, *cells: int) -> Layer:
        weights = rng.normal(0, 0.3, (outputs, inputs, *cells)).astype(np.float32)
        return Layer(weights, rng.normal(0, 0.1, outputs).astype(np.float32))

    return PartNetwork(
        layer(4, INPUTS, 9),
        *(layer(6, 4, 9), layer(6, 6, 9)),
        *(layer(8, 6, 9), layer(8, 8, 9)),
        *(layer(10, 8, 9), layer(10, 10, 9), layer(10, 10, 9)),
        *(layer(8, 10), layer(8, 8, 9)),
        *(layer(6, 8), layer(6, 6, 9)),
        *(layer(4, 6), layer(5, 4, 9)),
        layer(OUTPUTS, 5),
    )


def convolved(planes: np.ndarray, layer: Layer) -> np.ndarray:
    if layer.weights.ndim == 2:
        return np.einsum('oc,cij->oij', layer.weights, planes) + layer.bias[:, None, None]
    height, width = planes.shape[1:]
    padded = np.pad(planes, ((0, 0), (1, 1), (1, 1)))
    result = np.zeros((len(layer.bias), height, width)) + layer.bias[:, None, None]
    for u, v in np.ndindex(3, 3):
        shifted = padded[:, u : u + height, v : v + width]
        result += np.einsum('oc,cij->oij', layer.weights[:, :, 3 * u + v], shifted)
    return result


def doubled(planes: np.ndarray, like: np.ndarray) -> np.ndarray:
    twice = planes.repeat(2, axis=1).repeat(2, axis=2)
    return twice[:, : like.shape[1], : like.shape[2]]


def scores_twin(planes: np.ndarray, network: PartNetwork) -> np.ndarray:
    """Return the outputs, shape (OUTPUTS, h, w)."""

    def positive(values: np.ndarray) -> np.ndarray:
        return np.maximum(values, 0)

    def residual(values: np.ndarray, layer: Layer) -> np.ndarray:
        return positive(values + convolved(values, layer))

    def halved(values: np.ndarray, layer: Layer) -> np.ndarray:
        return positive(convolved(values, layer)[:, ::2, ::2])

    def from_above(values: np.ndarray, above: np.ndarray, layer: Layer) -> np.ndarray:
        return positive(values + doubled(convolved(above, layer), values))

    level_0 = positive(convolved(planes, network.down_0))
    level_1 = residual(halved(level_0, network.halve_1), network.down_1)
    level_2 = residual(halved(level_1, network.halve_2), network.down_2)
    level_3 = residual(halved(level_2, network.halve_3), network.down_3a)
    level_3 = residual(level_3, network.down_3b)
    level_2 = residual(from_above(level_2, level_3, network.up_2), network.refine_2)
    level_1 = residual(from_above(level_1, level_2, network.up_1), network.refine_1)
    level_0 = from_above(level_0, level_1, network.up_0)
    return convolved(positive(convolved(level_0, network.refine_0)), network.scores)


@pytest.mark.parametrize('step', [1, 2, 3, 4])
@pytest.mark.parametrize('seed', range(3))
def test_a_cell_shows_its_middle_pixel_or_the_first_with_a_depth(step: int, seed: int) -> None:
    depth = random_depth(seed)
    reduced = reduce_depth(depth, step)
    assert reduced.shape == (30 // step, 41 // step)
    for i, j in np.ndindex(reduced.shape):
        block = depth[i * step : (i + 1) * step, j * step : (j + 1) * step]
        candidates = [block[step // 2, step // 2], *block.ravel()]
        known = [value for value in candidates if 0 < value < FARTHEST]
        assert reduced[i, j] == (known[0] if known else 0)


def test_images_of_all_sizes_have_about_as_many_cells() -> None:
    for width in (160, 176, 320, 512, 640, 1280):
        assert 120 <= width // grid_step(width) <= 240
    assert grid_step(16) == 1


def test_a_grid_has_the_focal_lengths_of_its_cells() -> None:
    grid = depth_grid(np.ones((480, 640), np.float32), Intrinsics(520.0, 530.0, 320.0, 240.0))
    assert grid.step == 4
    assert grid.depth.shape == (120, 160)
    assert grid.focal_lengths == (130.0, 132.5)


@pytest.mark.parametrize('seed', range(3))
def test_the_network_sees_widths_and_slopes(seed: int) -> None:
    depth = reduce_depth(random_depth(seed), 1)
    planes = input_planes(depth, (70.0, 80.0))
    focal_length = np.sqrt(70.0 * 80.0)
    expected = np.zeros_like(planes)
    for i, j in np.argwhere(depth > 0):
        z = float(depth[i, j])
        expected[0, i, j] = np.clip(np.log(z / (focal_length * CELL_WIDTH)), -3, 3)
        expected[1, i, j] = 1
        expected[4, i, j] = min(z / 3 - 1, 2)
        for plane, (di, dj) in ((2, (0, 1)), (3, (1, 0))):
            if not (di <= i < 30 - di and dj <= j < 41 - dj):
                continue
            before, after = float(depth[i - di, j - dj]), float(depth[i + di, j + dj])
            if before > 0 and after > 0:
                slope = (after - before) / (2 * z / focal_length)
                expected[plane, i, j] = slope / (1 + abs(slope))
    np.testing.assert_allclose(planes, expected, rtol=1e-5, atol=1e-5)


def test_what_the_network_sees_does_not_depend_on_the_camera() -> None:
    """A camera with twice the focal length sees the same slopes at twice the distance."""
    depth = reduce_depth(random_depth(0), 1)
    near, far = input_planes(depth, (70.0, 70.0)), input_planes(2 * depth, (140.0, 140.0))
    np.testing.assert_allclose(far[0], near[0], atol=1e-5)
    np.testing.assert_array_equal(far[1], near[1])


@pytest.mark.parametrize('shape', [(1, 1), (5, 9), (16, 24), (23, 31)])
def test_scores_are_those_of_the_layers(shape: tuple[int, int]) -> None:
    network = random_network()
    planes = np.random.default_rng(7).normal(size=(INPUTS, *shape)).astype(np.float32)
    flat = score_cells(planes, network)
    found = flat.reshape(OUTPUTS, shape[0] + 2, shape[1] + 2)[:, 1:-1, 1:-1]
    expected = scores_twin(planes.astype(float), network)
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-4 * np.abs(expected).max())


@pytest.mark.parametrize('stride', [1, 2, 3])
@pytest.mark.parametrize('seed', range(3))
def test_probabilities_are_those_of_the_scores(seed: int, stride: int) -> None:
    network = random_network(seed)
    grid = depth_grid(random_depth(seed), CAMERA)
    parts = classify(grid, network, stride, 5.0)
    depth = grid.depth[::stride, ::stride]
    np.testing.assert_array_equal(parts.depth, depth)
    known = (depth > 0) & (depth <= 5.0)
    assert not parts.person[~known].any()
    fx, fy = grid.focal_lengths
    planes = input_planes(np.ascontiguousarray(depth), (fx / stride, fy / stride))
    outputs = np.moveaxis(scores_twin(planes.astype(float), network), 0, -1)
    scores, ways = outputs[..., :CLASSES], outputs[..., CLASSES:]
    inside = abs(ways) < FARTHEST_MIDDLE - 1e-3
    np.testing.assert_allclose(parts.to_middle[inside], ways[inside], rtol=0, atol=1e-3)
    assert np.isfinite(parts.to_middle).all()
    assert (abs(parts.to_middle) <= FARTHEST_MIDDLE).all()
    raised = np.exp(scores - scores.max(axis=-1, keepdims=True))
    expected = 1 - raised[..., NOT_A_PERSON] / raised.sum(axis=-1)
    np.testing.assert_allclose(parts.person[known], expected[known], rtol=0, atol=1e-3)


@pytest.mark.parametrize('value', [0.0, np.nan, np.inf, np.finfo(np.float32).max])
def test_an_image_without_depth_has_no_probabilities(value: float) -> None:
    grid = depth_grid(np.full((40, 50), value, np.float32), CAMERA)
    assert not grid.depth.any()
    assert not classify(grid, random_network(), 2, 6.0).person.any()
