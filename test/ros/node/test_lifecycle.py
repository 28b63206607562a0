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

"""The node's states: each transition, asked for from another process; the end in each."""

import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from lifecycle_msgs.msg import Transition
from live_ros import (
    MOST_UNTIL_ENDED,
    Camera,
    NodeServices,
    Program,
    PublishedEstimates,
    generate,
)
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from waiting import stays, wait_until

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.model_io.model_file import load_model

WAY_TO = {
    'unconfigured': (),
    'inactive': ('configure',),
    'active': ('configure', 'activate'),
    'finalized': ('shutdown',),
}

# The node with a preparation that breaks down the first time.
BROKEN_ONCE = """
import sys

from lsc_pose_ros.ros.node import node
from lsc_pose_ros.ros.node.main import main

def break_down(*arguments):
    node.prepare_resources = prepare
    raise ZeroDivisionError('once')

prepare, node.prepare_resources = node.prepare_resources, break_down
sys.exit(main())
"""

# A node that works and is cleaned up, and whether its model is gone then. Reference cycles would
# keep it, because nothing collects them here.
RELEASED = """
import gc
import sys
import weakref

import rclpy
from rclpy.executors import SingleThreadedExecutor

from lsc_pose_ros.ros.node.node import PoseNode

rclpy.init(args=sys.argv)
gc.disable()
node = PoseNode()
executor = SingleThreadedExecutor()
executor.add_node(node)
node.trigger_configure()
node.trigger_activate()
for _ in range(5):  # calls the timers
    executor.spin_once(timeout_sec=1.0)
model = weakref.ref(node._resources.model.joints)
assert model() is not None
node.trigger_deactivate()
node.trigger_cleanup()
executor.spin_once(timeout_sec=0.0)  # releases what it has just called
print('released' if model() is None else 'kept')
"""

# A node that cannot be configured because of query_points, and whether its model is gone then.
RELEASED_AFTER_FAILURE = """
import gc
import sys
import weakref

import rclpy

from lsc_pose_ros.ros.node import preparation
from lsc_pose_ros.ros.node.node import PoseNode

models = []

def load(name):
    model = load_model(name)
    models.append(weakref.ref(model.joints))
    return model

load_model, preparation._load = preparation._load, load
rclpy.init(args=sys.argv)
gc.disable()
node = PoseNode()
node.trigger_configure()
(model,) = models
print('released' if model() is None else 'kept')
"""

# The node while Python loads its libraries.
LOADING = """
import sys
import time

from lsc_pose_ros.ros.node import main

def load_slowly(module):
    print('loading', flush=True)
    while True:  # Python runs signal handlers between the sleeps
        time.sleep(0.1)

main.load_with_ros = load_slowly
sys.exit(main.main())
"""


@pytest.fixture(scope='module')
def frames(tmp_path_factory: pytest.TempPathFactory) -> list[Frame]:
    return generate(tmp_path_factory.mktemp('frames'), frames=4)


@pytest.fixture
def start_in_state(
    spawn_node: Callable[..., Program], services: NodeServices
) -> Callable[[str], Program]:
    """Start the node without autostart and bring it into a state."""

    def begin(state: str) -> Program:
        node = spawn_node(autostart='false')
        for transition in WAY_TO[state]:
            assert services.change(transition), node.output
        assert services.state == state
        return node

    return begin


def hears_nothing(camera: Camera) -> bool:
    publishers = (camera.depth, camera.camera_info, camera.mask)
    return not any(each.get_subscription_count() for each in publishers)


def publishes_nothing(probe: Node) -> bool:
    topics = ('/pose_node/skeletons', '/pose_node/joint_markers', '/diagnostics')
    return not any(probe.count_publishers(topic) for topic in topics)


def test_autostart_makes_the_node_active(
    start_node: Callable[..., Program], services: NodeServices, small_model_file: Path
) -> None:
    start_node()
    assert services.state == 'active'
    assert services.get('autostart') is True
    assert services.get('model') == str(small_model_file)


def test_without_autostart_the_node_waits_to_be_told(
    start_in_state: Callable[[str], Program], services: NodeServices, camera: Camera, probe: Node
) -> None:
    node = start_in_state('unconfigured')
    assert services.transitions == {'configure', 'shutdown'}
    assert services.get('joint_names') is None
    assert stays(lambda: hears_nothing(camera) and publishes_nothing(probe))
    assert services.state == 'unconfigured'
    assert 'kernels' not in node.output


