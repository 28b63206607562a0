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


"""Segmentation auto: masks as long as they have a publisher, otherwise people found alone."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from live_ros import Camera, Program, PublishedEstimates, generate
from rclpy.node import Node
from sensor_msgs.msg import Image
from waiting import wait_until

from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.segmentation.segmenter import make_segmenter, segment
from lsc_pose_ros.settings.table import SegmentationSettings

# The number of the person in the masks; a person who is found alone is body 1.
NUMBER = 7


@pytest.fixture(scope='module')
def frames(tmp_path_factory: pytest.TempPathFactory) -> list[Frame]:
    """Return frames of one person before a wall."""
    found = []
    for frame in generate(tmp_path_factory.mktemp('frames'), frames=6):
        person = frame.labels != NO_BODY
        depth = np.where(person, frame.depth, np.float32(4.5))
        labels = np.where(person, NUMBER, NO_BODY).astype(np.int32)
        found.append(frame._replace(depth=depth, labels=labels))
    return found


def found_alone(frame: Frame) -> Frame:
    segmenter = make_segmenter(SegmentationSettings('people'))
    assert segmenter is not None
    labels = segment(segmenter, frame.stamp, frame.depth, frame.camera)
    return frame._replace(labels=labels)


def assert_answered(found: Skeletons, frame: Frame, model: Path) -> None:
    expected = Estimator(load_model(model)).estimate(frame.depth, frame.labels, frame.camera)
    for name in Skeletons._fields:
        if name == 'joints' and not len(expected.bodies):
            continue  # a message without bodies has no joints
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), name)


def test_masks_are_used_as_long_as_they_have_a_publisher(
    start_node: Callable[..., Program],
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
    small_model_file: Path,
    probe: Node,
) -> None:
    """The masks begin and end while the node runs, and each frame is answered once."""
    probe.destroy_publisher(camera.mask)
    node = start_node(segmentation='auto', minimum_body_confidence=0.0)
    camera.wait_for_node(mask=False)
    estimates.wait_for_node()
    alone = [found_alone(frame) for frame in frames]
    for count, frame in enumerate(frames[:2], 1):
        camera.send_depth(frame)
        assert estimates.wait_for(count), node.output
    assert node.prints('bodies are found by segmentation people, because there is no mask')

    camera.mask = probe.create_publisher(Image, 'mask', 10)
    camera.wait_for_node()
    for count, frame in enumerate(frames[2:4], 3):
        camera.send(frame)
        assert estimates.wait_for(count), node.output
    assert node.prints('bodies are the masks of /mask')

    camera.send_depth(frames[4])  # waits for its mask
    camera.wait_until_taken()
    probe.destroy_publisher(camera.mask)
    assert estimates.wait_for(5), node.output
    assert wait_until(
        lambda: node.output.count('found by segmentation people, because there is no mask') == 2
    )
    camera.send_depth(frames[5])
    assert estimates.wait_for(6), node.output

    used = [*alone[:2], *frames[2:4], *alone[4:]]
    assert list(estimates.skeletons) == [frame.stamp for frame in used]
    for frame in used:
        assert_answered(estimates.skeletons[frame.stamp], frame, small_model_file)
    assert any((frame.labels != NO_BODY).any() for frame in alone)
