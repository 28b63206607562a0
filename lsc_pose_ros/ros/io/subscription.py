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

"""A subscription whose QoS follows that of the publishers."""

import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from rclpy.event_handler import SubscriptionEventCallbacks, UnsupportedEventTypeError
from rclpy.node import Node
from rclpy.qos import (
    QoSDurabilityPolicy,
    QoSProfile,
    QoSReliabilityPolicy,
    qos_policy_name_from_kind,
)
from rclpy.subscription import Subscription
from rclpy.topic_endpoint_info import TopicEndpointInfo

from lsc_pose_ros.ros.health.stream_warnings import Delivery
from lsc_pose_ros.ros.health.throttled_log import ThrottledLog

AUTO = 'auto'

# The name of the node that plays a recording.
_BAG_PLAYER = 'rosbag2_player'

# `ros2 bag play` sends at once. If it is given a delay of 3 s, the first message comes later than
# this after its publisher is found, seconds.
_WITHOUT_DELAY = 1.0

_RELIABILITIES = {
    'best_effort': QoSReliabilityPolicy.BEST_EFFORT,
    'reliable': QoSReliabilityPolicy.RELIABLE,
}

# Enough for a burst: the callbacks only pass messages on, so that no message waits long.
_QUEUE_DEPTH = 10

IMAGE_QUEUE_DEPTH = 4
"""For images: ten of 640x480 in each queue took 8 MB more under overload."""


class SubscriptionRequest(NamedTuple):
    """A topic to subscribe to.

    Attributes:
        topic: the name before remapping.
        message_type: the message class.
        add: called with each message.
        latched: True to receive earlier messages too, if the publishers keep them.
        transport_parameter: the parameter that selects the message type, if any.
        queue_depth: the QoS depth.
    """

    topic: str
    message_type: type[Any]
    add: Callable[[Any], None]
    latched: bool = False
    transport_parameter: str = ''
    queue_depth: int = _QUEUE_DEPTH


