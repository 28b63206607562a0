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

"""Helpers of the live tests: an isolated ROS environment, the node, a camera, a subscriber."""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import rclpy
from lifecycle_msgs.srv import ChangeState, GetAvailableTransitions, GetState
from rcl_interfaces.msg import ParameterDescriptor
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.client import Client
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.serialization import deserialize_message
from rclpy.task import Future
from sensor_msgs.msg import CameraInfo, Image, PointCloud2
from visualization_msgs.msg import MarkerArray
from waiting import PATIENCE, wait_until

import lsc_pose_ros
from lsc_pose_ros.bags import RecordingWriter, open_recording
from lsc_pose_ros.bags.serialization.deserialize import read_skeletons
from lsc_pose_ros.bags.serialization.serialize import (
    camera_info_message,
    depth_message,
    mask_message,
)
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.ros.isolation import isolated_environment
from lsc_pose_ros.ros.playback.listener import Listener, open_listener
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

SKELETONS = '/pose_node/skeletons'
MARKERS = '/pose_node/joint_markers'
ANSWERS = {
    SKELETONS: 'sensor_msgs/msg/PointCloud2',
    MARKERS: 'visualization_msgs/msg/MarkerArray',
}
NODE = '/pose_node'

# Seconds from a signal until a program has ended: ten times what is promised.
MOST_UNTIL_ENDED = 20.0

# Seconds after which a service is called again: rmw_fastrtps drops the answer to a client that it
# has not found within 100 ms.
_CALL_AGAIN = 5.0


def generate(folder: Path, **settings: object) -> list[Frame]:
    """Synthetic frames as a recording gives them, depth from whole millimetres."""
    small = {'frames': 30, 'seed': 9, 'width': 160, 'height': 120, 'distance': (1.8, 2.6)}
    small |= {'rate': 30.0, 'clip_length': 30}
    with RecordingWriter(folder / 'generated.mcap') as writer:
        for frame in synthetic_frames(SyntheticSettings(**(small | settings))):
            writer.write_frame(frame)
    return list(open_recording(folder / 'generated.mcap'))


@contextmanager
def default_interrupt() -> Iterator[None]:
    """Start child processes that SIGINT ends, even if this process ignores it.

    A shell lets its background jobs ignore SIGINT, and child processes inherit that.
    """
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


class Program:
    """A Python program in its own process, and the output that it has printed so far."""

    def __init__(self, words: list[str], log: Path, environment: Mapping[str, str]) -> None:
        self._log = log
        self.environment = environment
        self._forgotten = 0
        with log.open('wb') as output, default_interrupt():
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
    def is_running(self) -> bool:
        return self._process.poll() is None

    @property
    def output(self) -> str:
        return self._log.read_text()[self._forgotten :]

    def clear(self) -> None:
        """Hide the output that has been printed so far."""
        self._forgotten = len(self._log.read_text())

    def prints(self, text: str) -> bool:
        """Wait for `text` in the output or the exit; return whether it was printed."""
        wait_until(lambda: text in self.output or self._process.poll() is not None)
        return text in self.output

    def interrupt(self) -> None:
        self._process.send_signal(signal.SIGINT)

    def exit_status(self, number: signal.Signals | None = None) -> int:
        """Send a signal, if one is given, wait for the exit, and return the exit status."""
        if number is not None:
            self._process.send_signal(number)
        return self._process.wait(PATIENCE)

    def kill(self) -> None:
        if self._process.poll() is None:
            self._process.terminate()
            try:
                self._process.wait(30)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()


class Handshake:
    """Proves by a service call that the node under test has found what a node has created.

    A participant announces its publishers in order, and so its subscriptions. A service answers
    only once it has found both endpoints of its client. So the answer to a client that is newer
    than a publisher or a subscription shows that those have been found, too.
    """

    def __init__(self, node: Node, server: str = NODE, *, is_spun: bool = False) -> None:
        """Create the client.

        Args:
            node: the node whose earlier publishers and subscriptions are to be found.
            server: the name of the node under test.
            is_spun: whether another thread spins `node`.
        """
        self._client = node.create_client(GetParameters, f'{server}/get_parameters')
        self._node = node
        self._is_spun = is_spun

    def call(self) -> None:
        """Wait until the service answers."""
        assert self._client.wait_for_service(PATIENCE), self._client.srv_name
        assert wait_until(self._is_answered), self._client.srv_name

    def _is_answered(self) -> bool:
        future = self._client.call_async(GetParameters.Request())
        if self._is_spun:
            return _becomes_done(future)
        executor = SingleThreadedExecutor(context=self._node.context)
        executor.add_node(self._node)
        executor.spin_until_future_complete(future, _CALL_AGAIN)
        executor.remove_node(self._node)
        executor.shutdown()
        return future.done()


