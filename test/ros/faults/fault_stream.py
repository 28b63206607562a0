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

"""A camera and a segmenter with faults, and what the node promises whatever they send."""

import array
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray
from live_ros import (
    SKELETONS,
    Handshake,
    NodeServices,
    Program,
    PublishedEstimates,
    generate,
    own_domain,
)
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import CameraInfo, Image, PointCloud2
from std_msgs.msg import Header
from waiting import becomes, wait_until

from lsc_pose_ros.bags.serialization.deserialize import read_skeletons
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.messages.stamps import nanoseconds
from lsc_pose_ros.ros.playback.listener import Listener

if TYPE_CHECKING:
    from rclpy.publisher import Publisher

FRAME_TIME = 33_333_333
NANOSECONDS = 10**9
MEGABYTE = 'x' * 1_000_000

# No joint is farther outside of the view, metres: an arm that the image cuts off.
MOST_OUTSIDE = 2.0
FARTHEST = 22.0

# Seconds after which the next frame is sent to a node that may have dropped the one before.
SEND_AGAIN = 0.5


class Sent(NamedTuple):
    """What is known of a depth image that the node may answer."""

    header: Header
    camera: Intrinsics
    shape: tuple[int, int]


def time_of(stamp: int) -> Time:
    seconds, nanoseconds = divmod(stamp, NANOSECONDS)
    return Time(sec=seconds, nanosec=nanoseconds)


def image(header: Header, encoding: str, pixels: np.ndarray, **lies: int) -> Image:
    """Return an image message; `lies` replace what its other fields would say."""
    height, width = pixels.shape
    message = Image(header=header, encoding=encoding, height=height, width=width)
    message.step = width * pixels.dtype.itemsize
    message.is_bigendian = 0
    message.data = array.array('B', np.ascontiguousarray(pixels).tobytes())
    for name, value in lies.items():
        setattr(message, name, value)
    return message


def camera_info(header: Header, camera: Intrinsics, shape: tuple[int, int]) -> CameraInfo:
    message = CameraInfo(header=header, height=shape[0], width=shape[1])
    message.k = [camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0]
    return message


def mask_of(labels: np.ndarray) -> np.ndarray:
    return np.where(labels == NO_BODY, 0, labels).astype(np.uint16)


