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

"""What the tests share: the data beside the checkout, and small recordings."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import chromium

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.joints import numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.model_io.model_file import save_model
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.resources.package_files import resource
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames
from lsc_pose_ros.training.train import TrainingSettings, train
from lsc_pose_ros.training.tree_growth import GrowthSettings

HEIGHT, WIDTH = 48, 64
CAMERA = Intrinsics(60.0, 61.0, 31.5, 23.5)
FRAME_TIME = 33_333_333
START = 1_700_000_000_000_000_000


@pytest.fixture(scope='session')
def shared() -> Path:
    """The folder of shared data; tests that need it skip where it is not."""
    default = Path(__file__).resolve().parents[2] / 'shared' / 'data'
    folder = Path(os.environ.get('LSC_POSE_SHARED', default))
    if not folder.is_dir():
        pytest.skip(f'no shared data in {folder}; name the folder in LSC_POSE_SHARED')
    return folder


@pytest.fixture(scope='module')
def browser() -> Iterator[Any]:
    """A browser without a window, for the tests of one file: its event loop disturbs others."""
    yield from chromium()


def simple_frame(number: int) -> Frame:
    """Two boxes, bodies 1 and 2, that move with `number` before a far wall; three joints each."""
    depth = np.full((HEIGHT, WIDTH), 4.0, np.float32)
    labels = np.full((HEIGHT, WIDTH), NO_BODY, np.int32)
    for body, left in ((1, 8), (2, 36)):
        columns = slice(left + number % 8, left + number % 8 + 14)
        depth[10:40, columns] = 2.0 + 0.25 * body + 0.001 * (number % 50)
        labels[10:40, columns] = body
    depth[:2] = 0  # what the sensor did not see
    positions = np.zeros((2, 3, 3), np.float32)
    positions[..., 0] = np.array([[-0.5], [0.5]]) + 0.01 * (number % 8)
    positions[..., 1] = np.array([-0.6, -0.4, 0.2])
    positions[..., 2] = np.array([[2.35], [2.6]])
    positions[1, 2] = np.nan
    ground_truth = Skeletons(
        np.array([1, 2], np.uint16),
        np.array([0, 1, 3], np.uint16),
        positions,
        np.isfinite(positions[..., 0]).astype(np.float32),
    )
    return Frame(
        START + number * FRAME_TIME, 'camera_depth_optical', depth, labels, CAMERA, ground_truth
    )


@pytest.fixture(scope='session')
def simple_frames() -> list[Frame]:
    """Ten frames of two boxes each, labelled."""
    return [simple_frame(number) for number in range(10)]


@pytest.fixture(scope='session')
def labelled_recording(
    tmp_path_factory: pytest.TempPathFactory, simple_frames: list[Frame]
) -> Path:
    """A recording, one .mcap, of `simple_frames`; not to be changed."""
    path = tmp_path_factory.mktemp('recording') / 'labelled.mcap'
    with RecordingWriter(path) as writer:
        for frame in simple_frames:
            writer.write_frame(frame)
    return path


@pytest.fixture(scope='session')
def easy() -> SyntheticSettings:
    """Small frames of people who face the camera, of which a few hundred teach enough."""
    return SyntheticSettings(
        width=160,
        height=120,
        yaw=20.0,
        distance=(2.8, 3.4),
        camera_height=(0.7, 1.3),
        camera_tilt=(-8.0, 8.0),
    )


@pytest.fixture(scope='session')
def people(easy: SyntheticSettings) -> list[Frame]:
    """Synthetic people to learn from: eight bodies in 240 small frames."""
    return list(synthetic_frames(easy._replace(frames=240, seed=5, clip_length=30)))


@pytest.fixture(scope='session')
def training() -> TrainingSettings:
    """Small settings that train within seconds and still find the easy joints."""
    names = ['head', 'neck', 'l_shoulder', 'l_elbow', 'r_shoulder', 'l_hip', 'l_knee', 'r_hip']
    return TrainingSettings(
        numbers_of(names), Settings(points=150), trees=2, growth=GrowthSettings(depth=12)
    )


@pytest.fixture(scope='session')
def small_model(people: list[Frame], training: TrainingSettings) -> Model:
    """A model trained on `people`."""
    return train(people, training, {'recordings': 'synthetic'})


@pytest.fixture(scope='session')
def small_model_file(small_model: Model, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of `small_model`; not to be changed."""
    path = tmp_path_factory.mktemp('model') / 'small.npz'
    save_model(path, small_model)
    return path


@pytest.fixture(scope='session')
def all_round(easy: SyntheticSettings) -> SyntheticSettings:
    """Small frames of people from all sides."""
    return easy._replace(yaw=180.0, noise='none', distance=(2.2, 3.0))


@pytest.fixture(scope='session')
def all_round_people(all_round: SyntheticSettings) -> list[Frame]:
    """People from all sides to learn from: two hundred in 400 small frames."""
    return list(synthetic_frames(all_round._replace(frames=400, seed=5, clip_length=2)))


@pytest.fixture(scope='session')
def body_yaw_model(all_round_people: list[Frame], training: TrainingSettings) -> Model:
    """A model trained on `all_round_people` that estimates the body yaw."""
    told = training._replace(trees=3, settings=training.settings._replace(body_yaws=8))
    return train(all_round_people, told, {'recordings': 'all round'})


@pytest.fixture(scope='session')
def body_yaw_model_file(body_yaw_model: Model, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of `body_yaw_model`; not to be changed."""
    path = tmp_path_factory.mktemp('model') / 'body_yaw.npz'
    save_model(path, body_yaw_model)
    return path


@pytest.fixture
def shipped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the models that come with the package, empty at first."""
    folder = tmp_path / 'resources'
    (folder / 'models').mkdir(parents=True)
    for name in ('bodies', 'config'):
        (folder / name).symlink_to(resource(name))
    monkeypatch.setattr('lsc_pose_ros.resources.package_files._folder', lambda: folder)
    return folder / 'models'
