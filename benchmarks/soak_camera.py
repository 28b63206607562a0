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
"""A camera and a segmentation with faults, for the soak test of the live node.

`python benchmarks/soak_camera.py RECORDING --rate HZ --seconds S --seed N --faults SHARE`
publishes the frames of a recording over and over. People come and go; a share of the frames has
one of the faults of FAULTS. At the end, the stamps of the frames without faults and the number of
those with each fault are written to stdout, as JSON.
"""

import argparse
import array
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from builtin_interfaces.msg import Time
from live_camera import run_camera
from rclpy.node import Node
from sensor_msgs.msg import CameraInfo, Image

from lsc_pose_ros.bags import open_recording
from lsc_pose_ros.data_types.frame import NO_BODY, Frame

_NANOSECONDS = 1_000_000_000

# How long people are in view, and how long nobody is, seconds.
_PRESENCE, _ABSENCE = 8.0, 3.0


class Messages:
    """The messages of a frame, which a fault may change; a fault removes one by None."""

    def __init__(self, frame: Frame, stamp: int, *, empty: bool) -> None:
        """Make the messages without a fault; `empty` if nobody is in view."""
        self.depth: Any = _image('32FC1', frame.depth.astype('<f4'))
        labels = np.where((frame.labels == NO_BODY) | empty, 0, frame.labels)
        self.mask: Any = _image('16UC1', labels.astype('<u2'))
        height, width = frame.depth.shape
        self.info: Any = CameraInfo(height=height, width=width)
        fx, fy, cx, cy = frame.camera[:4]
        self.info.k = [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]
        for each in (self.depth, self.mask, self.info):
            each.header.frame_id = frame.frame_id
        self.set_stamp(stamp)

    def set_stamp(self, stamp: int) -> None:
        """Give all messages the stamp, nanoseconds."""
        sec, nanosec = divmod(stamp, _NANOSECONDS)
        for each in (self.depth, self.mask, self.info):
            each.header.stamp = Time(sec=sec, nanosec=nanosec)


def _image(encoding: str, pixels: np.ndarray) -> Image:
    message = Image(encoding=encoding, height=pixels.shape[0], width=pixels.shape[1])
    message.step = pixels.shape[1] * pixels.dtype.itemsize
    message.data = array.array('B', pixels.tobytes())
    return message


def _fill(message: Image, pixels: np.ndarray) -> None:
    message.data = array.array('B', pixels.tobytes())


def _shape(message: Image) -> tuple[int, int]:
    return message.height, message.width


def _absurd_depth(messages: Messages, random: np.random.Generator) -> None:
    values = [0.0, np.nan, np.inf, -np.inf, -1.0, float(np.finfo(np.float32).max), 1e-40]
    value = values[random.integers(len(values))]
    _fill(messages.depth, np.full(_shape(messages.depth), value, '<f4'))


def _random_depth(messages: Messages, random: np.random.Generator) -> None:
    messages.depth.data = array.array('B', random.bytes(len(messages.depth.data)))


def _noise(messages: Messages, random: np.random.Generator) -> None:
    _fill(messages.depth, random.uniform(0.1, 20, _shape(messages.depth)).astype('<f4'))


def _noisy_mask(messages: Messages, random: np.random.Generator) -> None:
    kinds = (3, 300, 5000)[random.integers(3)]
    _fill(messages.mask, random.integers(0, kinds, _shape(messages.mask)).astype('<u2'))


def _full_mask(messages: Messages, _: np.random.Generator) -> None:
    _fill(messages.mask, np.ones(_shape(messages.mask), '<u2'))


def _lying_step(messages: Messages, random: np.random.Generator) -> None:
    broken = (messages.depth, messages.mask)[random.integers(2)]
    broken.step = int(random.integers(0, 2**32))


def _no_pixels(messages: Messages, _: np.random.Generator) -> None:
    for each in (messages.depth, messages.mask):
        each.height = each.width = each.step = 0
        each.data = array.array('B')