def _becomes_done(future: Future) -> bool:
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    return done.wait(_CALL_AGAIN)


class Camera:
    """Publishes frames as a camera driver and a segmentation node do."""

    def __init__(
        self,
        node: Node,
        depth_topic: str = 'depth/image',
        camera_info_topic: str = 'depth/camera_info',
        mask_topic: str = 'mask',
    ) -> None:
        self.depth = node.create_publisher(Image, depth_topic, 10)
        self.camera_info = node.create_publisher(CameraInfo, camera_info_topic, 10)
        self.mask = node.create_publisher(Image, mask_topic, 10)
        self._handshake = Handshake(node)

    def wait_for_node(self, *, mask: bool = True) -> None:
        """Wait until the node receives all that is sent."""
        publishers = (self.depth, self.camera_info, *([self.mask] if mask else []))
        assert wait_until(lambda: all(each.get_subscription_count() for each in publishers))
        self._handshake.call()

    def wait_until_taken(self) -> None:
        """Wait until the node has taken one message of each topic from its queue.

        The request comes after the messages, and the node's executor takes a message of each
        subscription before it answers a service.
        """
        self._handshake.call()

    @property
    def is_unmatched(self) -> bool:
        publishers = (self.depth, self.camera_info, self.mask)
        return not any(each.get_subscription_count() for each in publishers)

    def send(self, frame: Frame) -> None:
        self.send_depth(frame)
        self.send_mask(frame)

    def send_depth(self, frame: Frame) -> None:
        head = (frame.stamp, frame.frame_id)
        self.depth.publish(depth_message(*head, frame.depth))
        self.camera_info.publish(camera_info_message(*head, frame.camera, frame.depth.shape))

    def send_mask(self, frame: Frame) -> None:
        self.mask.publish(mask_message(frame.stamp, frame.frame_id, frame.labels))


class PublishedEstimates:
    """Collects the skeletons and markers that the node publishes."""

    def __init__(self, listener: Listener) -> None:
        self._listener = listener

    def clear(self) -> None:
        self._listener.received.clear()

    def wait_for_node(self) -> None:
        assert self._listener.wait_for_publishers(PATIENCE)
        Handshake(self._listener.node, is_spun=True).call()

    @property
    def is_unmatched(self) -> bool:
        return not self._listener.has_publishers

    def of(self, topic: str) -> list[bytes]:
        return [each.data for each in list(self._listener.received) if each.topic == topic]

    def wait_for(self, count: int) -> bool:
        """Wait for `count` messages of each topic; return whether they have come."""
        return wait_until(lambda: min(len(self.of(SKELETONS)), len(self.of(MARKERS))) >= count)

    @property
    def clouds(self) -> list[PointCloud2]:
        return [deserialize_message(d, PointCloud2) for d in self.of(SKELETONS)]

    @property
    def markers(self) -> list[MarkerArray]:
        return [deserialize_message(d, MarkerArray) for d in self.of(MARKERS)]

    @property
    def skeletons(self) -> dict[int, Skeletons]:
        """The skeletons by their stamp."""
        return dict(read_skeletons(data) for data in self.of(SKELETONS))


def ask(
    camera: Camera, estimates: PublishedEstimates, node: Program, frames: list[Frame]
) -> list[Skeletons]:
    """Send frames one by one; return the answers."""
    camera.wait_for_node()
    estimates.wait_for_node()
    for count, frame in enumerate(frames, 1):
        camera.send(frame)
        assert estimates.wait_for(count), node.output
    found = estimates.skeletons
    return [found[frame.stamp] for frame in frames]


