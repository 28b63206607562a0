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

"""The program that trains the models of the package, and the figures of their card."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation.evaluate import evaluate, summarise
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'models'))

import card
import make
import people as table

TRUNK = ['torso', 'l_shoulder', 'l_hip', 'r_shoulder', 'r_hip']


def body_yaw(yaw: float, position: tuple[float, float, float] = (0.0, 0.0, 3.0)) -> Skeletons:
    """A trunk that is turned to the person's left by `yaw` degrees from facing the camera."""
    angle = np.radians(yaw)
    # The left side of a person who faces the camera is on the right of the image.
    left = np.array([np.cos(angle), 0, np.sin(angle)])
    positions = np.array([0 * left, 0.2 * left, 0.1 * left, -0.2 * left, -0.1 * left])
    positions[[1, 3], 1] -= 0.3
    positions += position
    return Skeletons(
        np.array([1], np.uint16),
        numbers_of(TRUNK),
        positions[None].astype(np.float32),
        np.ones((1, 5), np.float32),
    )


@pytest.mark.parametrize('yaw', [0, 20, -45, 90, -90, 135, 180])
def test_yaw_is_the_angle_away_from_the_camera(yaw: float) -> None:
    np.testing.assert_allclose(card.yaw_of(body_yaw(yaw)), abs(yaw), atol=0.05)


def test_yaw_is_measured_from_the_line_of_sight() -> None:
    """A person 45 degrees off the axis who faces along the axis has a yaw of 45 degrees."""
    np.testing.assert_allclose(card.yaw_of(body_yaw(0, (2.0, 0.5, 2.0))), 45, atol=0.05)
    np.testing.assert_allclose(card.distance_of(body_yaw(0, (2.0, 0.5, 2.0))), 2)


def test_each_recording_has_its_own_people() -> None:
    recordings = {
        part
        for recipe in table.RECIPES.values()
        for parts in (recipe.training, recipe.calibration, recipe.tests, recipe.others)
        for part in parts
    }
    assert len({part.settings.seed for part in recordings}) == len(recordings)
    assert len({part.name for part in recordings}) == len(recordings)


@pytest.mark.parametrize('recipe', table.RECIPES.values(), ids=table.RECIPES.keys())
def test_no_recording_is_used_for_training_and_tests(recipe: table.Recipe) -> None:
    learnt = {part.name for part in (*recipe.training, *recipe.calibration)}
    assert learnt.isdisjoint(part.name for part in (*recipe.tests, *recipe.others))


def test_fifth_of_the_clips_is_held_out(tmp_path: Path) -> None:
    folder = tmp_path / 'clips'
    (folder / 'more').mkdir(parents=True)
    for number in range(9):
        (folder / f'{number}.bvh').touch()
    (folder / 'more' / 'last.bvh').touch()
    mocap = table.find_mocap(folder, None)
    assert mocap.held_out == ('4', 'more/last')
    settings = SyntheticSettings()
    learnt = table.with_mocap(settings, mocap, test=False)
    assert (learnt.mocap_only, learnt.mocap_without) == ((), mocap.held_out)
    measured = table.with_mocap(settings, mocap, test=True)
    assert (measured.mocap_only, measured.mocap_without) == (mocap.held_out, ())
    for number in range(6):
        (folder / f'{number}.bvh').unlink()
    with pytest.raises(InputError, match='4 BVH files are too few'):
        table.find_mocap(folder, None)


SMALL = SyntheticSettings(width=160, height=120, distance=(2.0, 3.0), clip_length=2)


@pytest.fixture
def tiny(monkeypatch: pytest.MonkeyPatch) -> None:
    """Use a recipe with few small frames."""
    part = table.RecordingSpec('few', SMALL._replace(frames=12, seed=1))
    others = (table.RecordingSpec('others', SMALL._replace(frames=4, seed=2)),)
    views = (
        table.RecordingSpec('one', SMALL._replace(frames=6, seed=3, yaw=180.0)),
        table.RecordingSpec(
            'two', SMALL._replace(frames=3, seed=4, people=2, distance=(2.5, 4.0))
        ),
    )
    words = ('--points', '100', '--trees', '1', '--joints', 'torso', 'head', 'l_hand')
    recipe = table.Recipe((part,), others, views, views[:1], words, 8.0)
    monkeypatch.setitem(table.RECIPES, 'default', recipe)
    monkeypatch.setattr(make, 'COMMON_TRAIN_OPTIONS', ())


