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

from lsc_pose_ros.ros.health.throttled_log import ThrottledLog

AUTO = 'auto'

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
        if not self._automatic:
            self._subscribe(
                QoSProfile(depth=request.queue_depth, reliability=_RELIABILITIES[reliability])
            )

    def update(self) -> None:
        """Subscribe, or subscribe again, if the QoS of the publishers asks for it."""
        publishers = self._node.get_publishers_info_by_topic(self.topic)
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
            request.message_type, request.topic, request.add, profile, event_callbacks=events
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


def _profile_for(
    publishers: Sequence[TopicEndpointInfo], request: SubscriptionRequest
) -> QoSProfile:
    """Return the strictest QoS that all `publishers` offer."""
    offered = [each.qos_profile for each in publishers]
    reliable = all(each.reliability == QoSReliabilityPolicy.RELIABLE for each in offered)
    kept = all(each.durability == QoSDurabilityPolicy.TRANSIENT_LOCAL for each in offered)
    return QoSProfile(
        depth=request.queue_depth,
        reliability=_RELIABILITIES['reliable' if reliable else 'best_effort'],
        durability=QoSDurabilityPolicy.TRANSIENT_LOCAL
        if request.latched and kept
        else QoSDurabilityPolicy.VOLATILE,
    )