class NodeServices:
    """Calls the node's services from another process, as the ros2 command line does."""

    def __init__(self, node: Node, name: str = NODE) -> None:
        self._node = node
        self._name = name
        self._executor = SingleThreadedExecutor(context=node.context)
        self._clients: dict[str, Client] = {}

    @property
    def state(self) -> str:
        return self._call(GetState, 'get_state', GetState.Request()).current_state.label

    def change(self, transition: str) -> bool:
        """Request a transition, as `ros2 lifecycle set` does; return whether it succeeded."""
        request = ChangeState.Request()
        request.transition.label = transition
        return self._call(ChangeState, 'change_state', request).success

    def change_by_number(self, number: int) -> bool:
        """Request a transition, as the lifecycle manager of nav2 does."""
        request = ChangeState.Request()
        request.transition.id = number
        return self._call(ChangeState, 'change_state', request).success

    def ask_to_change(self, transition: str) -> None:
        """Request a transition without waiting for it."""
        request = ChangeState.Request()
        request.transition.label = transition
        self._client(ChangeState, 'change_state').call_async(request)

    @property
    def transitions(self) -> set[str]:
        answer = self._call(
            GetAvailableTransitions,
            'get_available_transitions',
            GetAvailableTransitions.Request(),
        )
        return {each.transition.label for each in answer.available_transitions}

    def set(self, name: str, value: object) -> str:
        """Set a parameter; return the reason of a refusal, or an empty string."""
        message = Parameter(name, value=value).to_parameter_msg()
        request = SetParameters.Request(parameters=[message])
        (result,) = self._call(SetParameters, 'set_parameters', request).results
        assert result.successful == (not result.reason)
        return result.reason

    def get(self, name: str) -> object:
        """Return a parameter's value, None if there is no such parameter."""
        request = GetParameters.Request(names=[name])
        values = self._call(GetParameters, 'get_parameters', request).values
        return parameter_value_to_python(values[0]) if values else None

    @property
    def parameter_names(self) -> frozenset[str]:
        request = ListParameters.Request()
        return frozenset(self._call(ListParameters, 'list_parameters', request).result.names)

    def describe(self, *names: str) -> list[ParameterDescriptor]:
        request = DescribeParameters.Request(names=names)
        return self._call(DescribeParameters, 'describe_parameters', request).descriptors

    def _call(self, kind: type, name: str, request: object) -> Any:
        future = self._client(kind, name).call_async(request)
        self._executor.add_node(self._node)
        self._executor.spin_until_future_complete(future, PATIENCE)
        self._executor.remove_node(self._node)
        assert future.done(), name
        return future.result()

    def spin(self, seconds: float) -> None:
        """Let the probe receive messages for some seconds."""
        self._executor.add_node(self._node)
        self._executor.spin_once(seconds)
        self._executor.remove_node(self._node)

    def _client(self, kind: type, name: str) -> Client:
        client = self._clients.get(name)
        if client is None:
            client = self._node.create_client(kind, f'{self._name}/{name}')
            self._clients[name] = client
            Handshake(self._node, self._name).call()
        assert client.wait_for_service(PATIENCE), name
        return client


class NodeUnderTest(NamedTuple):
    """A node, and the camera, subscriber and services that are connected to it."""

    node: Program
    camera: Camera
    estimates: PublishedEstimates
    services: NodeServices


@pytest.fixture(scope='session', autouse=True)
def ros_environment() -> dict[str, str]:
    """The isolated environment of all ROS programs of this test run, this process included."""
    environment = isolated_environment()
    os.environ.update(environment)
    # The programs import the same package as this process.
    paths = [str(Path(lsc_pose_ros.__file__).parents[1]), os.environ.get('PYTHONPATH', '')]
    return environment | {'PYTHONPATH': os.pathsep.join(filter(None, paths))}


@pytest.fixture
def probe() -> Iterator[Node]:
    """A node in the test's own process."""
    with _probe() as node:
        yield node


@contextmanager
def _probe() -> Iterator[Node]:
    context = Context()
    rclpy.init(args=[], context=context)
    node = Node('probe', context=context, use_global_arguments=False)
    yield node
    node.destroy_node()
    rclpy.try_shutdown(context=context)