def test_there_and_back_again(
    start_in_state: Callable[[str], Program],
    services: NodeServices,
    camera: Camera,
    estimates: PublishedEstimates,
    probe: Node,
    frames: list[Frame],
) -> None:
    node = start_in_state('unconfigured')
    assert services.change('configure')
    assert services.state == 'inactive'
    assert 'kernels ready' in node.output
    assert 'ready: listening' not in node.output
    assert stays(lambda: hears_nothing(camera) and publishes_nothing(probe))

    assert services.change('activate')
    assert services.state == 'active'
    assert node.prints('ready: listening to /depth/image, /depth/camera_info, /mask')
    wait_for_connections(camera, estimates)
    camera.send(frames[0])
    assert estimates.wait_for(1), node.output

    assert services.change('deactivate')
    assert services.state == 'inactive'
    assert wait_until(lambda: hears_nothing(camera) and publishes_nothing(probe))
    camera.send(frames[1])
    assert list(estimates.skeletons) == [frames[0].stamp]

    assert services.change('activate')
    wait_for_connections(camera, estimates)
    camera.send(frames[2])
    assert estimates.wait_for(2), node.output
    assert list(estimates.skeletons) == [frames[0].stamp, frames[2].stamp]

    assert services.change('deactivate')
    assert services.change('cleanup')
    assert services.state == 'unconfigured'
    assert services.get('joint_names') is None

    assert services.change('configure')
    assert services.change('activate')
    wait_for_connections(camera, estimates)
    camera.send(frames[3])
    assert estimates.wait_for(3), node.output
    assert services.change('shutdown')
    assert services.state == 'finalized'
    assert wait_until(lambda: hears_nothing(camera) and publishes_nothing(probe))
    assert 'ERROR' not in node.output
    assert 'Traceback' not in node.output


def wait_for_connections(camera: Camera, estimates: PublishedEstimates) -> None:
    camera.wait_for_node()
    estimates.wait_for_node()


def test_joint_names_are_the_model_s_while_the_node_is_configured(
    start_in_state: Callable[[str], Program], services: NodeServices, small_model_file: Path
) -> None:
    start_in_state('inactive')
    expected = ['head', 'neck', 'l_shoulder', 'l_elbow', 'l_hip', 'l_knee', 'r_shoulder', 'r_hip']
    assert len(load_model(small_model_file).joints) == len(expected)
    assert services.get('joint_names') == expected
    assert 'read-only' in services.set('joint_names', ['head'])
    (described,) = services.describe('joint_names')
    assert described.read_only
    assert described.description


@pytest.mark.parametrize('state', ['inactive', 'active'])
def test_shutdown_from_any_state(
    start_in_state: Callable[[str], Program], services: NodeServices, state: str
) -> None:
    node = start_in_state(state)
    assert services.change('shutdown')
    assert services.state == 'finalized'
    assert services.transitions == set()
    assert services.get('joint_names') is None
    assert node.exit_status(signal.SIGINT) == 0
    assert 'Traceback' not in node.output


def test_transition_that_does_not_exist_is_refused(
    start_in_state: Callable[[str], Program], services: NodeServices
) -> None:
    start_in_state('unconfigured')
    assert not services.change('deactivate')
    assert not services.change('fly')
    assert not services.change_by_number(Transition.TRANSITION_ACTIVATE)
    assert not services.change_by_number(123)
    assert services.state == 'unconfigured'
    assert services.change_by_number(Transition.TRANSITION_CONFIGURE)
    assert services.state == 'inactive'


def test_requests_that_do_not_fit_an_active_node_do_not_end_it(
    start_in_state: Callable[[str], Program], services: NodeServices
) -> None:
    node = start_in_state('active')
    for number in (1, 3, 99, 0, 255):
        assert not services.change_by_number(number)
        assert services.state == 'active'
    assert node.prints('a transition was refused')
    assert services.change('deactivate')
    assert node.exit_status(signal.SIGINT) == 0
    assert 'Traceback' not in node.output


def test_model_that_is_missing_fails_to_configure_and_can_be_mended(
    spawn_node: Callable[..., Program], services: NodeServices, small_model_file: Path
) -> None:
    node = spawn_node(autostart='false', model='/nowhere/model.npz')
    assert not services.change('configure')
    assert services.state == 'unconfigured'
    assert node.prints('/nowhere/model.npz')
    assert node.output.count('[ERROR]') == 1
    assert 'Traceback' not in node.output
    assert not services.set('model', str(small_model_file))
    assert services.change('configure')
    assert services.state == 'inactive'


def test_transition_that_breaks_down_is_told_and_can_be_tried_anew(
    start_program: Callable[..., Program], services: NodeServices, small_model_file: Path
) -> None:
    words = ('-p', f'model:={small_model_file}', '-p', 'autostart:=false')
    node = start_program('-c', BROKEN_ONCE, '--ros-args', *words)
    assert not services.change('configure')
    assert services.state == 'unconfigured'
    assert node.prints('ZeroDivisionError: once')
    assert services.change('configure')
    assert services.state == 'inactive'


@pytest.mark.parametrize(('code', 'query_points'), [(RELEASED, 0), (RELEASED_AFTER_FAILURE, 9999)])
def test_cleanup_and_failure_release_the_model(
    start_program: Callable[..., Program], small_model_file: Path, code: str, query_points: int
) -> None:
    words = ('-p', f'model:={small_model_file}', '-p', f'query_points:={query_points}')
    program = start_program('-c', code, '--ros-args', *words)
    assert program.exit_status() == 0, program.output
    assert ('cannot be used' in program.output) == (query_points != 0)
    assert 'released' in program.output


