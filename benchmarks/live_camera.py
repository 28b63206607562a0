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
"""A camera and a segmentation that cost little: a recording, over and over, with new stamps.

`python live_camera.py RECORDING --rate HZ --seconds S`; `live.py` starts it. The messages are
published as they were serialised, but for the stamp, which is the present time. At the end, how
many were sent is written to stdout, as JSON.
"""

import argparse
import itertools
import json
import struct
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import rclpy
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo, Image

from lsc_pose_ros.bags import read_messages
from lsc_pose_ros.bags.topics import DEFAULT_TOPICS

_TOPICS = (DEFAULT_TOPICS.depth, DEFAULT_TOPICS.camera_info, DEFAULT_TOPICS.mask)
_START_TIMEOUT = 60.0
_SETTLING = 0.5  # a subscriber that is found still has to find the publisher

# CDR (OMG, "DDS Interoperability Wire Protocol"): four bytes of encapsulation, and then the
# header's stamp, as the messages of recordings are little endian.
_STAMP_BEGIN, _STAMP_END = 4, 12


class Serialised(NamedTuple):
    """A message without its stamp."""

    before: bytes
    after: bytes

    def stamped(self, stamp: int) -> bytes:
        """Return the message with `stamp`, nanoseconds."""
        return b''.join(
            (self.before, struct.pack('<iI', *divmod(stamp, 1_000_000_000)), self.after)
        )


def main() -> int:
    """Publish for a while; return the exit status."""
    arguments = _arguments()
    topics = _TOPICS[:2] if arguments.without_masks else _TOPICS
    frames = read_frames(arguments.recording, topics)
    rclpy.init(args=[])
    node = Node('camera')
    qos = 10 if arguments.reliable else qos_profile_sensor_data
    publishers = [
        node.create_publisher(kind, topic, qos)
        for kind, topic in zip((Image, CameraInfo, Image), topics, strict=False)
    ]
    return run_camera(node, publishers, lambda: show(frames, publishers, arguments))


def run_camera(
    node: Node, publishers: Sequence[Publisher], show_all: Callable[[], dict[str, Any]]
) -> int:
    """Show images when each of `publishers` has a subscriber; return the exit status.

    What `show_all` returns when all are shown is written to stdout, as JSON.
    """
    if not wait_for_subscribers(publishers):
        sys.stderr.write(f'{Path(sys.argv[0]).stem}: nobody subscribes\n')
        return 1
    sys.stdout.write(json.dumps(show_all()))
    sys.stdout.flush()
    time.sleep(_SETTLING)  # the last images are still on their way
    node.destroy_node()  # type: ignore[no-untyped-call]
    rclpy.try_shutdown()
    return 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('recording', type=Path)
    parser.add_argument('--rate', type=float, required=True, help='images a second')
    parser.add_argument('--seconds', type=float, required=True)
    parser.add_argument('--reliable', action='store_true', help='else as sensors do, best effort')
    parser.add_argument('--without-masks', action='store_true', help='no segmentation')
    return parser.parse_args()


def wait_for_subscribers(publishers: Sequence[Publisher]) -> bool:
    """Wait until each of `publishers` has a subscriber; return whether they have in time."""
    deadline = time.monotonic() + _START_TIMEOUT
    while not all(publisher.get_subscription_count() for publisher in publishers):
        if time.monotonic() > deadline:
            return False
        time.sleep(0.02)
    time.sleep(_SETTLING)
    return True


def show(
    frames: Sequence[Sequence[Serialised]],
    publishers: Sequence[Publisher],
    arguments: argparse.Namespace,
) -> dict[str, float]:
    """Publish `frames` over and over, as `arguments` say; return what was done."""
    first, sent = time.time_ns(), 0
    period = 1.0 / arguments.rate
    due = time.monotonic()
    end = due + arguments.seconds
    for frame in itertools.cycle(frames):
        time.sleep(max(due - time.monotonic(), 0.0))
        if due >= end:
            break
        stamp = time.time_ns()
        for publisher, message in zip(publishers, frame, strict=True):
            publisher.publish(message.stamped(stamp))
        sent += 1
        # A camera does not catch up on what it has missed.
        due = max(due + period, time.monotonic())
    return {'begin': first, 'sent': sent, 'seconds': 1e-9 * (time.time_ns() - first)}


def read_frames(recording: Path, topics: Sequence[str]) -> list[tuple[Serialised, ...]]:
    """Return the messages of each frame, one of each of `topics`."""
    found: defaultdict[str, list[Serialised]] = defaultdict(list)
    for message in read_messages(recording):
        data = bytes(message.data)
        found[message.topic].append(Serialised(data[:_STAMP_BEGIN], data[_STAMP_END:]))
    return list(zip(*(found[topic] for topic in topics), strict=True))


if __name__ == '__main__':
    sys.exit(main())
