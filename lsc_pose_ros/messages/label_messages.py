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

"""Reads the messages in which other programs publish joints."""

from typing import Any, NamedTuple

from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.messages.parse import parse_skeletons
from lsc_pose_ros.messages.stamps import nanoseconds

# LINE_STRIP, LINE_LIST, CUBE_LIST, SPHERE_LIST, POINTS and TRIANGLE_LIST of
# visualization_msgs/Marker: their position is that of no single point.
_LISTS = (4, 5, 6, 7, 8, 11)

_DELETE = (2, 3)  # DELETE and DELETEALL of visualization_msgs/Marker


class StampedTransform(NamedTuple):
    """The pose of a child frame in its parent at one moment.

    Attributes:
        stamp: nanoseconds.
        parent: the name of the parent frame.
        child: the name of the child frame.
        translation: metres.
        rotation: a quaternion (x, y, z, w).
    """

    stamp: int
    parent: str
    child: str
    translation: tuple[float, float, float]
    rotation: tuple[float, float, float, float]


class MarkerPoint(NamedTuple):
    """The position of one visualization_msgs/Marker; `stamp` in nanoseconds, metres."""

    stamp: int
    frame_id: str
    namespace: str
    identifier: int
    position: tuple[float, float, float]


class MarkerPoints(NamedTuple):
    """The markers with one position each, and how many others have lists of points."""

    points: list[MarkerPoint]
    lists: int


class FramedSkeletons(NamedTuple):
    """Skeletons with the name of the frame that they are in; `stamp` in nanoseconds."""

    stamp: int
    frame_id: str
    skeletons: Skeletons


def parse_stamped_transforms(message: Any) -> list[StampedTransform]:  # noqa: ANN401
    """Return the transforms of a tf2_msgs/TFMessage."""
    return [
        StampedTransform(
            nanoseconds(each.header.stamp),
            each.header.frame_id,
            each.child_frame_id,
            _xyz(each.transform.translation),
            (*_xyz(each.transform.rotation), float(each.transform.rotation.w)),
        )
        for each in message.transforms
    ]


def parse_marker_points(message: Any) -> MarkerPoints:  # noqa: ANN401
    """Return the positions of a visualization_msgs/MarkerArray, without deleted markers."""
    shown = [each for each in message.markers if each.action not in _DELETE]
    points = [
        MarkerPoint(
            nanoseconds(each.header.stamp),
            each.header.frame_id,
            each.ns,
            int(each.id),
            _xyz(each.pose.position),
        )
        for each in shown
        if each.type not in _LISTS
    ]
    return MarkerPoints(points, len(shown) - len(points))


def parse_framed_skeletons(message: Any) -> FramedSkeletons:  # noqa: ANN401
    """Return the skeletons of a sensor_msgs/PointCloud2 and their frame.

    Raises:
        InputError: the cloud carries no skeletons.
    """
    stamp, skeletons = parse_skeletons(message)
    return FramedSkeletons(stamp, message.header.frame_id, skeletons)


def _xyz(vector: Any) -> tuple[float, float, float]:  # noqa: ANN401
    return float(vector.x), float(vector.y), float(vector.z)
