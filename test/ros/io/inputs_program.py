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

"""The node's subscriptions alone, for the tests: says what it receives.

inputs_program.py [parameter=value ...] --ros-args ...

Each pair becomes a line `pair DEPTH_STAMP MASK_STAMP`, None without a mask. Once a second, which
stands for the node's five, it says its counters, and complains as the node does.
"""

import sys

import rclpy
from rclpy.node import Node
from spinning import spin_until_told_to_stop

from lsc_pose_ros.messages.stamps import nanoseconds
from lsc_pose_ros.ros.health.stream_warnings import StreamContext, stream_warnings
from lsc_pose_ros.ros.health.throttled_log import ThrottledLog
from lsc_pose_ros.ros.io.frame_messages import FrameMessages
from lsc_pose_ros.ros.io.inputs import Inputs
from lsc_pose_ros.settings.table import SETTINGS, NodeSettings


def parameters(words: list[str]) -> NodeSettings:
    """The defaults, but for `words`."""
    values = {name: setting.default for name, setting in SETTINGS.items()}
    for word in words:
        name, _, value = word.partition('=')
        values[name] = type(values[name])(value)
    return NodeSettings(**values)


def say(*words: object) -> None:
    print(*words, flush=True)  # noqa: T201


def deliver(pair: FrameMessages) -> None:
    mask = None if pair.mask is None else nanoseconds(pair.mask.header.stamp)
    say('pair', nanoseconds(pair.depth.header.stamp), mask)


end = sys.argv.index('--ros-args') if '--ros-args' in sys.argv else len(sys.argv)
rclpy.init(args=sys.argv[end:])
node = Node('pose_node')
log = ThrottledLog(node.get_logger())
inputs = Inputs(node, parameters(sys.argv[1:end]), log, deliver)
seen = inputs.counters(0)
say('listening to', *inputs.topics.subscribed)


def watch() -> None:
    global seen
    before, seen = seen, inputs.counters(0)
    say('counters', seen)
    context = StreamContext(
        inputs.topics,
        inputs.publishers(),
        '/share/fastdds_profile.xml',
        dict.fromkeys(inputs.topics.subscribed, 1.0),
        inputs.delivery(),
    )
    for kind, text in stream_warnings(before, seen, context).items():
        log.warning(kind, text)


node.create_timer(1.0, watch)
spin_until_told_to_stop(node)
inputs.close()
say('closed')
rclpy.try_shutdown()
