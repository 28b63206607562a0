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

# ruff: noqa: INP001 - a program, not a package
"""Notes when each of the node's answers arrives, until its own input ends.

`python live_listener.py FILE`; `live.py` starts it. FILE gets, as JSON, for each answer its stamp
and its arrival, nanoseconds since 1970, and how many joints it has; and what the node says of
itself on /diagnostics.
"""

import json
import sys
from pathlib import Path

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.serialization import deserialize_message

from lsc_pose_ros.bags.estimated_copy import SKELETONS_TOPIC
from lsc_pose_ros.bags.serialization.deserialize import read_skeletons
from lsc_pose_ros.messages.type_names import POINT_CLOUD
from lsc_pose_ros.ros.health.diagnostics import TOPIC as DIAGNOSTICS_TOPIC
from lsc_pose_ros.ros.playback.listener import open_listener

_TYPES = {SKELETONS_TOPIC: POINT_CLOUD, DIAGNOSTICS_TOPIC: 'diagnostic_msgs/msg/DiagnosticArray'}


def main() -> int:
    """Listen; return the exit status."""
    with open_listener(_TYPES) as listener:
        sys.stdout.write('listening\n')
        sys.stdout.flush()
        sys.stdin.read()
        received = list(listener.received)
    answers, diagnostics = [], []
    for message in received:
        if message.topic == SKELETONS_TOPIC:
            stamp, skeletons = read_skeletons(message.data)
            found = int(np.isfinite(skeletons.positions).all(axis=-1).sum())
            answers.append((stamp, message.log_time, found))
        else:
            diagnostics.append((message.log_time, _values(message.data)))
    heard = {'answers': answers, 'diagnostics': diagnostics}
    Path(sys.argv[1]).write_text(json.dumps(heard), encoding='utf-8')
    return 0


def _values(data: bytes) -> dict[str, str]:
    array = deserialize_message(data, DiagnosticArray)
    return {each.key: each.value for status in array.status for each in status.values}


if __name__ == '__main__':
    sys.exit(main())
