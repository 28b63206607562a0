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

"""Subscribes to depth images, masks and camera infos, and synchronizes them."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from lsc_pose_ros.messages.stamps import NANOSECONDS, nanoseconds
from lsc_pose_ros.ros.health.stream_warnings import Counters, Delivery, TopicNames
from lsc_pose_ros.ros.health.throttled_log import ThrottledLog
from lsc_pose_ros.ros.io.frame_messages import FrameMessages, ImageMessage
from lsc_pose_ros.ros.io.subscription import (
    IMAGE_QUEUE_DEPTH,
    SubscriptionRequest,
    TopicSubscription,
)
from lsc_pose_ros.settings.table import AUTO, MASK, NodeSettings
from lsc_pose_ros.synchronization.live_synchronizer import LiveSynchronizer
from lsc_pose_ros.synchronization.synchronizer import SynchronizerSettings

if TYPE_CHECKING:
    from rclpy.timer import Timer

# How often the subscriptions are adapted to the publishers, seconds.
_DISCOVERY_PERIOD = 0.25


class Inputs:
    """The subscriptions of the node.

    If the parameter `reliability` is auto, a topic is subscribed to when it has a publisher, with
    a QoS that is compatible with all its publishers, and again when that QoS changes.

    If the parameter `segmentation` is auto, depth images wait for masks as long as the topic of
    the masks has a publisher.

    Attributes:
        topics: the full names of the topics, after remapping; `mask` is empty if masks are not
            used in any case.
    """

    def __init__(
        self,
        node: Node,
        parameters: NodeSettings,
        log: ThrottledLog,
        deliver: Callable[[FrameMessages], None],
    ) -> None:
        """Create the subscriptions.

        Args:
            node: the node that subscribes.
            parameters: the node's.
            log: where problems with publishers are logged.
            deliver: called with the messages of each frame, in the executor's thread.
        """
        self._node = node
        self._mask_is_optional = parameters.segmentation == AUTO
        self._synchronizer: LiveSynchronizer[ImageMessage, ImageMessage, CameraInfo] = (
            LiveSynchronizer(
                SynchronizerSettings(
                    slop_ns=round(parameters.sync_slop * NANOSECONDS),
                    capacity=parameters.sync_queue,
                    waiting=parameters.sync_queue,
                    with_masks=parameters.segmentation == MASK,
                ),
                lambda frame: deliver(FrameMessages(frame.depth, frame.mask, frame.camera_info)),
            )
        )
        requests = [
            self._image_request('depth/image', 'depth_transport', parameters.depth_transport),
            SubscriptionRequest(
                'depth/camera_info', CameraInfo, self._add_camera_info, latched=True
            ),
        ]
        if parameters.reads_masks:
            requests.append(
                self._image_request('mask', 'mask_transport', parameters.mask_transport)
            )
        self._subscriptions = [
            TopicSubscription(node, request, parameters.reliability, log) for request in requests
        ]
        self.topics = TopicNames(*(each.topic for each in self._subscriptions))
        self._timer: Timer | None = node.create_timer(
            _DISCOVERY_PERIOD,
            self._update_subscriptions,
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )
        self._update_subscriptions()

    def set_sync_slop(self, seconds: float) -> None:
        """Set the largest difference between the stamps of a depth image and its mask."""
        self._synchronizer.slop_ns = round(seconds * NANOSECONDS)

    @property
    def needed_topics(self) -> TopicNames:
        """The topics without which no frame is complete, now."""
        return self.topics if self._synchronizer.with_masks else self.topics._replace(mask='')

    def publishers(self) -> dict[str, int]:
        """Return the number of publishers of each topic."""
        return {
            each.topic: self._node.count_publishers(each.topic) for each in self._subscriptions
        }

    def delivery(self) -> dict[str, Delivery]:
        """Return how the messages of each topic are delivered."""
        return {each.topic: each.delivery for each in self._subscriptions}

    def counters(self, replaced: int) -> Counters:
        """Return the counts since the subscriptions were created.

        Args:
            replaced: how many frames a newer one replaced before they were estimated.
        """
        synchronizer = self._synchronizer
        lost = {each.topic: each.lost for each in self._subscriptions}
        return Counters(
            depth=synchronizer.depth,
            masks=synchronizer.masks,
            camera_infos=synchronizer.camera_infos,
            pairs=synchronizer.pairs,
            replaced=replaced,
            lost=sum(lost.values()) - lost.get(self.topics.camera_info, 0),
            lost_camera_infos=lost.get(self.topics.camera_info, 0),
            rewinds=synchronizer.rewinds,
            missing=synchronizer.missing,
            out_of_order=synchronizer.out_of_order,
            **synchronizer.dropped._asdict(),
        )

    def close(self) -> None:
        """Destroy the subscriptions, and release the messages that wait."""
        if self._timer is not None:
            self._node.destroy_timer(self._timer)
            self._timer = None
        while self._subscriptions:
            self._subscriptions.pop().close()

    def _update_subscriptions(self) -> None:
        for each in self._subscriptions:
            each.update()
        if self._mask_is_optional:
            has_publisher = self._node.count_publishers(self.topics.mask) > 0
            if has_publisher != self._synchronizer.with_masks:
                self._synchronizer.with_masks = has_publisher

    def _image_request(self, topic: str, parameter: str, transport: str) -> SubscriptionRequest:
        add = self._add_depth if parameter == 'depth_transport' else self._add_mask
        message_type: type[ImageMessage] = Image
        if transport != 'raw':
            message_type = CompressedImage
            # The convention of image_transport: the remapped topic, then the transport.
            topic = f'{self._node.resolve_topic_name(topic)}/{transport}'
        return SubscriptionRequest(
            topic,
            message_type,
            add,
            transport_parameter=parameter,
            queue_depth=IMAGE_QUEUE_DEPTH,
        )

    def _add_depth(self, image: ImageMessage) -> None:
        self._synchronizer.add_depth(nanoseconds(image.header.stamp), image)

    def _add_mask(self, image: ImageMessage) -> None:
        self._synchronizer.add_mask(nanoseconds(image.header.stamp), image)

    def _add_camera_info(self, info: CameraInfo) -> None:
        self._synchronizer.add_camera_info(nanoseconds(info.header.stamp), info)
