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

"""Publishes the skeletons, markers that draw them, TF frames, and the topics of ROS4HRI."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from rclpy.node import Node
from sensor_msgs.msg import PointCloud2
from visualization_msgs.msg import MarkerArray

from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.messages.build.markers import build_markers
from lsc_pose_ros.messages.build.skeletons import build_skeletons
from lsc_pose_ros.messages.human_bodies import BodyImage, body_id
from lsc_pose_ros.messages.markers import MarkerUpdater
from lsc_pose_ros.ros.io.humans import HumansPublisher
from lsc_pose_ros.ros.io.message_types import RCLPY_CLASSES
from lsc_pose_ros.ros.io.transforms import TransformPublisher
from lsc_pose_ros.settings.table import NodeSettings

if TYPE_CHECKING:
    from rclpy.publisher import Publisher

# Reliable, which suits reliable and best-effort subscribers; the messages are small.
_QUEUE_DEPTH = 10


class Outputs:
    """The publishers between `open` and `close`; one thread at a time may call `publish`.

    Attributes:
        parameters: the node's; any thread may replace them at any time.
    """

    def __init__(self, node: Node, parameters: NodeSettings, edges: NDArray[np.int32]) -> None:
        """Prepare the publishers; `open` creates them.

        Args:
            node: the node that publishes.
            parameters: the node's.
            edges: the bones to draw, pairs of indices into the model's joints, shape (E, 2).

        Raises:
            InputError: publish_tf is true, but tf2_msgs is not installed; or the same of
                publish_ros4hri and hri_msgs.
        """
        self.parameters = parameters
        self._node = node
        self._edges = edges
        ros4hri = parameters.publish_ros4hri
        identify = body_id if ros4hri else str
        self._transforms = TransformPublisher(node, identify) if parameters.publish_tf else None
        self._humans = HumansPublisher(node) if ros4hri else None
        self._marker_updater = MarkerUpdater(edges)
        self._skeletons: Publisher | None = None
        self._markers: Publisher | None = None

    def open(self) -> None:
        """Create the publishers."""
        self._marker_updater = MarkerUpdater(self._edges)
        self._skeletons = self._node.create_publisher(PointCloud2, '~/skeletons', _QUEUE_DEPTH)
        self._markers = self._node.create_publisher(MarkerArray, '~/joint_markers', _QUEUE_DEPTH)
        if self._transforms is not None:
            self._transforms.open()
        if self._humans is not None:
            self._humans.open()

    def close(self) -> None:
        """Destroy the publishers; `publish` must not be running."""
        for publisher in (self._skeletons, self._markers):
            if publisher is not None:
                self._node.destroy_publisher(publisher)
        self._skeletons = self._markers = None
        if self._transforms is not None:
            self._transforms.close()
        if self._humans is not None:
            self._humans.close()

    def warm_up(self, skeletons: Skeletons) -> None:
        """Build all messages without publishing them, because the first ones take much longer."""
        build_skeletons(RCLPY_CLASSES, 0, '', skeletons)
        shapes = MarkerUpdater(self._edges).update(skeletons, self.parameters)
        build_markers(RCLPY_CLASSES, 0, '', shapes)
        if self._transforms is not None:
            self._transforms.warm_up(skeletons)
        if self._humans is not None:
            self._humans.warm_up(skeletons)

    def publish(self, stamp: int, frame_id: str, skeletons: Skeletons, image: BodyImage) -> None:
        """Publish the estimate of one depth image; do nothing before `open` and after `close`.

        Args:
            stamp: the depth image's, nanoseconds.
            frame_id: the depth image's.
            skeletons: the estimate.
            image: the image in which the bodies were found.
        """
        if self._skeletons is None or self._markers is None:
            return
        self._skeletons.publish(build_skeletons(RCLPY_CLASSES, stamp, frame_id, skeletons))
        self._publish_markers(self._markers, stamp, frame_id, skeletons)
        minimum_confidence = self.parameters.minimum_confidence
        if self._transforms is not None:
            self._transforms.publish(stamp, frame_id, skeletons, minimum_confidence)
        if self._humans is not None:
            self._humans.publish(stamp, frame_id, skeletons, image, minimum_confidence)

    def _publish_markers(
        self, publisher: 'Publisher', stamp: int, frame_id: str, skeletons: Skeletons
    ) -> None:
        """Publish markers if there is a subscriber: they cost more than all other messages."""
        if not publisher.get_subscription_count():
            self._marker_updater = MarkerUpdater(self._edges)  # nothing is drawn anywhere
            return
        shapes = self._marker_updater.update(skeletons, self.parameters)
        publisher.publish(build_markers(RCLPY_CLASSES, stamp, frame_id, shapes))
