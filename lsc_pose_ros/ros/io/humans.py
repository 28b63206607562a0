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

"""Publishes the bodies as ROS4HRI (REP-155) has them, below /humans/bodies.

The package hri_msgs is needed only for this, so it is imported only if publish_ros4hri is set.
"""

from typing import TYPE_CHECKING, Any, NamedTuple

from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node

from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.build.humans import (
    build_ids,
    build_joint_state,
    build_region,
    build_skeleton2d,
)
from lsc_pose_ros.messages.human_bodies import BodyImage, body_id, body_region, keypoints
from lsc_pose_ros.messages.human_joint_angles import joint_angles
from lsc_pose_ros.messages.transforms import confident_positions
from lsc_pose_ros.messages.type_names import (
    IDS_LIST,
    JOINT_STATE,
    NORMALIZED_REGION,
    SKELETON_2D,
)
from lsc_pose_ros.ros.io.message_types import RCLPY_CLASSES, message_class
from lsc_pose_ros.tracking.tracker import MEMORY_NS

if TYPE_CHECKING:
    from rclpy.publisher import Publisher

NAMESPACE = '/humans/bodies'

_QUEUE_DEPTH = 1
"""That of hri_fullbody."""

_LAST_LIST = Duration(seconds=0.5)
"""The longest wait for the subscribers to take the last list."""

# Without event handlers a publisher can be created and destroyed in the worker's thread.
_NO_EVENTS = PublisherEventCallbacks(use_default_callbacks=False)


class _BodyPublishers(NamedTuple):
    """The publishers of one body."""

    roi: 'Publisher'
    skeleton2d: 'Publisher'
    joint_states: 'Publisher'


class HumansPublisher:
    """Publishes on /humans/bodies between `open` and `close`.

    The publishers of a body that has left are destroyed when its number is forgotten.
    """

    def __init__(self, node: Node) -> None:
        """Look for the message classes; `open` creates the publisher of the ids.

        Args:
            node: the node that publishes.

        Raises:
            InputError: hri_msgs is not installed.
        """
        self._node = node
        self._ids: Publisher | None = None
        self._bodies: dict[int, _BodyPublishers] = {}
        self._last_seen: dict[int, int] = {}
        if message_class(IDS_LIST) is None:
            msg = (
                'parameter publish_ros4hri: the package hri_msgs is not installed; '
                'install ros-jazzy-hri-msgs, or leave publish_ros4hri false'
            )
            raise InputError(msg)

    def open(self) -> None:
        """Create the publisher of the ids."""
        self._ids = self._create(IDS_LIST, 'tracked')

    def close(self) -> None:
        """Say that there are no bodies any more, and destroy the publishers."""
        if self._ids is not None:
            if self._last_seen and self._node.context.ok():
                now = self._node.get_clock().now().nanoseconds
                self._ids.publish(build_ids(RCLPY_CLASSES, now, '', []))
                self._ids.wait_for_all_acked(_LAST_LIST)
            self._node.destroy_publisher(self._ids)
        self._ids = None
        for number in list(self._bodies):
            self._destroy(number)

    def warm_up(self, skeletons: Skeletons) -> None:
        """Build messages without publishing them, because the first ones take much longer."""
        build_ids(RCLPY_CLASSES, 0, '', [])
        for positions in skeletons.positions:
            angles = joint_angles(skeletons.joints, positions) or {}
            build_joint_state(RCLPY_CLASSES, 0, '', angles)

    def publish(
        self,
        stamp: int,
        frame_id: str,
        skeletons: Skeletons,
        image: BodyImage,
        minimum_confidence: float,
    ) -> None:
        """Publish the bodies of one frame.

        Args:
            stamp: the depth image's, nanoseconds.
            frame_id: the depth image's.
            skeletons: the bodies.
            image: where they were found.
            minimum_confidence: joints with less confidence do not count for the angles.
        """
        if self._ids is None:
            return
        numbers = skeletons.bodies.tolist()
        for number in numbers:
            self._last_seen[number] = stamp
            if number not in self._bodies:
                self._bodies[number] = self._create_for_body(number)
        for number, last in list(self._last_seen.items()):
            if abs(stamp - last) > MEMORY_NS:  # also after a jump back in time
                self._destroy(number)
        ids = [body_id(number) for number in numbers]
        self._ids.publish(build_ids(RCLPY_CLASSES, stamp, frame_id, ids))
        head = (RCLPY_CLASSES, stamp, frame_id)
        self._publish_regions(head, skeletons, image)
        self._publish_keypoints(head, skeletons, image)
        self._publish_angles(head, skeletons, minimum_confidence)

    def _publish_regions(
        self, head: tuple[Any, int, str], skeletons: Skeletons, image: BodyImage
    ) -> None:
        for number, confidence in zip(
            skeletons.bodies.tolist(), skeletons.confidence, strict=True
        ):
            publisher = self._bodies[number].roi
            if publisher.get_subscription_count():
                region = body_region(image, number)
                if region is not None:
                    publisher.publish(build_region(*head, region, float(confidence.mean())))

    def _publish_keypoints(
        self, head: tuple[Any, int, str], skeletons: Skeletons, image: BodyImage
    ) -> None:
        numbers = skeletons.bodies.tolist()
        publishers = [self._bodies[number].skeleton2d for number in numbers]
        if not any(publisher.get_subscription_count() for publisher in publishers):
            return
        for publisher, points in zip(publishers, keypoints(skeletons, image), strict=True):
            publisher.publish(build_skeleton2d(*head, points))

    def _publish_angles(
        self, head: tuple[Any, int, str], skeletons: Skeletons, minimum_confidence: float
    ) -> None:
        positions = confident_positions(skeletons, minimum_confidence)
        for number, body in zip(skeletons.bodies.tolist(), positions, strict=True):
            publisher = self._bodies[number].joint_states
            if not publisher.get_subscription_count():
                continue
            angles = joint_angles(skeletons.joints, body)
            if angles is not None:
                named = {f'{name}_{body_id(number)}': angle for name, angle in angles.items()}
                publisher.publish(build_joint_state(*head, named))

    def _create_for_body(self, number: int) -> _BodyPublishers:
        return _BodyPublishers(
            self._create(NORMALIZED_REGION, f'{body_id(number)}/roi'),
            self._create(SKELETON_2D, f'{body_id(number)}/skeleton2d'),
            self._create(JOINT_STATE, f'{body_id(number)}/joint_states'),
        )

    def _create(self, type_name: str, topic: str) -> 'Publisher':
        return self._node.create_publisher(
            message_class(type_name),
            f'{NAMESPACE}/{topic}',
            _QUEUE_DEPTH,
            event_callbacks=_NO_EVENTS,
        )

    def _destroy(self, number: int) -> None:
        self._last_seen.pop(number, None)
        for publisher in self._bodies.pop(number, ()):
            self._node.destroy_publisher(publisher)
