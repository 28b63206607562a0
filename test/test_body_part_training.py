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


"""The program that trains the network of body parts: what it learns from, and what it writes."""

import sys
from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros.body_parts.classes import CLASSES
from lsc_pose_ros.body_parts.depth_grid import depth_grid
from lsc_pose_ros.body_parts.part_network import INPUTS, OUTPUTS, score_cells
from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.model_io.part_network_file import check_part_network, load_part_network
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_scenes

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'models'))

import body_part_examples as examples
import body_part_scenes as scenes
from people import MocapSplit


def some_grids(frames: int = 2) -> scenes.PartGrids:
    settings = SyntheticSettings(frames=frames, people=2, furniture=True, clip_length=1, seed=3)
    return scenes.grids_of(synthetic_scenes(settings))


def test_grids_keep_depth_parts_and_bodies() -> None:
    grids = some_grids()
    settings = SyntheticSettings(frames=2, people=2, furniture=True, clip_length=1, seed=3)
    for index, scene in enumerate(synthetic_scenes(settings)):
        grid = depth_grid(scene.frame.depth, scene.frame.camera)
        np.testing.assert_allclose(grids.depth[index] / 1000, grid.depth, atol=0.0006)
        middle = grid.step // 2
        np.testing.assert_array_equal(
            grids.parts[index], scene.parts[middle :: grid.step, middle :: grid.step]
        )
        assert ((grids.parts[index] > 0) == (grids.bodies[index] > 0)).all()
        np.testing.assert_allclose(grids.focal_lengths[index], grid.focal_lengths)


def test_the_rooms_are_of_all_cameras_and_without_people_too() -> None:
    settings = [scenes.any_room(number).settings for number in range(200)]
    assert {each.people for each in settings} == {0, 1, 2, 3}
    assert {each.sensor for each in settings} == set(scenes._SENSORS)
    assert len({each.seed for each in settings}) == len(settings)
    assert 0 < sum(not each.furniture for each in settings) < 40


def test_the_grids_of_a_recording_are_drawn_once(tmp_path: Path) -> None:
    spec = scenes.any_room(2)
    spec = spec._replace(settings=spec.settings._replace(frames=1))
    path = scenes.draw_grids(spec, MocapSplit(), tmp_path)
    written = path.stat().st_mtime_ns
    assert scenes.draw_grids(spec, MocapSplit(), tmp_path) == path
    assert path.stat().st_mtime_ns == written
    grids = scenes.load_grids(path)
    assert grids.depth.shape == grids.parts.shape == grids.bodies.shape
    assert grids.depth.dtype == np.uint16


def test_the_mirror_changes_sides() -> None:
    assert examples.OTHER_SIDES[0] == 0
    np.testing.assert_array_equal(
        examples.OTHER_SIDES[examples.OTHER_SIDES], np.arange(CLASSES, dtype=np.uint8)
    )
    for name in JOINT_NAMES:
        other = {'l_': 'r_', 'r_': 'l_'}.get(name[:2], name[:2]) + name[2:]
        assert examples.OTHER_SIDES[1 + JOINT_NUMBERS[name]] == 1 + JOINT_NUMBERS[other]


def test_examples_have_one_size_and_no_weight_without_depth() -> None:
    grids, random = some_grids(6), np.random.default_rng(0)
    seen = set()
    for _ in range(40):
        example = examples.draw_example(grids, int(random.integers(6)), random)
        shape = examples.HEIGHT, examples.WIDTH
        assert example.planes.shape == (INPUTS, *shape)
        assert example.parts.shape == example.weight.shape == shape
        assert np.isfinite(example.planes).all()
        known = example.planes[1] > 0
        assert not example.weight[~known].any()
        assert example.to_middle.shape == (3, *shape)
        assert (example.weight >= 0).all()
        seen |= set(np.unique(example.parts).tolist())
    assert len(seen) > CLASSES // 2


def test_all_cells_of_a_person_point_to_one_middle() -> None:
    rng = np.random.default_rng(0)
    depth = rng.uniform(1, 3, (30, 40)).astype(np.float32)
    bodies = rng.integers(0, 3, (30, 40)).astype(np.uint8)
    depth[0, :5], bodies[29] = 0, 0
    ways = examples.ways_to_middles(depth, bodies, 70.0)
    assert not ways[:, (bodies == 0) | (depth == 0)].any()
    rows, columns = np.mgrid[:30, :40]
    for body in (1, 2):
        mine = (bodies == body) & (depth > 0)
        z = depth[mine].astype(float)
        reached = [
            columns[mine] + ways[0][mine] * 70 / z,
            rows[mine] + ways[1][mine] * 70 / z,
            z + ways[2][mine],
        ]
        expected = [columns[mine].mean(), rows[mine].mean(), z.mean()]
        for values, value in zip(reached, expected, strict=True):
            np.testing.assert_allclose(values, value, atol=1e-3)


def test_small_people_count_more_for_each_cell() -> None:
    depth, bodies = np.full((40, 40), 2, np.float32), np.zeros((40, 40), np.uint8)
    bodies[:20, :20], bodies[30:35, 30:35] = 1, 2
    depth[0, 0], depth[39, 39] = 0, 9
    weights = examples._weights(depth, bodies)
    assert weights[0, 0] == weights[39, 39] == 0
    assert weights[20, 20] == np.float32(0.6)
    np.testing.assert_allclose(weights[1, 1], np.sqrt(200 / 399), rtol=1e-6)
    np.testing.assert_allclose(weights[31, 31], np.sqrt(200 / 25), rtol=1e-6)


def test_a_short_training_writes_a_usable_network(tmp_path: Path) -> None:
    torch = pytest.importorskip('torch', reason='PyTorch is not installed')
    import make_body_parts  # noqa: PLC0415
    from part_network_training import TorchNetwork, exported  # noqa: PLC0415

    output = tmp_path / 'out' / 'parts.npz'
    words = ['--directory', str(tmp_path / 'work'), '--output', str(output)]
    make_body_parts.ROOMS = range(1000, 1002)
    assert make_body_parts.main([*words, '--scale', '0.0001', '--processes', '1']) == 0
    network, provenance = load_part_network(output)
    assert provenance['frames'] == '2'
    check_part_network(network)
    # The kernels compute what PyTorch does.
    torch.manual_seed(0)
    trained = TorchNetwork()
    planes = torch.randn(4, INPUTS, 21, 30)
    trained(planes)  # the normalisation sees other numbers than 0 and 1
    trained.eval()
    expected = trained(planes[:1])[0].detach().numpy()
    found = score_cells(planes[0].numpy(), exported(trained))
    found = found.reshape(OUTPUTS, 23, 32)[:, 1:-1, 1:-1]
    np.testing.assert_allclose(found, expected, atol=1e-4 * np.abs(expected).max(), rtol=1e-3)
