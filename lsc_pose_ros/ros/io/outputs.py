"""What the node publishes: the skeletons, markers that draw them, and frames of the joints."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from rclpy.node import Node
from sensor_msgs.msg import PointCloud2
from visualization_msgs.msg import MarkerArray

from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.messages.build.markers import build_markers
from lsc_pose_ros.messages.build.skeletons import build_skeletons
from lsc_pose_ros.messages.markers import Drawing
from lsc_pose_ros.ros.io.message_types import RCLPY_CLASSES
from lsc_pose_ros.ros.io.transforms import TransformPublisher
from lsc_pose_ros.settings.table import NodeSettings

if TYPE_CHECKING:
    from rclpy.publisher import Publisher

# Reliable, so that a subscriber of either kind gets them; they are small.
_QUEUE_DEPTH = 10


class Outputs:
    """The publishers, from `open` to `close`; `publish` from one thread at a time.

    Attributes:
        parameters: the node's; may be replaced at any time, from any thread.
    """

    def __init__(self, node: Node, parameters: NodeSettings, edges: NDArray[np.int32]) -> None:
        """Prepare; nothing is advertised before `open`.

        Args:
            node: the node that publishes.
            parameters: the node's.
            edges: the bones to draw, pairs of indices into the model's joints, shape (E, 2).

        Raises:
            InputError: publish_tf is set, but tf2_msgs is not installed.
        """
        self.parameters = parameters
        self._node = node
        self._edges = edges
        self._transforms = TransformPublisher(node) if parameters.publish_tf else None
        self._drawing = Drawing(edges)
        self._skeletons: Publisher | None = None
        self._markers: Publisher | None = None

    def open(self) -> None:
        """Advertise."""
        self._drawing = Drawing(self._edges)
        self._skeletons = self._node.create_publisher(PointCloud2, '~/skeletons', _QUEUE_DEPTH)
        self._markers = self._node.create_publisher(MarkerArray, '~/joint_markers', _QUEUE_DEPTH)
        if self._transforms is not None:
            self._transforms.open()

    def close(self) -> None:
        """Withdraw the publishers; no answer may be on its way any more."""
        for publisher in (self._skeletons, self._markers):
            if publisher is not None:
                self._node.destroy_publisher(publisher)
        self._skeletons = self._markers = None
        if self._transforms is not None:
            self._transforms.close()

    def rehearse(self, skeletons: Skeletons) -> None:
        """Do all that `publish` does, but publish nothing: the first time takes far longer."""
        build_skeletons(RCLPY_CLASSES, 0, '', skeletons)
        shapes = Drawing(self._edges).shapes(skeletons, self.parameters)
        build_markers(RCLPY_CLASSES, 0, '', shapes)
        if self._transforms is not None:
            self._transforms.rehearse(skeletons)

    def publish(self, stamp: int, frame_id: str, skeletons: Skeletons) -> None:
        """Publish the answer to one depth image; before `open` and after `close`, do nothing.

        Args:
            stamp: the depth image's, nanoseconds.
            frame_id: the depth image's.
            skeletons: the answer.
        """
        if self._skeletons is None or self._markers is None:
            return
        self._skeletons.publish(build_skeletons(RCLPY_CLASSES, stamp, frame_id, skeletons))
        shapes = self._drawing.shapes(skeletons, self.parameters)
        self._markers.publish(build_markers(RCLPY_CLASSES, stamp, frame_id, shapes))
        if self._transforms is not None:
            self._transforms.publish(
                stamp, frame_id, skeletons, self.parameters.minimum_confidence
            )
