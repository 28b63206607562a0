"""One subscription that suits whatever publishers there are."""

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

from lsc_pose_ros.ros.health.throttled_log import Reports

AUTO = 'auto'

_RELIABILITIES = {
    'best_effort': QoSReliabilityPolicy.BEST_EFFORT,
    'reliable': QoSReliabilityPolicy.RELIABLE,
}

# Enough for a burst: the callbacks only pass the messages on, so none waits here for long.
_QUEUE_DEPTH = 10

IMAGE_QUEUE_DEPTH = 4
"""For images: of 640x480 and faster than they can be taken, ten each held 8 MB more."""


class Wanted(NamedTuple):
    """What to subscribe.

    Attributes:
        topic: its name, not yet remapped.
        message_type: the class of its messages.
        take: called with each message.
        latched: whether what was published before is wanted, too, where publishers keep it.
        transport_parameter: the parameter that decides on the type of the messages, if any.
        queue_depth: how many messages wait to be taken.
    """

    topic: str
    message_type: type[Any]
    take: Callable[[Any], None]
    latched: bool = False
    transport_parameter: str = ''
    queue_depth: int = _QUEUE_DEPTH


class Subscribed:
    """A topic that is listened to.

    Attributes:
        topic: its full name, remapping done.
        lost: how many messages the middleware says it has lost.
    """

    def __init__(self, node: Node, wanted: Wanted, reliability: str, reports: Reports) -> None:
        """Subscribe, or prepare to, where it depends on the publishers.

        Args:
            node: the node that subscribes.
            wanted: what.
            reliability: best_effort, reliable, or auto for what all publishers offer.
            reports: where trouble with publishers is told.
        """
        self.topic = node.resolve_topic_name(wanted.topic)
        self.lost = 0
        self._node = node
        self._wanted = wanted
        self._reports = reports
        self._automatic = reliability == AUTO
        self._profile: QoSProfile | None = None
        self._subscription: Subscription | None = None
        if not self._automatic:
            self._subscribe(
                QoSProfile(depth=wanted.queue_depth, reliability=_RELIABILITIES[reliability])
            )

    def look(self) -> None:
        """Look at the publishers; subscribe, or subscribe anew, as suits them."""
        publishers = self._node.get_publishers_info_by_topic(self.topic)
        suitable = [each for each in publishers if each.topic_type == self._type_name]
        if len(suitable) < len(publishers):
            self._tell_wrong_type(publishers)
        if self._automatic and suitable:
            profile = _profile_for(suitable, self._wanted)
            if profile != self._profile:
                self._subscribe(profile)

    def close(self) -> None:
        """Unsubscribe."""
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None

    @property
    def _type_name(self) -> str:
        message_type = self._wanted.message_type
        return f'{message_type.__module__.partition(".")[0]}/msg/{message_type.__name__}'

    def _subscribe(self, profile: QoSProfile) -> None:
        self.close()
        self._profile = profile
        events = SubscriptionEventCallbacks(
            incompatible_qos=self._tell_incompatible,
            message_lost=self._count_lost,
            use_default_callbacks=False,
        )
        try:
            self._subscription = self._create(profile, events)
        except UnsupportedEventTypeError:  # not every middleware knows what it loses
            events.message_lost = None
            self._subscription = self._create(profile, events)

    def _create(self, profile: QoSProfile, events: SubscriptionEventCallbacks) -> Subscription:
        wanted = self._wanted
        return self._node.create_subscription(
            wanted.message_type, wanted.topic, wanted.take, profile, event_callbacks=events
        )

    def _count_lost(self, event: Any) -> None:  # noqa: ANN401
        self.lost += event.total_count_change

    def _tell_incompatible(self, event: Any) -> None:  # noqa: ANN401
        if self._automatic:
            return  # a publisher has just come; the next look at them suits it, too
        policy = qos_policy_name_from_kind(event.last_policy_kind)
        remedy = 'change the publisher'
        if policy == 'RELIABILITY':
            remedy = 'set the parameter reliability to auto or best_effort, which suit it'
        self._reports.error(
            f'incompatible {self.topic}',
            f'{self.topic}: a publisher offers an incompatible {policy}, so nothing comes from '
            f'it; {remedy}',
        )

    def _tell_wrong_type(self, publishers: Sequence[TopicEndpointInfo]) -> None:
        types = {each.topic_type for each in publishers} - {self._type_name}
        remedy = 'remap the node to another topic'
        if self._wanted.transport_parameter:
            remedy += f', or set the parameter {self._wanted.transport_parameter}'
        self._reports.error(
            f'type of {self.topic}',
            f'{self.topic}: a publisher sends {", ".join(sorted(types))}, but '
            f'{self._type_name} is needed, so nothing comes from it; {remedy}',
        )


def _profile_for(publishers: Sequence[TopicEndpointInfo], wanted: Wanted) -> QoSProfile:
    """Return the most that all of `publishers` offer."""
    offered = [each.qos_profile for each in publishers]
    reliable = all(each.reliability == QoSReliabilityPolicy.RELIABLE for each in offered)
    kept = all(each.durability == QoSDurabilityPolicy.TRANSIENT_LOCAL for each in offered)
    return QoSProfile(
        depth=wanted.queue_depth,
        reliability=_RELIABILITIES['reliable' if reliable else 'best_effort'],
        durability=QoSDurabilityPolicy.TRANSIENT_LOCAL
        if wanted.latched and kept
        else QoSDurabilityPolicy.VOLATILE,
    )