def _other_resolution(messages: Messages, _: np.random.Generator) -> None:
    for each, kind in ((messages.depth, '<f4'), (messages.mask, '<u2')):
        pixels = np.frombuffer(each.data, kind).reshape(_shape(each))[::2, ::2]
        each.height, each.width = pixels.shape
        each.step = pixels.shape[1] * pixels.itemsize
        _fill(each, np.ascontiguousarray(pixels))
    messages.info.height, messages.info.width = _shape(messages.depth)
    messages.info.k[:6] = messages.info.k[:6] / 2


def _absurd_camera(messages: Messages, random: np.random.Generator) -> None:
    messages.info.k = (
        np.array([0.0, np.nan, 1e20, 1e-17])[random.integers(4)] * np.ones(9)
    ).tolist()


def _new_camera(messages: Messages, random: np.random.Generator) -> None:
    messages.info.k[:6] = messages.info.k[:6] * random.uniform(0.8, 1.2)


def _long_texts(messages: Messages, random: np.random.Generator) -> None:
    broken = (messages.depth, messages.mask)[random.integers(2)]
    broken.encoding = 100_000 * 'x' + str(random.integers(1000))


def _no_mask(messages: Messages, _: np.random.Generator) -> None:
    messages.mask = None


def _no_info(messages: Messages, _: np.random.Generator) -> None:
    messages.info = None


def _old_stamp(messages: Messages, random: np.random.Generator) -> None:
    back = random.integers(1, 20 * _NANOSECONDS)
    stamp = messages.depth.header.stamp
    messages.set_stamp(int(stamp.sec * _NANOSECONDS + stamp.nanosec - back))


def _zero_stamp(messages: Messages, _: np.random.Generator) -> None:
    messages.set_stamp(0)


def _future_stamp(messages: Messages, _: np.random.Generator) -> None:
    stamp = messages.depth.header.stamp
    messages.set_stamp((stamp.sec + 3600) * _NANOSECONDS)


FAULTS: dict[str, Callable[[Messages, np.random.Generator], None]] = {
    each.__name__.strip('_').replace('_', ' '): each
    for each in (
        _absurd_depth, _random_depth, _noise, _noisy_mask, _full_mask, _lying_step, _no_pixels,
        _other_resolution, _absurd_camera, _new_camera, _long_texts, _no_mask, _no_info,
        _old_stamp, _zero_stamp, _future_stamp,
    )
}  # fmt: skip
"""The faults by their names."""


def main() -> int:
    """Publish for a while; return the exit status."""
    arguments = _arguments()
    frames = list(open_recording(arguments.recording))
    rclpy.init(args=[])
    node = Node('camera')
    publishers = [
        node.create_publisher(kind, topic, 10)
        for kind, topic in (
            (Image, 'depth/image'),
            (CameraInfo, 'depth/camera_info'),
            (Image, 'mask'),
        )
    ]
    return run_camera(node, publishers, lambda: _show(frames, publishers, arguments))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('recording', type=Path)
    parser.add_argument('--rate', type=float, required=True, help='images a second')
    parser.add_argument('--seconds', type=float, required=True)
    parser.add_argument('--seed', type=int, required=True)
    parser.add_argument('--faults', type=float, required=True, help='share of frames with faults')
    return parser.parse_args()


def _show(
    frames: list[Frame], publishers: list[Any], arguments: argparse.Namespace
) -> dict[str, Any]:
    random = np.random.default_rng(arguments.seed)
    names = list(FAULTS)
    counts: Counter[str] = Counter()
    good = []
    begin = time.monotonic()
    number, due = 0, begin
    while due < begin + arguments.seconds:
        time.sleep(max(due - time.monotonic(), 0.0))
        stamp = time.time_ns()
        empty = (due - begin) % (_PRESENCE + _ABSENCE) > _PRESENCE
        messages = Messages(frames[number % len(frames)], stamp, empty=empty)
        if random.random() < arguments.faults:
            name = names[random.integers(len(names))]
            FAULTS[name](messages, random)
            counts[name] += 1
        else:
            good.append(stamp)
        parts = (messages.depth, messages.info, messages.mask)
        for publisher, message in zip(publishers, parts, strict=True):
            if message is not None:
                publisher.publish(message)
        number += 1
        due = max(due + 1.0 / arguments.rate, time.monotonic())
    return {'sent': number, 'good': good, 'faults': counts, 'seconds': time.monotonic() - begin}


if __name__ == '__main__':
    sys.exit(main())
