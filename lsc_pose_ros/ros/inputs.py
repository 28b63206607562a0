"""What the node listens to: depth images, masks and camera infos."""

from collections.abc import Callable
from typing import Any

from rclpy.event_handler import SubscriptionEventCallbacks, UnsupportedEventTypeError
from rclpy.node import Node
from rclpy.qos import QoSProfile, QoSReliabilityPolicy, qos_policy_name_from_kind
from rclpy.subscription import Subscription
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from lsc_pose_ros.ros.gathering import Gathering, PairingSettings
from lsc_pose_ros.ros.messages import NANOSECONDS, AnyImage, Pair, nanoseconds
from lsc_pose_ros.ros.parameters import COMPRESSED_DEPTH, Parameters
from lsc_pose_ros.ros.reports import Reports
from lsc_pose_ros.ros.watch import TopicNames

_RELIABILITIES = {
    'best_effort': QoSReliabilityPolicy.BEST_EFFORT,
    'reliable': QoSReliabilityPolicy.RELIABLE,
}

# Enough for a burst: the callbacks only pass the messages on, so none waits here for long.
_QUEUE_DEPTH = 10


class Inputs:
    """The subscriptions, and the pairs that come of them.

    Attributes:
        gathering: where the messages find each other, and are counted.
        lost: how many messages of each topic the middleware says it has lost.
        topics: the full names of the topics, remapping done.
    """

    def __init__(
        self,
        node: Node,
        parameters: Parameters,
        reports: Reports,
        deliver: Callable[[Pair], None],
    ) -> None:
        """Subscribe.

        Args:
            node: the node that subscribes.
            parameters: the node's.
            reports: where trouble with publishers is told.
            deliver: called with each pair, in the executor's thread.
        """
        self._node = node
        self._reports = reports
        self._qos = QoSProfile(
            depth=_QUEUE_DEPTH, reliability=_RELIABILITIES[parameters.reliability]
        )
        self.gathering: Gathering[AnyImage, Image, CameraInfo] = Gathering(
            PairingSettings(round(parameters.sync_slop * NANOSECONDS), parameters.sync_queue),
            lambda depth, mask, info: deliver(Pair(depth, mask, info)),
        )
        self.lost: dict[str, int] = {}
        self._subscriptions = [
            self._subscribe(CompressedImage, 'depth/image/compressedDepth', self._take_depth)
            if parameters.depth_transport == COMPRESSED_DEPTH
            else self._subscribe(Image, 'depth/image', self._take_depth),
            self._subscribe(CameraInfo, 'depth/camera_info', self.gathering.add_camera_info),
            self._subscribe(Image, 'mask', self._take_mask),
        ]
        self.topics = TopicNames(*(each.topic_name for each in self._subscriptions))

    def publishers(self) -> dict[str, int]:
        """Return how many publishers each topic has."""
        return {each.topic_name: each.get_publisher_count() for each in self._subscriptions}

    def close(self) -> None:
        """Unsubscribe."""
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)
        self._subscriptions.clear()

    def _take_depth(self, image: AnyImage) -> None:
        self.gathering.add_depth(nanoseconds(image.header.stamp), image)

    def _take_mask(self, image: Image) -> None:
        self.gathering.add_mask(nanoseconds(image.header.stamp), image)

    def _subscribe(
        self,
        message_type: type[Any],
        topic: str,
        take: Callable[[Any], None],
    ) -> Subscription:
        name = self._node.resolve_topic_name(topic)
        self.lost[name] = 0
        events = SubscriptionEventCallbacks(
            incompatible_qos=lambda event: self._tell_incompatible(name, event),
            message_lost=lambda event: self._count_lost(name, event),
        )
        try:
            return self._node.create_subscription(
                message_type, topic, take, self._qos, event_callbacks=events
            )
        except UnsupportedEventTypeError:  # not every middleware knows what it loses
            events.message_lost = None
            return self._node.create_subscription(
                message_type, topic, take, self._qos, event_callbacks=events
            )

    def _count_lost(self, topic: str, event: Any) -> None:  # noqa: ANN401
        self.lost[topic] += event.total_count_change

    def _tell_incompatible(self, topic: str, event: Any) -> None:  # noqa: ANN401
        policy = qos_policy_name_from_kind(event.last_policy_kind)
        remedy = 'change the publisher'
        if policy == 'RELIABILITY':
            remedy = 'set the parameter reliability to best_effort, which suits every publisher'
        self._reports.error(
            f'incompatible {topic}',
            f'{topic}: a publisher offers an incompatible {policy}, so nothing comes from it; '
            f'{remedy}',
        )
