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

"""Recordings of cameras with lenses, and of rectified images, against those without."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bent_frame import LENSES, bend
from numpy.typing import NDArray

from lsc_pose_ros.bags import RecordingWriter, open_recording, read_messages
from lsc_pose_ros.bags.serialization.serialize import serialize
from lsc_pose_ros.bags.serialization.type_store import typestore
from lsc_pose_ros.bags.topics import DEFAULT_TOPICS
from lsc_pose_ros.data_types.camera import PLUMB_BOB, Lens
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.messages.type_names import CAMERA_INFO
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.resources.package_files import find_model
from lsc_pose_ros.settings.table import FrameSettings
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

# A pixel at 3 m, metres. Sampling a bent image moves each edge by up to half of it, and the noise
# of the edge with it.
PIXEL = 3.0 / 285.0


@pytest.fixture(scope='module')
def estimator() -> Estimator:
    return Estimator(load_model(find_model('default')))


@pytest.fixture(scope='module')
def frames() -> list[Frame]:
    """Six people who stand at the side of the image, where lenses bend most."""
    settings = SyntheticSettings(frames=6, distance=(2.6, 3.2), seed=4)
    return list(synthetic_frames(settings))


def record(path: Path, frames: Iterable[Frame]) -> Path:
    with RecordingWriter(path) as writer:
        for frame in frames:
            writer.write_frame(frame)
    return path


def joints_in(estimator: Estimator, frames: Iterable[Frame]) -> NDArray[np.float32]:
    return np.concatenate(
        [estimator.estimate(each.depth, each.labels, each.camera).positions for each in frames]
    )


def median_distance(joints: NDArray[np.float32], expected: NDArray[np.float32]) -> float:
    return float(np.nanmedian(np.linalg.norm(joints - expected, axis=-1)))


@pytest.mark.parametrize('lens', LENSES, ids=lambda lens: lens.model)
def test_joints_do_not_depend_on_the_lens(
    tmp_path: Path, estimator: Estimator, frames: list[Frame], lens: Lens
) -> None:
    expected = joints_in(estimator, frames)
    recorded = list(
        open_recording(record(tmp_path / 'bent.mcap', (bend(each, lens) for each in frames)))
    )
    assert all(each.camera.lens == lens for each in recorded)
    found = median_distance(joints_in(estimator, recorded), expected)
    assert found < 2 * PIXEL
    blind = [each._replace(camera=each.camera._replace(lens=None)) for each in recorded]
    assert median_distance(joints_in(estimator, blind), expected) > 2 * found


def with_other_k(source: Path, path: Path, depth_topic: str) -> Path:
    """Copy a recording; K becomes that of another camera, P stays, D becomes that of a lens."""
    with RecordingWriter(path) as writer:
        for message in read_messages(source):
            topic, data = message.topic, message.data
            if topic == DEFAULT_TOPICS.camera_info:
                info: Any = typestore().deserialize_cdr(data, CAMERA_INFO)
                info.k = 1.08 * info.k + (0, 0, 9, 0, 0, -7, 0, 0, 0)
                info.d = np.array([0.1, -0.2, 0, 0, 0])
                data = serialize(info, CAMERA_INFO)
            if topic == DEFAULT_TOPICS.depth:
                topic = depth_topic
            writer.write(topic, message.type_name, message.log_time, data)
    return path


def test_rectified_images_use_p(tmp_path: Path, frames: list[Frame]) -> None:
    original = record(tmp_path / 'original.mcap', frames)
    rectified = with_other_k(original, tmp_path / 'rectified.mcap', '/depth/image_rect')
    reader = open_recording(rectified)
    for found, expected in zip(reader, frames, strict=True):
        assert found.camera == expected.camera
    assert 'rectified images (the topic is named /depth/image_rect): P' in reader.camera

    raw = with_other_k(original, tmp_path / 'raw.mcap', '/depth/image_raw')
    reader = open_recording(raw)
    for found, expected in zip(reader, frames, strict=True):
        assert found.camera.lens == Lens(PLUMB_BOB, (0.1, -0.2, 0, 0, 0))
        assert found.camera.fx == pytest.approx(1.08 * expected.camera.fx)
    assert 'raw images' in reader.camera
    for found, expected in zip(
        open_recording(raw, settings=FrameSettings(rectified='true')), frames, strict=True
    ):
        assert found.camera == expected.camera


def test_unknown_distortion_is_a_warning(tmp_path: Path, frames: list[Frame]) -> None:
    lens = Lens('unheard_of', (0.1, 0.2))
    bent = (each._replace(camera=each.camera._replace(lens=lens)) for each in frames)
    reader = open_recording(record(tmp_path / 'bent.mcap', bent))
    assert all(each.camera.lens is None for each in reader)
    (warning,) = reader.warnings
    assert warning.startswith("/depth/camera_info: the distortion model 'unheard_of'")
