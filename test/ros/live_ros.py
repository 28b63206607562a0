"""What the tests of the live node share: a corner of the network, the node, a camera, an ear."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import CameraInfo, Image, PointCloud2
from visualization_msgs.msg import MarkerArray

import lsc_pose_ros
from lsc_pose_ros.core.frame import Frame
from lsc_pose_ros.core.skeletons import Skeletons
from lsc_pose_ros.data.recording.messages import read_skeletons
from lsc_pose_ros.data.recording.serialise import (
    camera_info_message,
    depth_message,
    mask_message,
)
from lsc_pose_ros.ros.isolation import isolated_environment
from lsc_pose_ros.ros.listener import Listener, open_listener

SKELETONS = '/pose_node/skeletons'
MARKERS = '/pose_node/joint_markers'
ANSWERS = {
    SKELETONS: 'sensor_msgs/msg/PointCloud2',
    MARKERS: 'visualization_msgs/msg/MarkerArray',
}
TIMEOUT = 60.0


def wait_until(true: Callable[[], object], seconds: float = TIMEOUT) -> bool:
    """Wait until `true()`; return whether it was within `seconds`."""
    deadline = time.monotonic() + seconds
    while not true():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.02)
    return True


class Program:
    """A program of ours in a process of its own, and what it has printed so far."""

    def __init__(self, words: list[str], log: Path, environment: Mapping[str, str]) -> None:
        self._log = log
        with log.open('wb') as output:
            self._process = subprocess.Popen(
                [sys.executable, *words],
                stdout=output,
                stderr=subprocess.STDOUT,
                env=os.environ | environment,
                start_new_session=True,
            )

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def output(self) -> str:
        return self._log.read_text()

    def says(self, text: str, seconds: float = TIMEOUT) -> bool:
        """Wait for `text` in the output; return whether it came."""
        return wait_until(
            lambda: text in self.output or self._process.poll() is not None, seconds
        ) and (text in self.output)

    def ends(self, number: signal.Signals | None = None, seconds: float = TIMEOUT) -> int:
        """Send a signal, if one is given, and return the status with which the program ends."""
        if number is not None:
            self._process.send_signal(number)
        return self._process.wait(seconds)

    def kill(self) -> None:
        if self._process.poll() is None:
            self._process.terminate()
            try:
                self._process.wait(5)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()


class Camera:
    """Publishes frames as a camera driver and a segmentation do."""

    def __init__(self, node: Node, depth_topic: str = 'depth/image') -> None:
        self.depth = node.create_publisher(Image, depth_topic, 10)
        self.camera_info = node.create_publisher(CameraInfo, 'depth/camera_info', 10)
        self.mask = node.create_publisher(Image, 'mask', 10)

    def wait_for_node(self) -> None:
        publishers = (self.depth, self.camera_info, self.mask)
        assert wait_until(lambda: all(each.get_subscription_count() for each in publishers))
        time.sleep(0.3)

    def send(self, frame: Frame) -> None:
        self.send_depth(frame)
        self.send_mask(frame)

    def send_depth(self, frame: Frame) -> None:
        head = (frame.stamp, frame.frame_id)
        self.depth.publish(depth_message(*head, frame.depth))
        self.camera_info.publish(camera_info_message(*head, frame.camera, frame.depth.shape))

    def send_mask(self, frame: Frame) -> None:
        self.mask.publish(mask_message(frame.stamp, frame.frame_id, frame.labels))


class Ear:
    """What the node has answered."""

    def __init__(self, listener: Listener) -> None:
        self._listener = listener

    def forget(self) -> None:
        self._listener.received.clear()

    def wait_for_node(self) -> None:
        assert self._listener.wait_for_publishers(TIMEOUT)

    def of(self, topic: str) -> list[bytes]:
        return [each.data for each in list(self._listener.received) if each.topic == topic]

    def wait_for(self, answers: int, seconds: float = TIMEOUT) -> bool:
        return wait_until(
            lambda: min(len(self.of(SKELETONS)), len(self.of(MARKERS))) >= answers, seconds
        )

    @property
    def clouds(self) -> list[PointCloud2]:
        return [deserialize_message(d, PointCloud2) for d in self.of(SKELETONS)]

    @property
    def markers(self) -> list[MarkerArray]:
        return [deserialize_message(d, MarkerArray) for d in self.of(MARKERS)]

    @property
    def skeletons(self) -> dict[int, Skeletons]:
        """The answers by their stamp."""
        return dict(read_skeletons(data) for data in self.of(SKELETONS))


@pytest.fixture(scope='session', autouse=True)
def corner() -> dict[str, str]:
    """The environment of this test run's ROS programs, this one's too."""
    environment = isolated_environment()
    os.environ.update(environment)
    # Our programs find the package where this one has found it.
    paths = [str(Path(lsc_pose_ros.__file__).parents[1]), os.environ.get('PYTHONPATH', '')]
    return environment | {'PYTHONPATH': os.pathsep.join(filter(None, paths))}


@pytest.fixture
def probe() -> Iterator[Node]:
    """A node of the test's own."""
    context = Context()
    rclpy.init(args=[], context=context)
    node = Node('probe', context=context, use_global_arguments=False)
    yield node
    node.destroy_node()
    rclpy.try_shutdown(context=context)


@pytest.fixture
def camera(probe: Node) -> Camera:
    return Camera(probe)


@pytest.fixture
def ear() -> Iterator[Ear]:
    with open_listener(ANSWERS) as listener:
        yield Ear(listener)


@pytest.fixture
def start(corner: dict[str, str], tmp_path: Path) -> Iterator[Callable[..., Program]]:
    """Start Python programs: `start('-m', 'module', ...)`; they end with the test."""
    programs: list[Program] = []

    def begin(*words: object, **environment: str) -> Program:
        log = tmp_path / f'program{len(programs)}.log'
        programs.append(Program([str(word) for word in words], log, corner | environment))
        return programs[-1]

    yield begin
    for program in programs:
        program.kill()


@pytest.fixture
def start_node(start: Callable[..., Program], small_model_file: Path) -> Callable[..., Program]:
    """Start the node with parameters, and wait until it is ready."""

    def begin(**parameters: object) -> Program:
        values = {'model': small_model_file, **parameters}
        words = [word for name, value in values.items() for word in ('-p', f'{name}:={value}')]
        node = start('-m', 'lsc_pose_ros.ros.main', '--ros-args', *words)
        assert node.says('ready'), node.output
        return node

    return begin
