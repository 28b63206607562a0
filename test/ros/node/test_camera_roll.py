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

"""The live node with cameras that are mounted on their side or upside down."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from geometry_msgs.msg import Pose, PoseArray
from live_ros import Camera, Program, PublishedEstimates, ask, generate
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rolled_frame import mounting, rolled
from waiting import wait_until

from lsc_pose_ros.camera.roll import in_camera_frame
from lsc_pose_ros.camera.transform_tree import FrameTransform
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator

# Stands in for tf2_msgs, which is not on PyPI. A PoseArray carries the rotations, and its frame_id
# the names of the frames.
TF_STAND_IN = """
import json
from types import SimpleNamespace

from geometry_msgs.msg import PoseArray as TFMessage


def transforms(message):
    names = json.loads(message.header.frame_id)
    return [
        SimpleNamespace(
            header=SimpleNamespace(frame_id=parent),
            child_frame_id=child,
            transform=SimpleNamespace(rotation=pose.orientation),
        )
        for (parent, child), pose in zip(names, message.poses, strict=True)
    ]


TFMessage.transforms = property(transforms)
"""


def tf_message(transforms: list[FrameTransform]) -> PoseArray:
    message = PoseArray()
    message.header.frame_id = json.dumps([[each.parent, each.child] for each in transforms])
    for each in transforms:
        pose = Pose()
        for axis, value in zip('xyzw', each.rotation, strict=True):
            setattr(pose.orientation, axis, float(value))
        message.poses.append(pose)
    return message


@pytest.fixture(scope='module')
def frames(tmp_path_factory: pytest.TempPathFactory) -> list[Frame]:
    return generate(tmp_path_factory.mktemp('frames'), frames=2)


@pytest.fixture
def tf_packages(tmp_path: Path) -> Path:
    """A folder with the stand-in for tf2_msgs."""
    package = tmp_path / 'packages' / 'tf2_msgs'
    package.mkdir(parents=True)
    (package / '__init__.py').touch()
    (package / 'msg.py').write_text(TF_STAND_IN)
    return package.parent


def assert_as_upright(
    found: list[Skeletons], frames: list[Frame], roll: int, model_file: Path
) -> None:
    """Check that the joints are those of the upright frames, in the frame of the camera."""
    estimator = Estimator(load_model(model_file))
    for skeletons, frame in zip(found, frames, strict=True):
        expected = estimator.estimate(frame.depth, frame.labels, frame.camera)
        assert np.isfinite(expected.positions).any()
        np.testing.assert_array_equal(
            skeletons.positions, in_camera_frame(expected, roll).positions
        )


@pytest.mark.parametrize('roll', [90, 180, 270])
def test_joints_of_a_turned_camera_are_in_its_own_frame(
    start_node: Callable[..., Program],
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
    small_model_file: Path,
    roll: int,
) -> None:
    node = start_node(camera_roll=roll)  # an integer, as `camera_roll:=90` gives
    found = ask(camera, estimates, node, [rolled(each, roll) for each in frames])
    assert_as_upright(found, frames, roll, small_model_file)
    assert f'camera_roll {roll}' in node.output


@pytest.mark.parametrize('static', [2, 1])
def test_roll_is_found_by_the_transforms(
    start_program: Callable[..., Program],
    ros_environment: dict[str, str],
    camera: Camera,
    estimates: PublishedEstimates,
    probe: Node,
    frames: list[Frame],
    small_model_file: Path,
    tf_packages: Path,
    static: int,
) -> None:
    """The last transforms are static; the first may come on /tf."""
    latched = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publishers = {
        '/tf_static': probe.create_publisher(PoseArray, '/tf_static', latched),
        '/tf': probe.create_publisher(PoseArray, '/tf', 10),
    }
    transforms = mounting(frames[0].frame_id, 270, pitch=20)
    publishers['/tf_static'].publish(tf_message(transforms[2 - static :]))
    node = start_program(
        *('-m', 'lsc_pose_ros.ros.node.main', '--ros-args', '-p', f'model:={small_model_file}'),
        *('-p', 'temporal:=false'),
        PYTHONPATH=f'{tf_packages}:{ros_environment["PYTHONPATH"]}',
    )
    assert node.prints('listening to'), node.output
    tf = publishers['/tf']
    if static < len(transforms):
        assert wait_until(lambda: tf.get_subscription_count() > 0)
        tf.publish(tf_message(transforms[: 2 - static]))
    told = f'camera_roll auto: 270, by the transform from {frames[0].frame_id} to base_link'

    turned = [rolled(each, 270) for each in frames]
    camera.wait_for_node()
    estimates.wait_for_node()
    stamp = turned[-1].stamp
    sent: list[Frame] = []

    def told_after_a_frame() -> bool:
        sent.append(turned[0]._replace(stamp=stamp + len(sent) * 10**8))
        camera.send(sent[-1])
        assert wait_until(lambda: sent[-1].stamp in estimates.skeletons), node.output
        return told in node.output

    assert wait_until(told_after_a_frame), node.output
    last = [each._replace(stamp=sent[-1].stamp + (1 + k) * 10**8) for k, each in enumerate(turned)]
    for each in last:
        camera.send(each)
        assert wait_until(lambda each=each: each.stamp in estimates.skeletons), node.output
    found = estimates.skeletons
    assert_as_upright([found[each.stamp] for each in last], frames, 270, small_model_file)
    if static == len(transforms):
        assert wait_until(lambda: tf.get_subscription_count() == 0)
