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

"""What the node publishes, over the wire from a program of its own."""

import json
import os
from collections.abc import Callable
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from live_ros import Program
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from rosbags.typesys import Stores, get_typestore
from visualization_msgs.msg import Marker, MarkerArray
from waiting import wait_until

from lsc_pose_ros.bags.serialization.deserialize import read_skeletons
from lsc_pose_ros.ros.playback.listener import Listener, open_listener

PROGRAM = Path(__file__).parent / 'outputs_program.py'
SKELETONS = '/program/skeletons'
MARKERS = '/program/joint_markers'
DIAGNOSTICS = '/diagnostics'
TOPICS = {
    SKELETONS: 'sensor_msgs/msg/PointCloud2',
    MARKERS: 'visualization_msgs/msg/MarkerArray',
}


# Stands in for tf2_msgs, which is not on PyPI. The publisher has the type PolygonStamped; the
# messages are serialized as TFMessage, and the middleware does not look into serialized messages.
TF_STAND_IN = """
from geometry_msgs.msg import PolygonStamped, TransformStamped

from lsc_pose_ros.bags.serialization.serialize import serialize
from lsc_pose_ros.bags.serialization.type_store import message_class


class TFMessage(PolygonStamped):
    def __new__(cls, transforms):
        assert all(isinstance(each, TransformStamped) for each in transforms)
        name = 'tf2_msgs/msg/TFMessage'
        return serialize(message_class(name)(transforms=transforms), name)
"""


class Received:
    """What a listener has received of one topic."""

    def __init__(self, listener: Listener) -> None:
        self._listener = listener

    def of(self, topic: str) -> list[bytes]:
        return [each.data for each in list(self._listener.received) if each.topic == topic]

    def wait_for(self, topic: str, count: int) -> bool:
        return wait_until(lambda: len(self.of(topic)) >= count)


Run = Callable[..., AbstractContextManager[tuple[Program, Received]]]


@pytest.fixture
def begin(
    start_program: Callable[..., Program], ros_environment: dict[str, str]
) -> Callable[..., Program]:
    """Start the program with options; packages in a folder take precedence."""

    def begin_program(packages: Path | None = None, **options: Any) -> Program:
        path = os.pathsep.join(filter(None, (str(packages or ''), ros_environment['PYTHONPATH'])))
        return start_program(PROGRAM, json.dumps({'topics': [], **options}), PYTHONPATH=path)

    return begin_program


@pytest.fixture
def run(begin: Callable[..., Program]) -> Run:
    """Run the program while its topics are listened to."""

    @contextmanager
    def running(topics: dict[str, str], packages: Path | None = None, **options: Any):
        with open_listener(topics) as listener:
            program = begin(packages, topics=list(topics), **options)
            assert program.prints('open'), program.output
            yield program, Received(listener)

    return running


def missing(package: str, folder: Path) -> Path:
    """A folder in which a package cannot be imported."""
    (folder / package).mkdir()
    (folder / package / '__init__.py').write_text("raise ImportError('not here')\n")
    return folder


def test_skeletons_and_markers_until_closed(run: Run, probe: Node) -> None:
    scenes = [[1, 2], [2], [], [7]]
    with run(TOPICS, scenes=scenes, marker_lifetime=1.5, minimum_confidence=0.5, closes=True) as (
        program,
        received,
    ):
        assert received.wait_for(MARKERS, len(scenes))
        assert received.wait_for(SKELETONS, len(scenes))
        assert program.prints('closed')
        assert wait_until(
            lambda: not any(probe.count_publishers(each) for each in (*TOPICS, DIAGNOSTICS))
        )
    answers = [read_skeletons(each) for each in received.of(SKELETONS)]
    assert [each.skeletons.bodies.tolist() for each in answers] == scenes
    messages = [deserialize_message(each, MarkerArray).markers for each in received.of(MARKERS)]
    told = [{(each.id, each.action) for each in markers} for markers in messages]
    assert told == [
        {(1, Marker.ADD), (2, Marker.ADD)},
        {(1, Marker.DELETE), (2, Marker.ADD)},
        {(2, Marker.DELETE)},
        {(7, Marker.ADD)},
    ]
    for marker in messages[0]:
        assert marker.header.frame_id == 'camera_optical'
        assert (marker.lifetime.sec, marker.lifetime.nanosec) == (1, 500_000_000)
        assert len(marker.points) == (3 if marker.type == Marker.SPHERE_LIST else 2)


