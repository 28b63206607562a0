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

"""The node with publish_ros4hri, heard by a client that works as libhri does.

The package hri_msgs is built for the test, because it is not on PyPI.
"""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from live_ros import (
    SKELETONS,
    Camera,
    NodeServices,
    Program,
    PublishedEstimates,
    generate,
)
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from sensor_msgs.msg import JointState
from waiting import wait_until

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.messages.human_bodies import KEYPOINTS, BodyImage, body_region, keypoints
from lsc_pose_ros.messages.human_joint_angles import joint_angles

TRACKED = '/humans/bodies/tracked'
SECOND = 1_000_000_000
FRAME_TIME = 33_333_333


class HriClient:
    """Subscribes to the topics of a body when its id is listed, and until it is no more.

    Attributes:
        lists: the ids of each list.
        bodies: the messages of the bodies that are tracked now, by stamp and topic.
    """

    def __init__(self, node: Node) -> None:
        from hri_msgs.msg import (  # noqa: PLC0415 - built for the test
            IdsList,
            NormalizedRegionOfInterest2D,
            Skeleton2D,
        )

        self.lists: list[list[str]] = []
        self.bodies: dict[str, dict[int, dict[str, Any]]] = {}
        self._types = {
            'roi': NormalizedRegionOfInterest2D,
            'skeleton2d': Skeleton2D,
            'joint_states': JointState,
        }
        self._node = node
        self._subscriptions: dict[str, list[Any]] = {}
        self._executor = SingleThreadedExecutor(context=node.context)
        node.create_subscription(IdsList, TRACKED, self._follow, 1)

    def hears(self, condition: Callable[[], object]) -> bool:
        """Receive messages until a condition holds."""

        def heard() -> bool:
            self._executor.spin_once(0.01)
            return bool(condition())

        self._executor.add_node(self._node)  # others spin the node, too
        found = wait_until(heard)
        self._executor.remove_node(self._node)
        return found

    def complete(self, body: str) -> list[int]:
        """Return the stamps of the images of which all messages of a body have come."""
        found = self.bodies.get(body, {}).items()
        return [stamp for stamp, messages in found if messages.keys() == self._types.keys()]

    def _follow(self, message: Any) -> None:
        ids = list(message.ids)
        self.lists.append(ids)
        for body in set(self._subscriptions) - set(ids):
            for each in self._subscriptions.pop(body):
                self._node.destroy_subscription(each)
            del self.bodies[body]
        for body in set(ids) - set(self._subscriptions):
            self.bodies[body] = {}
            self._subscriptions[body] = [
                self._node.create_subscription(
                    kind, f'/humans/bodies/{body}/{topic}', self._keeper(body, topic), 1
                )
                for topic, kind in self._types.items()
            ]

    def _keeper(self, body: str, topic: str) -> Callable[[Any], None]:
        def keep(message: Any) -> None:
            stamp = message.header.stamp.sec * SECOND + message.header.stamp.nanosec
            if body in self.bodies:
                self.bodies[body].setdefault(stamp, {})[topic] = message

        return keep


@pytest.fixture
def client(probe: Node, hri_packages: Path, monkeypatch: pytest.MonkeyPatch) -> HriClient:
    monkeypatch.syspath_prepend(str(hri_packages))
    return HriClient(probe)


@pytest.fixture
def node(
    start_program: Callable[..., Program],
    ros_environment: dict[str, str],
    hri_packages: Path,
) -> Program:
    values = {'model': 'front', 'temporal': False, 'publish_ros4hri': True}
    words = [word for name, value in values.items() for word in ('-p', f'{name}:={value}')]
    path = os.pathsep.join([str(hri_packages), ros_environment['PYTHONPATH']])
    program = start_program(
        '-m', 'lsc_pose_ros.ros.node.main', '--ros-args', *words, PYTHONPATH=path
    )
    assert program.prints('ready'), program.output
    return program


def numbered(frame: Frame, number: int, stamp: int) -> Frame:
    """The frame with its only body under another number."""
    labels = np.where(frame.labels >= 0, np.int32(number), frame.labels)
    return frame._replace(labels=labels, stamp=stamp)


