"""What the node listens to: depth images, masks and camera infos."""

from collections.abc import Callable

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from lsc_pose_ros.messages.stamps import NANOSECONDS, nanoseconds
from lsc_pose_ros.ros.health.stream_warnings import Counters, TopicNames
from lsc_pose_ros.ros.health.throttled_log import Reports
from lsc_pose_ros.ros.io.frame_messages import FrameMessages, ImageMessage
from lsc_pose_ros.ros.io.subscription import IMAGE_QUEUE_DEPTH, Subscribed, Wanted
from lsc_pose_ros.settings.table import MASK, NodeSettings
from lsc_pose_ros.synchronization.synchronizer import Gathering, PairingSettings

# How often publishers are looked for, seconds.
_LOOK_PERIOD = 0.25


class Inputs:
    """The subscriptions, and the pairs that come of them.

    With the parameter `reliability` at auto, a topic is subscribed once it has a publisher, in
    the way in which all its publishers can be heard, and anew when that changes.

    Attributes:
        gathering: where the messages find each other, and are counted.
        topics: the full names of the topics, remapping done.
    """

    def __init__(
        self,
        node: Node,
        parameters: NodeSettings,
        reports: Reports,
        deliver: Callable[[FrameMessages], None],
    ) -> None:
        """Subscribe.

        Args:
            node: the node that subscribes.
            parameters: the node's.
            reports: where trouble with publishers is told.
            deliver: called with each pair, in the executor's thread.
        """
        self._node = node
        with_masks = parameters.segmentation == MASK
        self.gathering: Gathering[ImageMessage, ImageMessage, CameraInfo] = Gathering(
            PairingSettings(
                round(parameters.sync_slop * NANOSECONDS), parameters.sync_queue, with_masks
            ),
            lambda depth, mask, info: deliver(FrameMessages(depth, mask, info)),
        )
        wanted = [
            self._image('depth/image', 'depth_transport', parameters.depth_transport),
            Wanted('depth/camera_info', CameraInfo, self.gathering.add_camera_info, latched=True),
        ]
        if with_masks:
            wanted.append(self._image('mask', 'mask_transport', parameters.mask_transport))
        self._subscribed = [
            Subscribed(node, each, parameters.reliability, reports) for each in wanted
        ]
        self.topics = TopicNames(*(each.topic for each in self._subscribed))
        self._timer = node.create_timer(
            _LOOK_PERIOD, self._look, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )
        self._look()

    def set_sync_slop(self, seconds: float) -> None:
        """Change by how much the stamps of a depth image and its mask may differ."""
        self.gathering.slop_ns = round(seconds * NANOSECONDS)

    def publishers(self) -> dict[str, int]:
        """Return how many publishers each topic has."""
        return {each.topic: self._node.count_publishers(each.topic) for each in self._subscribed}

    def counters(self, replaced: int) -> Counters:
        """Return how much has come and gone.

        Args:
            replaced: how many pairs gave way to a newer one before they were worked on.
        """
        gathering = self.gathering
        return Counters(
            depth=gathering.depth,
            masks=gathering.masks,
            camera_infos=gathering.camera_infos,
            pairs=gathering.pairs,
            replaced=replaced,
            lost=sum(each.lost for each in self._subscribed),
            rewinds=gathering.rewinds,
            missing=gathering.missing,
            out_of_order=gathering.out_of_order,
            **gathering.left_out._asdict(),
        )

    def close(self) -> None:
        """Unsubscribe."""
        self._node.destroy_timer(self._timer)
        for each in self._subscribed:
            each.close()

    def _look(self) -> None:
        for each in self._subscribed:
            each.look()

    def _image(self, topic: str, parameter: str, transport: str) -> Wanted:
        take = self._take_depth if parameter == 'depth_transport' else self._take_mask
        if transport == 'raw':
            kind: type[ImageMessage] = Image
        else:
            kind = CompressedImage
            # As image_transport names it: the topic, remapped, and then the transport.
            topic = f'{self._node.resolve_topic_name(topic)}/{transport}'
        return Wanted(
            topic, kind, take, transport_parameter=parameter, queue_depth=IMAGE_QUEUE_DEPTH
        )

    def _take_depth(self, image: ImageMessage) -> None:
        self.gathering.add_depth(nanoseconds(image.header.stamp), image)

    def _take_mask(self, image: ImageMessage) -> None:
        self.gathering.add_mask(nanoseconds(image.header.stamp), image)
