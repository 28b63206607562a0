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

"""Recordings of cameras that are mounted on their side or upside down."""

from pathlib import Path

import numpy as np
import pytest
from rolled_frame import ROLLS, mounting, rolled

from lsc_pose_ros.bags import RecordingWriter, open_recording, read_messages
from lsc_pose_ros.bags.estimated_copy import SKELETONS_TOPIC
from lsc_pose_ros.bags.serialization.deserialize import read_skeletons
from lsc_pose_ros.bags.serialization.serialize import serialize
from lsc_pose_ros.bags.serialization.type_store import message_class
from lsc_pose_ros.camera.transform_tree import FrameTransform
from lsc_pose_ros.cli.main import main
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.evaluation.evaluate import evaluate
from lsc_pose_ros.messages.type_names import TF_MESSAGE
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.settings.table import FrameSettings


def tf_message(transforms: list[FrameTransform]) -> bytes:
    time = message_class('builtin_interfaces/msg/Time')(sec=0, nanosec=0)
    header, vector = (
        message_class('std_msgs/msg/Header'),
        message_class('geometry_msgs/msg/Vector3'),
    )
    quaternion = message_class('geometry_msgs/msg/Quaternion')
    transform = message_class('geometry_msgs/msg/Transform')
    stamped = message_class('geometry_msgs/msg/TransformStamped')
    items = [
        stamped(
            header=header(stamp=time, frame_id=each.parent),
            child_frame_id=each.child,
            transform=transform(
                translation=vector(x=0.0, y=0.0, z=0.0),
                rotation=quaternion(**dict(zip('xyzw', map(float, each.rotation), strict=True))),
            ),
        )
        for each in transforms
    ]
    return serialize(message_class(TF_MESSAGE)(transforms=items), TF_MESSAGE)


def record(path: Path, frames: list[Frame], tf: dict[str, list[FrameTransform]]) -> Path:
    """Write frames, and transforms behind them."""
    with RecordingWriter(path) as writer:
        for frame in frames:
            writer.write_frame(frame)
        for topic, transforms in tf.items():
            log_time = frames[0].stamp if topic == '/tf' else frames[-1].stamp + 1
            writer.write(topic, TF_MESSAGE, log_time, tf_message(transforms))
    return path


def skeletons_of(path: Path, tmp_path: Path, model: Path, *words: str) -> list[np.ndarray]:
    """Return the joints that `lsc_pose replay` writes."""
    output = tmp_path / f'out_{path.name}'
    assert (
        main(
            [
                'replay',
                str(path),
                '-o',
                str(output),
                '--model',
                str(model),
                '--no-temporal',
                *words,
            ]
        )
        == 0
    )
    return [
        read_skeletons(message.data).skeletons.positions
        for message in read_messages(output)
        if message.topic == SKELETONS_TOPIC
    ]


def turned_back(joints: np.ndarray, roll: int) -> np.ndarray:
    """Return upright joints as a camera sees them that is turned clockwise."""
    x, y, z = np.moveaxis(joints, -1, 0)
    return np.stack({0: (x, y, z), 90: (y, -x, z), 180: (-x, -y, z), 270: (-y, x, z)}[roll], -1)


@pytest.mark.parametrize('roll', ROLLS)
@pytest.mark.parametrize('how', ['setting', 'static', 'dynamic'])
def test_joints_are_those_of_the_upright_camera_in_the_frame_of_the_turned_one(
    tmp_path: Path, people: list[Frame], small_model_file: Path, roll: int, how: str
) -> None:
    frames = people[:4]
    expected = skeletons_of(
        record(tmp_path / 'upright.mcap', frames, {}), tmp_path, small_model_file
    )
    mount = mounting(frames[0].frame_id, roll, pitch=15)
    tf = {
        'setting': {},
        'static': {'/tf_static': mount},
        'dynamic': {'/tf': mount[:1], '/tf_static': mount[1:]},
    }[how]
    path = record(tmp_path / 'rolled.mcap', [rolled(each, roll) for each in frames], tf)
    words = ('--camera-roll', str(roll)) if how == 'setting' else ()
    found = skeletons_of(path, tmp_path, small_model_file, *words)
    if how == 'dynamic':  # it may come after the first frame
        found, expected = found[1:], expected[1:]
    for turned, upright in zip(found, expected, strict=True):
        np.testing.assert_array_equal(turned, turned_back(upright, roll))


@pytest.mark.parametrize('roll', ROLLS)
def test_errors_are_those_of_the_upright_camera(
    tmp_path: Path, people: list[Frame], small_model_file: Path, roll: int
) -> None:
    estimator = Estimator(load_model(small_model_file))
    settings = FrameSettings(camera_roll=str(roll))
    path = record(tmp_path / 'rolled.mcap', [rolled(each, roll) for each in people[:6]], {})
    upright = record(tmp_path / 'upright.mcap', people[:6], {})
    found = evaluate(estimator, open_recording(path, settings=settings))
    expected = evaluate(estimator, open_recording(upright))
    np.testing.assert_allclose(found.errors, expected.errors, rtol=1e-5)


def test_roll_is_told(
    tmp_path: Path, people: list[Frame], capsys: pytest.CaptureFixture[str]
) -> None:
    frame = rolled(people[0], 90)
    path = record(tmp_path / 'rolled.mcap', [frame], {'/tf_static': mounting(frame.frame_id, 90)})
    assert main(['info', str(path)]) == 0
    told = f'camera_roll auto: 90, by the transform from {frame.frame_id} to base_link'
    assert told in capsys.readouterr().out
