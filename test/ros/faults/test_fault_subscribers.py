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

"""Subscribers that come and go, and a second node of the same name."""

from pathlib import Path

from fault_stream import SEND_AGAIN, FaultStream
from live_ros import ANSWERS, Handshake
from rclpy.node import Node
from sensor_msgs.msg import PointCloud2
from visualization_msgs.msg import MarkerArray
from waiting import becomes, wait_until

KINDS = {'PointCloud2': PointCloud2, 'MarkerArray': MarkerArray}


def test_subscribers_come_and_go_while_frames_are_answered(stream: FaultStream) -> None:
    for _ in range(10):
        subscriptions = [
            stream.node.create_subscription(
                KINDS[kind.rpartition('/')[2]], topic, lambda _: None, 10
            )
            for topic, kind in ANSWERS.items()
        ]
        stream.ask(stream.good())
        for each in subscriptions:
            stream.node.destroy_subscription(each)
        stream.ask(stream.good())


def test_nodes_that_subscribe_and_vanish_do_no_harm(stream: FaultStream) -> None:
    for number in range(5):
        other = Node(f'other_{number}', context=stream.node.context, use_global_arguments=False)
        for topic, kind in ANSWERS.items():
            other.create_subscription(KINDS[kind.rpartition('/')[2]], topic, lambda _: None, 10)
        Handshake(other).call()
        stream.ask(stream.good())
        other.destroy_node()


def test_second_node_with_the_same_name_does_not_disturb_the_first(
    stream: FaultStream, small_model_file: Path
) -> None:
    names = stream.node.get_node_names
    with stream.another_node(small_model_file) as other:
        assert other.prints('ready'), other.output
        assert wait_until(lambda: names().count('pose_node') == 2)

        def both_answer() -> bool:
            header = stream.send(stream.good())
            return becomes(lambda: stream.count_answers(header) == 2, SEND_AGAIN)

        assert wait_until(both_answer), other.output
        for _ in range(3):
            header = stream.send(stream.good())
            assert wait_until(lambda sent=header: stream.count_answers(sent) == 2), other.output
        assert 'Traceback' not in other.output
    assert wait_until(lambda: names().count('pose_node') == 1)
    stream.connect()
