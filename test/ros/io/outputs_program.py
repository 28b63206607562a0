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

"""A node with `Outputs` and `Diagnostics` alone, which plays the part of the rest.

outputs_program.py OPTIONS, in JSON:
    publish_tf, publish_ros4hri, minimum_confidence, marker_lifetime: the parameters.
    scenes: what is published, each the numbers of the bodies that are seen.
    latency: how old the stamps are, seconds.
    failures: how many frames fail after that.
    closes: whether the publishers are closed at the end.
    topics: those that must be subscribed to before it begins.
"""

import json
import sys
import time

import numpy as np
import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from spinning import spin_until_told_to_stop

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.joints import numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.human_bodies import BodyImage
from lsc_pose_ros.ros.health.diagnostics import Diagnostics
from lsc_pose_ros.ros.health.stream_warnings import Counters
from lsc_pose_ros.ros.io.outputs import Outputs
from lsc_pose_ros.settings.table import NodeSettings

FRAME_ID = 'camera_optical'
# Nobody has a pixel in it.
IMAGE = BodyImage(np.full((120, 160), -1, np.int32), Intrinsics(150.0, 150.0, 80.0, 60.0), {})
EDGES = np.array([[1, 0], [1, 2]], np.int32)
PERIOD = 1 / 30


def skeletons(bodies: list[int]) -> Skeletons:
    """Everybody has a head of little confidence, a neck, and both hips."""
    joints = numbers_of(['head', 'neck', 'l_hip', 'r_hip'])
    pose = [(0.1, -0.7, 3.0), (0.0, -0.5, 3.0), (0.12, 0.0, 3.0), (-0.12, 0.0, 3.0)]
    count = len(bodies)
    return Skeletons(
        np.array(bodies, np.uint16),
        joints,
        np.tile(np.array(pose, np.float32), (count, 1, 1)),
        np.tile(np.array([0.2, 0.9, 0.9, 0.9], np.float32), (count, 1)),
    )


def tell(text: str) -> None:
    sys.stdout.write(f'{text}\n')
    sys.stdout.flush()


def has_subscriber(node: Node, topic: str) -> bool:
    """Whether our publisher of a topic has found a subscriber, which may not have found it."""
    return any(
        each.topic_name == topic and each.get_subscription_count() for each in node.publishers
    )


def wait_until_received(node: Node) -> None:
    """Wait for the subscribers: one that has yet to find its publisher gets nothing of a dead."""
    for publisher in node.publishers:
        publisher.wait_for_all_acked(Duration(seconds=60))


def main() -> int:
    options = json.loads(sys.argv.pop(1))
    rclpy.init(args=sys.argv)
    node = Node('program')
    names = {
        'publish_tf',
        'publish_ros4hri',
        'minimum_confidence',
        'marker_lifetime',
    } & options.keys()
    parameters = NodeSettings(**{name: options[name] for name in names})
    try:
        outputs = Outputs(node, parameters, EDGES)
    except InputError as error:
        sys.stdout.write(f'{error}\n')
        return 2
    outputs.warm_up(skeletons([1]))
    outputs.publish(0, FRAME_ID, skeletons([1]), IMAGE)  # nobody may hear of it
    for _ in range(2):  # as after deactivation
        outputs.open()
        outputs.close()
    outputs.open()
    counted = {'depth': 0, 'pairs': 0}
    diagnostics = Diagnostics(node, lambda: Counters(**counted))
    tell('open')
    while not all(has_subscriber(node, topic) for topic in options['topics']):
        rclpy.spin_once(node, timeout_sec=0.02)

    def answer(scene: list[int]) -> None:
        stamp = node.get_clock().now().nanoseconds - round(options.get('latency', 0) * 1e9)
        counted['depth'] += 1
        counted['pairs'] += 1
        with diagnostics.measurements.stage('estimate'):
            time.sleep(0.005)
        outputs.publish(stamp, FRAME_ID, skeletons(scene), IMAGE)
        diagnostics.count_estimate(stamp, len(scene))

    def step() -> None:
        if options['scenes']:
            answer(options['scenes'].pop(0))
        elif options.get('failures', 0) > 0:
            options['failures'] -= 1
            counted['depth'] += 1
            diagnostics.measurements.count_failure()
        elif options.get('closes'):
            wait_until_received(node)
            outputs.close()
            diagnostics.close()
            tell('closed')
            options['closes'] = False

    node.create_timer(PERIOD, step)
    spin_until_told_to_stop(node)
    rclpy.try_shutdown()
    return 0


sys.exit(main())