def test_transforms_need_tf2_msgs(begin: Callable[..., Program], tmp_path: Path) -> None:
    program = begin(missing('tf2_msgs', tmp_path), publish_tf=True, scenes=[])
    assert program.exit_status() == 2
    assert 'parameter publish_tf' in program.output
    assert 'tf2_msgs' in program.output
    assert 'Traceback' not in program.output


def test_transforms(run: Run, tmp_path: Path) -> None:
    (tmp_path / 'tf2_msgs' / 'msg').mkdir(parents=True)
    (tmp_path / 'tf2_msgs' / '__init__.py').touch()
    (tmp_path / 'tf2_msgs' / 'msg' / '__init__.py').write_text(TF_STAND_IN)
    topics = {**TOPICS, '/tf': 'geometry_msgs/msg/PolygonStamped'}
    with run(
        topics,
        tmp_path,
        publish_tf=True,
        minimum_confidence=0.5,
        scenes=[[3, 12], [], [12]],
    ) as (_, received):
        assert received.wait_for('/tf', 2)
        assert received.wait_for(SKELETONS, 3)
    store = get_typestore(Stores.ROS2_JAZZY)
    messages: list[Any] = [
        store.deserialize_cdr(each, 'tf2_msgs/msg/TFMessage') for each in received.of('/tf')
    ]
    stamps = [read_skeletons(each).stamp for each in received.of(SKELETONS)]
    assert len(messages) == 2
    for message, stamp, bodies in zip(
        messages, (stamps[0], stamps[2]), ((3, 12), (12,)), strict=True
    ):
        assert [each.child_frame_id for each in message.transforms] == [
            f'{name}_{body}' for body in bodies for name in ('body', 'neck', 'l_hip', 'r_hip')
        ]
        assert {
            each.header.stamp.sec * 10**9 + each.header.stamp.nanosec
            for each in message.transforms
        } == {stamp}
        body, neck = message.transforms[:2]
        assert body.header.frame_id == 'camera_optical'
        assert neck.header.frame_id == body.child_frame_id
        assert neck.transform.translation.z == pytest.approx(0.5)


def test_diagnostics(run: Run) -> None:
    messages = pytest.importorskip('diagnostic_msgs.msg')
    with run(
        {DIAGNOSTICS: 'diagnostic_msgs/msg/DiagnosticArray'},
        scenes=[[1, 2]] * 70,
        latency=0.02,
        failures=3,
    ) as (_, received):

        def statuses() -> list[Any]:
            arrays = [
                deserialize_message(each, messages.DiagnosticArray)
                for each in received.of(DIAGNOSTICS)
            ]
            assert all(len(array.status) == 1 for array in arrays)
            assert all(array.header.stamp.sec > 0 for array in arrays)
            return [array.status[0] for array in arrays]

        stale = messages.DiagnosticStatus.STALE
        assert wait_until(
            lambda: [each.level for each in statuses()[-1:]] == [stale] and len(statuses()) > 3
        )
    found = statuses()
    assert {each.name for each in found} == {'program: pose estimation'}
    busy = [
        each
        for each in found
        if each.level == messages.DiagnosticStatus.OK and each.message == 'estimating'
    ]
    assert busy
    values = {each.key: each.value for each in busy[-1].values}
    assert 0 < float(values['estimates out (Hz)']) <= float(values['frames in (Hz)'])
    assert values['bodies'] == '2'
    assert 20 <= float(values['latency p50 (ms)']) <= float(values['latency p95 (ms)'])
    assert 5 <= float(values['estimate p50 (ms)']) <= float(values['estimate p95 (ms)'])
    errors = [each for each in found if each.level == messages.DiagnosticStatus.ERROR]
    assert sum(int(each.message.split()[0]) for each in errors) == 3
    assert {each.key: each.value for each in found[-1].values}['depth'] == '73'


def test_without_diagnostic_msgs_the_rest_works(run: Run, tmp_path: Path) -> None:
    packages = missing('diagnostic_msgs', tmp_path)
    with run(TOPICS, packages, scenes=[[1]], closes=True) as (program, received):
        assert received.wait_for(SKELETONS, 1)
        assert program.prints('closed')
    assert program.output.count('diagnostic_msgs is not installed') == 1
    assert 'Traceback' not in program.output