class FaultStream:
    """The streams to one node, with stamps that go on from test to test, and its answers.

    Attributes:
        program: the node's process.
        node: publishes the streams.
        services: the node's.
        frame: what the streams show when they are as they should be; one person, body 1.
    """

    def __init__(
        self, program: Program, node: Node, listener: Listener, frame: Frame, folder: Path
    ) -> None:
        self.program = program
        self._folder = folder
        self.node = node
        self.services = NodeServices(node)
        self.frame = frame
        self.estimates = PublishedEstimates(listener)
        self.stamp = 1_800_000_000 * NANOSECONDS
        self.depth = node.create_publisher(Image, 'depth/image', 10)
        self.info = node.create_publisher(CameraInfo, 'depth/camera_info', 10)
        self.mask: Publisher | None = None
        self.restart_segmenter()
        self._status: DiagnosticArray | None = None
        node.create_subscription(DiagnosticArray, '/diagnostics', self._receive, 10)
        self._handshake = Handshake(node)
        self._sent: dict[int, Sent] = {}
        self._answers: list[tuple[PointCloud2, Skeletons]] = []

    def restart_segmenter(self) -> None:
        self.mask = self.node.create_publisher(Image, 'mask', 10)

    def stop_segmenter(self) -> None:
        self.node.destroy_publisher(self.mask)
        self.mask = None

    def connect(self) -> None:
        """Wait until the node receives what is sent, and its answers arrive."""
        publishers = [each for each in (self.depth, self.info, self.mask) if each is not None]
        assert wait_until(lambda: all(each.get_subscription_count() for each in publishers))
        self._handshake.call()
        self.estimates.wait_for_node()

    def taken(self) -> None:
        """Wait until the node has taken what was sent."""
        self._handshake.call()

    def next_header(self, step: int = FRAME_TIME, frame_id: str = 'camera') -> Header:
        self.stamp += step
        return Header(stamp=time_of(self.stamp), frame_id=frame_id)

    def good(self, **changes: object) -> Frame:
        """Return the good frame with the next stamp, and with changes."""
        return self.frame._replace(stamp=self.stamp + FRAME_TIME)._replace(**changes)

    def send(self, frame: Frame, *, masked: bool = True) -> Header:
        """Send a frame with its own stamp; return the header of its depth image."""
        self.stamp = frame.stamp
        header = Header(stamp=time_of(frame.stamp), frame_id=frame.frame_id)
        depth = image(header, '32FC1', frame.depth.astype('<f4'))
        mask = image(header, '16UC1', mask_of(frame.labels)) if masked else None
        self.publish(depth, mask, camera_info(header, frame.camera, frame.depth.shape))
        return header

    def publish(self, depth: Image, mask: Image | None, info: CameraInfo | None) -> None:
        """Publish messages as they are; the node may answer the depth image."""
        camera = self.frame.camera
        if info is not None:
            camera = Intrinsics(info.k[0], info.k[4], info.k[2], info.k[5])
            self.info.publish(info)
        self.expect(depth.header, camera, (depth.height, depth.width))
        self.depth.publish(depth)
        if mask is not None and self.mask is not None:
            self.mask.publish(mask)

    def expect(self, header: Header, camera: Intrinsics, shape: tuple[int, int]) -> None:
        """Note that a depth image is sent that the node may answer."""
        self._sent[nanoseconds(header.stamp)] = Sent(header, camera, shape)

    def configure(self, **parameters: object) -> None:
        """Clean the node up, and activate it with other parameters."""
        for word in ('deactivate', 'cleanup'):
            assert self.services.change(word), self.program.output[-5000:]
        for name, value in parameters.items():
            assert not self.services.set(name, value)
        for word in ('configure', 'activate'):
            assert self.services.change(word), self.program.output[-5000:]

    def reactivate(self) -> None:
        """Let the node forget what it has counted and told."""
        for word in ('deactivate', 'activate'):
            assert self.services.change(word), self.program.output[-5000:]
        self.connect()

    def answer(self, header: Header) -> Skeletons | None:
        """Return the answer to a depth image, None if there is none yet."""
        self._read_answers()
        for cloud, skeletons in self._answers:
            if cloud.header == header:
                return skeletons
        return None

    def count_answers(self, header: Header) -> int:
        """Return how many answers a depth image has got: one from each node."""
        self._read_answers()
        return sum(cloud.header == header for cloud, _ in self._answers)

    def _read_answers(self) -> None:
        for data in self.estimates.of(SKELETONS)[len(self._answers) :]:
            answer = deserialize_message(data, PointCloud2), read_skeletons(data)[1]
            self._answers.append(answer)

    @property
    def answered(self) -> list[int]:
        """The stamps of the answers so far, nanoseconds."""
        self._read_answers()
        return [nanoseconds(cloud.header.stamp) for cloud, _ in self._answers]

    def ask(self, frame: Frame) -> Skeletons:
        """Send a frame, and return its answer."""
        return self.wait_for_answer(self.send(frame))

    def wait_for_answer(self, header: Header) -> Skeletons:
        assert wait_until(lambda: self.answer(header) is not None), self.program.output[-5000:]
        found = self.answer(header)
        assert found is not None
        return found

    @contextmanager
    def another_node(self, model: Path) -> Iterator[Program]:
        """Start another node that has the same name in the same domain."""
        words = ['-m', 'lsc_pose_ros.ros.node.main', '--ros-args', '-p', f'model:={model}']
        program = Program(words, self._folder / 'other.log', self.program.environment)
        try:
            yield program
        finally:
            program.kill()

    def diagnosed(self, name: str) -> str:
        """Return a value of the newest diagnostics, after the next ones have come."""
        self._status = None
        assert wait_until(self._has_status)
        assert self._status is not None
        values = {each.key: each.value for each in self._status.status[0].values}
        return values[name]

    def recovers(self) -> None:
        """Check that good frames are answered again, and that all answers keep the promise."""
        headers: list[Header] = []

        def is_answered() -> bool:
            headers.append(self.send(self.good()))
            return becomes(lambda: self.answer(headers[-1]) is not None, SEND_AGAIN)

        assert wait_until(is_answered), self.program.output[-5000:]
        found = self.answer(headers[-1])
        assert found is not None
        assert found.bodies.tolist() == [1]
        assert np.isfinite(found.positions).any()
        self.check_answers()

    def check_answers(self) -> None:
        """Check the promise: the node runs, and whatever it has published makes sense."""
        assert self.program.is_running, self.program.output[-5000:]
        assert 'Traceback' not in self.program.output, self.program.output[-5000:]
        self._read_answers()
        for cloud, skeletons in self._answers:
            self._check(cloud, skeletons)
        for message in self.estimates.markers:
            for marker in message.markers:
                assert all(math.isfinite(p.x + p.y + p.z) for p in marker.points)

    def _check(self, cloud: PointCloud2, skeletons: Skeletons) -> None:
        sent = self._sent[nanoseconds(cloud.header.stamp)]
        assert cloud.header.frame_id == sent.header.frame_id
        confidence, positions = skeletons.confidence, skeletons.positions
        assert ((confidence >= 0) & (confidence <= 1)).all()
        known = np.isfinite(positions)
        assert (known.all(axis=-1) == known.any(axis=-1)).all()
        assert (confidence[~known.all(axis=-1)] == 0).all()
        x, y, z = positions[known.all(axis=-1)].astype(np.float64).T
        assert ((z > 0) & (z < FARTHEST)).all()
        camera, (height, width) = sent.camera, sent.shape
        for across, focal, centre, size in (
            (x, camera.fx, camera.cx, width),
            (y, camera.fy, camera.cy, height),
        ):
            assert (across >= -centre / focal * z - MOST_OUTSIDE).all()
            assert (across <= (size - centre) / focal * z + MOST_OUTSIDE).all()

    def _has_status(self) -> bool:
        self.services.spin(0.1)
        return self._status is not None

    def _receive(self, message: DiagnosticArray) -> None:
        self._status = message

    def begin(self) -> None:
        """Forget what was said and published before."""
        self.program.clear()
        self.estimates.clear()
        self._answers.clear()
        self._sent.clear()


@pytest.fixture(scope='package')
def fault_stream(
    ros_environment: dict[str, str],
    small_model_file: Path,
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[FaultStream]:
    """The node of all tests of faults, active, with its streams."""
    folder = tmp_path_factory.mktemp('faults')
    (frame,) = generate(folder, frames=1)
    with own_domain(ros_environment, folder / 'node.log', small_model_file) as (
        program,
        node,
        listener,
    ):
        stream = FaultStream(program, node, listener, frame, folder)
        assert stream.services.change('configure'), program.output
        assert stream.services.change('activate'), program.output
        stream.connect()
        stream.recovers()
        yield stream
        assert program.is_running
        assert stream.services.change('deactivate'), program.output


@pytest.fixture
def stream(fault_stream: FaultStream) -> Iterator[FaultStream]:
    """The streams as they should be; after the test, good frames must be answered again."""
    fault_stream.begin()
    yield fault_stream
    if fault_stream.mask is None:
        fault_stream.restart_segmenter()
        fault_stream.connect()
    fault_stream.recovers()
