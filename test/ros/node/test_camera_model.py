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

"""The live node with cameras that have lenses, and with rectified images."""

import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bent_frame import LENSES, bend
from live_ros import Camera, Program, PublishedEstimates, ask, generate

from lsc_pose_ros.data_types.camera import Lens
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator


@pytest.fixture(scope='module')
def frames(tmp_path_factory: pytest.TempPathFactory) -> list[Frame]:
    return generate(tmp_path_factory.mktemp('frames'), frames=3)


def assert_as_offline(found: list[Skeletons], frames: list[Frame], model_file: Path) -> None:
    estimator = Estimator(load_model(model_file))
    for answer, frame in zip(found, frames, strict=True):
        expected = estimator.estimate(frame.depth, frame.labels, frame.camera)
        assert np.isfinite(expected.positions).any()
        for name in Skeletons._fields:
            np.testing.assert_array_equal(getattr(answer, name), getattr(expected, name), name)


@pytest.mark.parametrize('lens', LENSES, ids=lambda lens: lens.model)
def test_lens_is_undistorted_as_offline(
    start_node: Callable[..., Program],
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
    small_model_file: Path,
    lens: Lens,
) -> None:
    node = start_node()
    bent = [bend(frame, lens) for frame in frames]
    found = ask(camera, estimates, node, bent)
    assert_as_offline(found, bent, small_model_file)
    line = f'/depth/camera_info: raw images (D is not zero): K, the distortion {lens.model}'
    assert node.output.count(line) == 1


def test_rectified_images_use_p(
    start_node: Callable[..., Program],
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
    small_model_file: Path,
) -> None:
    node = start_node(rectified='true')
    publish = camera.camera_info.publish

    def publish_other_k(data: bytes) -> None:
        publish(with_other_k(data))

    camera.camera_info.publish = publish_other_k
    found = ask(camera, estimates, node, frames)
    assert_as_offline(found, frames, small_model_file)
    assert 'rectified images (rectified is true): P, no distortion' in node.output
    assert node.exit_status(signal.SIGINT) == 0


def with_other_k(data: bytes) -> Any:
    """Return a serialized camera info with the K of another camera, and a distortion."""
    from rclpy.serialization import deserialize_message, serialize_message  # noqa: PLC0415
    from sensor_msgs.msg import CameraInfo  # noqa: PLC0415

    info = deserialize_message(data, CameraInfo)
    info.k = 1.08 * info.k
    info.d = [0.1, -0.2, 0.0, 0.0, 0.0]
    return serialize_message(info)


def test_unknown_distortion_is_a_warning(
    start_node: Callable[..., Program],
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
    small_model_file: Path,
) -> None:
    node = start_node()
    lens = Lens('unheard_of', (0.1, 0.2))
    bent = [each._replace(camera=each.camera._replace(lens=lens)) for each in frames]
    found = ask(camera, estimates, node, bent)
    assert_as_offline(found, frames, small_model_file)
    assert node.output.count("the distortion model 'unheard_of'") == 1
