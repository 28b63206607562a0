"""What the node publishes: the skeletons, and markers that draw them."""

import numpy as np
from numpy.typing import NDArray
from rclpy.node import Node
from sensor_msgs.msg import PointCloud2
from visualization_msgs.msg import MarkerArray

from lsc_pose_ros.core.skeletons import Skeletons
from lsc_pose_ros.data.markers import skeleton_markers
from lsc_pose_ros.data.recording.serialise import markers_message, skeletons_message
from lsc_pose_ros.ros.messages import NANOSECONDS
from lsc_pose_ros.ros.parameters import Parameters

# Reliable, so that a subscriber of either kind gets them; they are small.
_QUEUE_DEPTH = 10


class Outputs:
    """The publishers. Used from one thread at a time."""

    def __init__(self, node: Node, parameters: Parameters, edges: NDArray[np.int32]) -> None:
        """Advertise.

        Args:
            node: the node that publishes.
            parameters: the node's.
            edges: the bones to draw, pairs of indices into the model's joints, shape (E, 2).
        """
        self._edges = edges
        self._minimum_confidence = parameters.minimum_confidence
        self._lifetime_ns = round(parameters.marker_lifetime * NANOSECONDS)
        self._drawn: frozenset[int] = frozenset()
        self._skeletons = node.create_publisher(PointCloud2, '~/skeletons', _QUEUE_DEPTH)
        self._markers = node.create_publisher(MarkerArray, '~/joint_markers', _QUEUE_DEPTH)

    def rehearse(self, skeletons: Skeletons) -> None:
        """Do all that `publish` does, but publish nothing: the first time takes far longer."""
        skeletons_message(0, '', skeletons)
        self._draw(0, '', skeletons)
        self._drawn = frozenset()

    def publish(self, stamp: int, frame_id: str, skeletons: Skeletons) -> None:
        """Publish the answer to one depth image.

        The messages are serialised as a recording's are, so both hold the same.

        Args:
            stamp: the depth image's, nanoseconds.
            frame_id: the depth image's.
            skeletons: the answer.
        """
        self._skeletons.publish(skeletons_message(stamp, frame_id, skeletons))
        self._markers.publish(self._draw(stamp, frame_id, skeletons))

    def _draw(self, stamp: int, frame_id: str, skeletons: Skeletons) -> bytes:
        bodies = frozenset(skeletons.bodies.tolist())
        shapes = skeleton_markers(
            skeletons,
            self._edges,
            minimum_confidence=self._minimum_confidence,
            gone=self._drawn - bodies,
        )
        self._drawn = bodies
        return markers_message(
            stamp, frame_id, [shape._replace(lifetime_ns=self._lifetime_ns) for shape in shapes]
        )