def test_model_is_trained_and_evaluated_once(tiny: None, tmp_path: Path) -> None:
    assert tiny is None
    kept, target = tmp_path / 'kept', tmp_path / 'models'
    target.mkdir()
    page = 'Before.\n\n<!-- figures of default -->\nold\n<!-- end -->\n\nAfter.\n'
    (target / 'README.md').write_text(page)
    words = ['default', '--directory', str(kept), '--target', str(target)]
    assert make.main(words) == 0
    assert load_model(target / 'default.npz').joints.tolist() == [0, 2, 7]
    results = json.loads((target / 'default.json').read_text())
    assert results['all']['all views and sensors']['people'] == 12
    assert results['recordings'].keys() == {'one', 'two'}
    assert results['recordings']['two']['people'] == 6
    for part in ('views', 'distances'):
        assert sum(row['people'] for row in results[part].values()) == 12
    assert set(results['joints']) == {'head', 'torso', 'l_hand'}
    written = (target / 'README.md').read_text()
    assert written.startswith('Before.\n\n<!-- figures of default -->\n\n|')
    assert written.endswith('|\n\n<!-- end -->\n\nAfter.\n')
    assert 'old' not in written
    assert '| l_hand |' in written
    before = {path: path.stat().st_mtime_ns for path in kept.iterdir()}
    assert len(before) == 5  # four recordings and the model
    real = next(str(path) for path in before if path.name.startswith('few'))
    assert make.main([*words, '--real', real, '--offsets-from', real]) == 0
    assert {path: path.stat().st_mtime_ns for path in kept.iterdir()} == before
    results = json.loads((target / 'default.json').read_text())
    plain, moved = results['real'].values()
    assert moved['mean_error_m'] <= plain['mean_error_m']
    assert plain['people'] == moved['people'] == 12


def test_settings_determine_the_recording(tmp_path: Path) -> None:
    parts = [table.RecordingSpec('few', SMALL._replace(frames=2, seed=seed)) for seed in (1, 2)]
    paths = table.generate(parts, table.MocapSplit(), tmp_path, test=False)
    assert len(set(paths)) == 2
    assert table.generate(parts, table.MocapSplit(), tmp_path, test=False) == paths


def test_figures_of_a_bin_equal_those_of_its_people_alone(small_model_file: Path) -> None:
    estimator = Estimator(load_model(small_model_file))
    frames = list(synthetic_frames(SMALL._replace(frames=8, seed=5, yaw=180.0)))
    everybody = card.measure(estimator, 'all', frames)
    assert len(everybody.yaw) == 8
    rows = card.binned(everybody, everybody.yaw, (0, 90, 180))
    near = [frame for frame, yaw in zip(frames, everybody.yaw, strict=True) if yaw < 90]
    wanted = summarise(evaluate(estimator, near), card.TOLERANCE)
    assert rows['0 to 90']['people'] == len(near)
    assert rows['0 to 90']['map'] == pytest.approx(wanted.map)
    assert rows['0 to 90']['mean_error_m'] == pytest.approx(wanted.mean_error_m, rel=1e-4)
    joined = card.join(
        [
            card.measure(estimator, name, [frame])
            for name, frame in zip('abcdefgh', frames, strict=True)
        ]
    )
    assert card.score(joined.evaluation) == pytest.approx(card.score(everybody.evaluation))
    assert list(card.by_recording(joined)) == list('abcdefgh')


def test_frames_without_people_are_not_counted(small_model_file: Path) -> None:
    (frame,) = synthetic_frames(SMALL._replace(frames=1, seed=5))
    empty = Frame(
        0,
        'c',
        np.zeros((9, 9), np.float32),
        np.full((9, 9), -1, np.int32),
        Intrinsics(9, 9, 4, 4),
        None,
    )
    measured = card.measure(Estimator(load_model(small_model_file)), 'x', [empty, frame])
    assert len(measured.yaw) == len(measured.evaluation.errors) == 1