class TopicSubscription:
    """The subscription of one topic.

    Attributes:
        topic: the full name, after remapping.
        lost: how many messages are lost according to the middleware.
    """

    def __init__(
        self, node: Node, request: SubscriptionRequest, reliability: str, log: ThrottledLog
    ) -> None:
        """Subscribe; if `reliability` is auto, `update` does it.

        Args:
            node: the node that subscribes.
            request: the topic.
            reliability: best_effort, reliable, or auto for the QoS that all publishers offer.
            log: where problems with publishers are logged.
        """
        self.topic = node.resolve_topic_name(request.topic)
        self.lost = 0
        self._node = node
        self._request = request
        self._log = log
        self._automatic = reliability == AUTO
        self._profile: QoSProfile | None = None
        self._subscription: Subscription | None = None
        self._player_found: float | None = None
        self._received = False
        if not self._automatic:
            self._subscribe(
                QoSProfile(depth=request.queue_depth, reliability=_RELIABILITIES[reliability])
            )

    def update(self) -> None:
        """Subscribe, or subscribe again, if the QoS of the publishers asks for it."""
        publishers = self._publishers()
        self._find_player(publishers)
        matching = [each for each in publishers if each.topic_type == self._type_name]
        if len(matching) < len(publishers):
            self._report_wrong_type(publishers)
        if self._automatic and matching:
            profile = _profile_for(matching, self._request)
            if profile != self._profile:
                self._subscribe(profile)

    def close(self) -> None:
        """Destroy the subscription."""
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None

    @property
    def delivery(self) -> Delivery:
        """How the messages are delivered; best effort if there is no publisher."""
        publishers = self._publishers()
        if not publishers or not _all_reliable(publishers):
            return Delivery.BEST_EFFORT
        if self._profile is None or self._profile.reliability != QoSReliabilityPolicy.RELIABLE:
            return Delivery.RELIABLE_UNUSED
        return Delivery.RELIABLE

    def _publishers(self) -> list[TopicEndpointInfo]:
        try:
            return list(self._node.get_publishers_info_by_topic(self.topic))
        except Exception:
            if self._node.context.ok():
                raise
            return []  # the process was told to end meanwhile

    def _receive(self, message: Any) -> None:  # noqa: ANN401
        if not self._received:
            self._received = True
            self._find_player(self._publishers())
            found = self._player_found
            if found is not None and time.monotonic() - found < _WITHOUT_DELAY:
                self._report_player()
        self._request.add(message)

    def _find_player(self, publishers: Sequence[TopicEndpointInfo]) -> None:
        """Note when a player of recordings begins and ends to publish."""
        playing = any(each.node_name == _BAG_PLAYER for each in publishers)
        if playing and self._player_found is None:
            self._player_found = time.monotonic()
        elif self._player_found is not None and not playing:
            if not self._received:
                self._report_player()
            self._player_found = None
            self._received = False

    def _report_player(self) -> None:
        self._log.warning(
            'bag player',
            f'{self.topic}: ros2 bag play sent its first messages before this node was connected, '
            'so they were not received; with --delay 3 it waits',
        )

    @property
    def _type_name(self) -> str:
        message_type = self._request.message_type
        return f'{message_type.__module__.partition(".")[0]}/msg/{message_type.__name__}'

    def _subscribe(self, profile: QoSProfile) -> None:
        self.close()
        self._profile = profile
        events = SubscriptionEventCallbacks(
            incompatible_qos=self._report_incompatible,
            message_lost=self._count_lost,
            use_default_callbacks=False,
        )
        try:
            self._subscription = self._create(profile, events)
        except UnsupportedEventTypeError:  # not every middleware reports lost messages
            events.message_lost = None
            self._subscription = self._create(profile, events)

    def _create(self, profile: QoSProfile, events: SubscriptionEventCallbacks) -> Subscription:
        request = self._request
        return self._node.create_subscription(
            request.message_type, request.topic, self._receive, profile, event_callbacks=events
        )

    def _count_lost(self, event: Any) -> None:  # noqa: ANN401
        self.lost += event.total_count_change

    def _report_incompatible(self, event: Any) -> None:  # noqa: ANN401
        if self._automatic:
            return  # a new publisher: the next `update` adapts the QoS
        policy = qos_policy_name_from_kind(event.last_policy_kind)
        remedy = 'change the publisher'
        if policy == 'RELIABILITY':
            remedy = 'set the parameter reliability to auto or best_effort'
        self._log.error(
            f'incompatible {self.topic}',
            f'{self.topic}: a publisher offers an incompatible {policy}, so its messages are not '
            f'received; {remedy}',
        )

    def _report_wrong_type(self, publishers: Sequence[TopicEndpointInfo]) -> None:
        types = {each.topic_type for each in publishers} - {self._type_name}
        remedy = 'remap the node to another topic'
        if self._request.transport_parameter:
            remedy += f', or set the parameter {self._request.transport_parameter}'
        self._log.error(
            f'type of {self.topic}',
            f'{self.topic}: a publisher sends {", ".join(sorted(types))}, but '
            f'{self._type_name} is needed, so its messages are not received; {remedy}',
        )


def _all_reliable(publishers: Sequence[TopicEndpointInfo]) -> bool:
    return all(
        each.qos_profile.reliability == QoSReliabilityPolicy.RELIABLE for each in publishers
    )


def _profile_for(
    publishers: Sequence[TopicEndpointInfo], request: SubscriptionRequest
) -> QoSProfile:
    """Return the strictest QoS that all `publishers` offer."""
    offered = [each.qos_profile for each in publishers]
    kept = all(each.durability == QoSDurabilityPolicy.TRANSIENT_LOCAL for each in offered)
    return QoSProfile(
        depth=request.queue_depth,
        reliability=_RELIABILITIES['reliable' if _all_reliable(publishers) else 'best_effort'],
        durability=QoSDurabilityPolicy.TRANSIENT_LOCAL
        if request.latched and kept
        else QoSDurabilityPolicy.VOLATILE,
    )