def ends_in_time(node: Program, number: signal.Signals) -> None:
    begin = time.monotonic()
    assert node.exit_status(number) == 0, node.output
    assert time.monotonic() - begin < MOST_UNTIL_ENDED
    assert 'Traceback' not in node.output
    assert 'ERROR' not in node.output


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_signal_ends_the_node_in_each_state(
    start_program: Callable[..., Program],
    probe: Node,
    small_model_file: Path,
    number: signal.Signals,
) -> None:
    words = ('-p', f'model:={small_model_file}', '-p', 'autostart:=false')
    nodes = {
        state: start_program(
            *('-m', 'lsc_pose_ros.ros.node.main', '--ros-args', *words, '-r', f'__ns:=/{state}')
        )
        for state in WAY_TO
    }
    for state, transitions in WAY_TO.items():
        services = NodeServices(probe, f'/{state}/pose_node')
        for transition in transitions:
            assert services.change(transition), nodes[state].output
        assert services.state == state
    for node in nodes.values():
        ends_in_time(node, number)


@pytest.mark.parametrize(
    ('autostart', 'number'),
    [('true', signal.SIGINT), ('true', signal.SIGTERM), ('false', signal.SIGTERM)],
)
def test_signal_ends_the_node_while_it_compiles(
    start_program: Callable[..., Program],
    services: NodeServices,
    small_model_file: Path,
    tmp_path: Path,
    autostart: str,
    number: signal.Signals,
) -> None:
    words = ('-p', f'model:={small_model_file}', '-p', f'autostart:={autostart}')
    node = start_program(
        *('-m', 'lsc_pose_ros.ros.node.main', '--ros-args', *words), NUMBA_CACHE_DIR=str(tmp_path)
    )
    if autostart == 'false':
        services.ask_to_change('configure')
    assert node.prints('compiling the kernels'), node.output
    assert wait_until(lambda: any(tmp_path.rglob('*.nbi'))), node.output
    assert 'kernels ready' not in node.output
    ends_in_time(node, number)


@pytest.mark.parametrize('autostart', ['true', 'false'])
def test_services_answer_while_the_node_compiles(
    start_program: Callable[..., Program],
    services: NodeServices,
    small_model_file: Path,
    tmp_path: Path,
    autostart: str,
) -> None:
    words = ('-p', f'model:={small_model_file}', '-p', f'autostart:={autostart}')
    node = start_program(
        *('-m', 'lsc_pose_ros.ros.node.main', '--ros-args', *words), NUMBA_CACHE_DIR=str(tmp_path)
    )
    if autostart == 'false':
        services.ask_to_change('configure')
    assert node.prints('compiling the kernels'), node.output
    assert services.state == 'configuring'
    assert services.get('model') == str(small_model_file)
    assert not services.change('configure')
    assert not services.change('activate')
    assert 'clean up the node first' in services.set('graph', value=False)
    assert not services.set('minimum_confidence', 0.5)
    assert services.state == 'configuring'
    assert 'kernels ready' not in node.output
    ends_in_time(node, signal.SIGINT)


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_signal_ends_the_node_while_its_libraries_are_loaded(
    start_program: Callable[..., Program], number: signal.Signals
) -> None:
    node = start_program('-c', LOADING)
    assert node.prints('loading')
    ends_in_time(node, number)


def test_impatient_user(start_in_state: Callable[[str], Program]) -> None:
    node = start_in_state('active')
    node.interrupt()
    node.interrupt()
    ends_in_time(node, signal.SIGINT)


def test_time_of_a_simulation(
    start_node: Callable[..., Program],
    services: NodeServices,
    camera: Camera,
    estimates: PublishedEstimates,
    probe: Node,
    frames: list[Frame],
) -> None:
    diagnostic_msgs = pytest.importorskip('diagnostic_msgs.msg')
    node = start_node(use_sim_time='true')
    assert services.get('use_sim_time') is True
    wait_for_connections(camera, estimates)
    camera.send(frames[0])
    assert estimates.wait_for(1), node.output  # although no clock ticks yet
    assert list(estimates.skeletons) == [frames[0].stamp]

    clock = probe.create_publisher(Clock, '/clock', 10)
    stamps: list[int] = []

    def keep_stamp(message: Any) -> None:
        stamps.append(message.header.stamp.sec)

    probe.create_subscription(diagnostic_msgs.DiagnosticArray, '/diagnostics', keep_stamp, 10)
    time_message = Clock()
    time_message.clock.sec = 1234

    def ticks() -> bool:
        clock.publish(time_message)
        services.spin(0.1)
        return 1234 in stamps

    assert wait_until(ticks), (stamps, node.output)
    ends_in_time(node, signal.SIGINT)