def test_a_body_comes_and_another_one_goes(
    node: Program,
    camera: Camera,
    estimates: PublishedEstimates,
    client: HriClient,
    services: NodeServices,
    probe: Node,
    tmp_path: Path,
) -> None:
    frame = generate(tmp_path, frames=1)[0]
    camera.wait_for_node()
    estimates.wait_for_node()
    sent: list[Frame] = []

    def sees(number: int) -> bool:
        """Send images of a body until the client hears of one of them by all topics."""
        if client.complete(f'b{number}'):
            return True
        if len(estimates.of(SKELETONS)) < len(sent):
            return False
        stamp = sent[-1].stamp + FRAME_TIME if sent else frame.stamp
        sent.append(numbered(frame, number, stamp))
        camera.send(sent[-1])
        return False

    assert client.hears(lambda: sees(3)), node.output
    assert client.lists[-1] == ['b3']
    assert_messages(client, 'b3', sent, estimates)

    # The first body leaves; for a second it may come back, then its publishers are destroyed.
    others = [f'/humans/bodies/b3/{name}' for name in ('roi', 'skeleton2d', 'joint_states')]
    sent.append(numbered(frame, 7, sent[-1].stamp + FRAME_TIME))
    camera.send(sent[-1])
    assert client.hears(lambda: client.lists[-1] == ['b7']), node.output
    assert set(client.bodies) == {'b7'}
    assert all(probe.count_publishers(each) == 1 for each in others)
    sent.append(numbered(frame, 7, sent[-1].stamp + SECOND))
    camera.send(sent[-1])
    assert client.hears(lambda: sees(7)), node.output
    assert_messages(client, 'b7', sent, estimates)
    assert client.hears(lambda: not any(probe.count_publishers(each) for each in others))

    # Nobody is seen, and the list says so.
    empty = numbered(frame, 7, sent[-1].stamp + FRAME_TIME)
    camera.send(empty._replace(labels=np.full_like(frame.labels, -1)))
    assert client.hears(lambda: client.lists[-1] == []), node.output
    assert client.bodies == {}

    # Nor is whoever is seen when the node is deactivated.
    camera.send(numbered(frame, 8, empty.stamp + FRAME_TIME))
    assert client.hears(lambda: client.lists[-1] == ['b8']), node.output
    assert services.change('deactivate'), node.output
    assert client.hears(lambda: client.lists[-1] == []), node.output
    gone = [TRACKED, *(f'/humans/bodies/b{number}/roi' for number in (7, 8))]
    assert client.hears(lambda: not any(probe.count_publishers(each) for each in gone))
    assert {tuple(each) for each in client.lists} == {('b3',), ('b7',), ('b8',), ()}
    assert 'Traceback' not in node.output


def assert_messages(
    client: HriClient, body: str, sent: list[Frame], estimates: PublishedEstimates
) -> None:
    """Compare the messages of a body with the skeletons of the same image."""
    number = int(body[1:])
    stamp = client.complete(body)[0]
    messages = client.bodies[body][stamp]
    frame = next(each for each in sent if each.stamp == stamp)
    assert {each.header.frame_id for each in messages.values()} == {frame.frame_id}
    skeletons = estimates.skeletons[frame.stamp]
    assert skeletons.bodies.tolist() == [number]
    image = BodyImage.of(frame, {number: number})
    roi, region = messages['roi'], body_region(image, number)
    assert region is not None
    # The fields are float32.
    assert (roi.xmin, roi.ymin, roi.xmax, roi.ymax) == pytest.approx(region, rel=1e-6)
    assert roi.c == pytest.approx(float(skeletons.confidence.mean()), rel=1e-6)
    points = messages['skeleton2d'].skeleton
    assert [(each.x, each.y, each.c) for each in points] == [
        pytest.approx(tuple(each), rel=1e-6) for each in keypoints(skeletons, image)[0].tolist()
    ]
    known = [name for name, each in zip(KEYPOINTS, points, strict=True) if each.c > 0]
    assert len(known) >= 10
    # They lie in the person's region, or near it: joints are inside of the body.
    for each in points:
        if each.c > 0.5:
            assert roi.xmin - 0.1 < each.x < roi.xmax + 0.1
            assert roi.ymin - 0.1 < each.y < roi.ymax + 0.1
    state = messages['joint_states']
    angles = joint_angles(skeletons.joints, skeletons.positions[0])
    assert angles is not None
    assert dict(zip(state.name, state.position, strict=True)) == {
        f'{name}_{body}': angle for name, angle in angles.items()
    }
    assert f'l_elbow_{body}' in state.name


def test_the_built_package_writes_what_others_read(
    hri_packages: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The bytes of rclpy, read by rosbags, which has its own reading of the definitions."""
    from message_package import DEFINITIONS  # noqa: PLC0415
    from rclpy.serialization import serialize_message  # noqa: PLC0415

    monkeypatch.syspath_prepend(str(hri_packages))
    from hri_msgs.msg import NormalizedPointOfInterest2D, Skeleton2D  # noqa: PLC0415

    store = get_typestore(Stores.ROS2_JAZZY)
    for file in DEFINITIONS.glob('*.msg'):
        store.register(get_types_from_msg(file.read_text(), f'hri_msgs/msg/{file.stem}'))
    points = [NormalizedPointOfInterest2D(x=k / 32, y=k / 64, c=1.0) for k in range(18)]
    data = serialize_message(Skeleton2D(skeleton=points))
    read: Any = store.deserialize_cdr(data, 'hri_msgs/msg/Skeleton2D')
    assert [(each.x, each.y) for each in read.skeleton] == [(k / 32, k / 64) for k in range(18)]
    assert deserialize_message(data, Skeleton2D).skeleton == points
