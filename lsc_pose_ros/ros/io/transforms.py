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

"""Publishes the joints as TF frames.

The package tf2_msgs is needed only for this, so it is imported only if publish_tf is set.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING

from rclpy.node import Node

from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.build.transforms import build_transforms
from lsc_pose_ros.messages.transforms import skeleton_transforms
from lsc_pose_ros.messages.type_names import TF_MESSAGE
from lsc_pose_ros.ros.io.message_types import RCLPY_CLASSES, message_class

if TYPE_CHECKING:
    from rclpy.publisher import Publisher

TOPIC = '/tf'

# The queue depth of tf2_ros's broadcaster.
_QUEUE_DEPTH = 100


class TransformPublisher:
    """Publishes on /tf between `open` and `close`."""

    def __init__(self, node: Node, identify: Callable[[int], str] = str) -> None:
        """Look for the message class; `open` creates the publisher.

        Args:
            node: the node that publishes.
            identify: returns the id of the body with a number, which ends the names of frames.

        Raises:
            InputError: tf2_msgs is not installed.
        """
        self._node = node
        self._identify = identify
        self._message_class = message_class(TF_MESSAGE)
        self._publisher: Publisher | None = None
        if self._message_class is None:
            msg = (
                'parameter publish_tf: the package tf2_msgs is not installed; '
                'install ros-jazzy-tf2-msgs, or leave publish_tf false'
            )
            raise InputError(msg)

    def open(self) -> None:
        """Create the publisher."""
        self._publisher = self._node.create_publisher(self._message_class, TOPIC, _QUEUE_DEPTH)

    def close(self) -> None:
        """Destroy the publisher."""
        if self._publisher is not None:
            self._node.destroy_publisher(self._publisher)
        self._publisher = None

    def warm_up(self, skeletons: Skeletons) -> None:
        """Build a message without publishing it, because the first one takes much longer."""
        build_transforms(RCLPY_CLASSES, 0, skeleton_transforms(skeletons, ''))

    def publish(
        self, stamp: int, frame_id: str, skeletons: Skeletons, minimum_confidence: float
    ) -> None:
        """Publish the frames of all joints; nothing if there is no body.

        Args:
            stamp: the depth image's, nanoseconds.
            frame_id: the depth image's.
            skeletons: the bodies.
            minimum_confidence: joints with less confidence are left out.
        """
        transforms = skeleton_transforms(skeletons, frame_id, minimum_confidence, self._identify)
        if transforms and self._publisher is not None:
            self._publisher.publish(build_transforms(RCLPY_CLASSES, stamp, transforms))