@pytest.fixture
def services(probe: Node) -> NodeServices:
    return NodeServices(probe)


@pytest.fixture
def camera(probe: Node) -> Camera:
    return Camera(probe)


@pytest.fixture
def estimates() -> Iterator[PublishedEstimates]:
    with open_listener(ANSWERS) as listener:
        yield PublishedEstimates(listener)


@pytest.fixture
def start_program(
    ros_environment: dict[str, str], tmp_path: Path
) -> Iterator[Callable[..., Program]]:
    """Start Python programs: `start_program('-m', 'module', ...)`; they end with the test."""
    programs: list[Program] = []

    def begin(*words: object, **environment: str) -> Program:
        log = tmp_path / f'program{len(programs)}.log'
        programs.append(Program([str(word) for word in words], log, ros_environment | environment))
        return programs[-1]

    yield begin
    for program in programs:
        program.kill()


@pytest.fixture(scope='module')
def shared_node(
    ros_environment: dict[str, str],
    small_model_file: Path,
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[NodeUnderTest]:
    """An inactive node, shared by the tests of a module.

    Discovery takes ROS programs seconds. The node has its own domain, so that it does not
    interfere with the module's other tests. A test must not end the node.
    """
    log = tmp_path_factory.mktemp('shared') / 'node.log'
    with own_domain(ros_environment, log, small_model_file) as (program, node, listener):
        active_node = NodeUnderTest(
            program, Camera(node), PublishedEstimates(listener), NodeServices(node)
        )
        assert active_node.services.change('configure'), program.output
        yield active_node


@contextmanager
def own_domain(
    ros_environment: dict[str, str], log: Path, model: Path
) -> Iterator[tuple[Program, Node, Listener]]:
    """Start an unconfigured node, a probe and a listener in a domain of their own."""
    with _probe():  # occupies the domain of the other tests
        environment = ros_environment | {'ROS_DOMAIN_ID': isolated_environment()['ROS_DOMAIN_ID']}
    assert environment['ROS_DOMAIN_ID'] != ros_environment['ROS_DOMAIN_ID']
    # Each frame alone, unless a test is about time.
    values = {'model': model, 'autostart': False, 'temporal': False}
    words = [word for name, value in values.items() for word in ('-p', f'{name}:={value}')]
    with ExitStack() as stack:
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv('ROS_DOMAIN_ID', environment['ROS_DOMAIN_ID'])
            node = stack.enter_context(_probe())
            listener = stack.enter_context(open_listener(ANSWERS))
        program = Program(
            ['-m', 'lsc_pose_ros.ros.node.main', '--ros-args', *words], log, environment
        )
        stack.callback(program.kill)
        yield program, node, listener


@pytest.fixture
def active_node(shared_node: NodeUnderTest) -> Iterator[NodeUnderTest]:
    """The shared node, activated for this test, with cleared output."""
    node, camera, estimates, services = shared_node
    estimates.clear()
    node.clear()
    assert services.change('activate'), node.output
    assert node.prints('ready'), node.output
    camera.wait_for_node()
    estimates.wait_for_node()
    yield shared_node
    assert services.change('deactivate'), node.output
    assert wait_until(lambda: camera.is_unmatched and estimates.is_unmatched)


@pytest.fixture
def spawn_node(
    start_program: Callable[..., Program], small_model_file: Path
) -> Callable[..., Program]:
    """Start the node with parameters, without waiting for it."""

    def begin(**parameters: object) -> Program:
        # Each frame alone, unless a test is about time.
        values = {'model': small_model_file, 'temporal': False, **parameters}
        words = [word for name, value in values.items() for word in ('-p', f'{name}:={value}')]
        return start_program('-m', 'lsc_pose_ros.ros.node.main', '--ros-args', *words)

    return begin


@pytest.fixture
def start_node(spawn_node: Callable[..., Program]) -> Callable[..., Program]:
    """Start the node with parameters, and wait until it is ready."""

    def begin(**parameters: object) -> Program:
        node = spawn_node(**parameters)
        assert node.prints('ready'), node.output
        return node

    return begin
