"""The joints as TF frames; tf2_msgs is needed for that alone, so it is looked for only then."""

from typing import TYPE_CHECKING

from rclpy.node import Node

from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.transforms import TF_MESSAGE, skeleton_transforms, transforms_message
from lsc_pose_ros.ros.io.message_types import message_class

if TYPE_CHECKING:
    from rclpy.publisher import Publisher

TOPIC = '/tf'

# What tf2_ros's own broadcaster has.
_QUEUE_DEPTH = 100


class Transforms:
    """The publisher of /tf, from `open` to `close`."""

    def __init__(self, node: Node) -> None:
        """Prepare; nothing is advertised before `open`.

        Args:
            node: the node that publishes.

        Raises:
            InputError: tf2_msgs is not installed.
        """
        self._node = node
        self._kind = message_class(TF_MESSAGE)
        self._publisher: Publisher | None = None
        if self._kind is None:
            msg = (
                'parameter publish_tf: it needs the package tf2_msgs, which is not here; '
                'install ros-jazzy-tf2-msgs, or leave publish_tf false'
            )
            raise InputError(msg)

    def open(self) -> None:
        """Advertise."""
        self._publisher = self._node.create_publisher(self._kind, TOPIC, _QUEUE_DEPTH)

    def close(self) -> None:
        """Withdraw the publisher."""
        if self._publisher is not None:
            self._node.destroy_publisher(self._publisher)
        self._publisher = None

    def publish(
        self, stamp: int, frame_id: str, skeletons: Skeletons, minimum_confidence: float
    ) -> None:
        """Publish where the joints of all bodies are; nothing where nobody is.

        Args:
            stamp: the depth image's, nanoseconds.
            frame_id: the depth image's.
            skeletons: the bodies.
            minimum_confidence: joints below it are left out.
        """
        transforms = skeleton_transforms(skeletons, frame_id, minimum_confidence)
        if transforms and self._publisher is not None:
            self._publisher.publish(transforms_message(stamp, transforms))
