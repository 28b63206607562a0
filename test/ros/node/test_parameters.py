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

"""The node's parameters."""

import importlib.util
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from live_ros import Camera, NodeServices, Program, PublishedEstimates, generate
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter
from visualization_msgs.msg import Marker
from waiting import stays, wait_until

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.estimation.temporal import TemporalEstimator
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.ros.node.parameters import declare_parameters
from lsc_pose_ros.settings.setting import Change
from lsc_pose_ros.settings.table import SETTINGS, NodeSettings, TemporalSettings


@pytest.fixture
def declare() -> Iterator[Callable[..., NodeSettings]]:
    """Declare the parameters on a node that was started with some values."""
    context = Context()
    context.init([])
    nodes: list[Node] = []

    def begin(**values: object) -> NodeSettings:
        overrides = [Parameter(name, value=value) for name, value in values.items()]
        nodes.append(Node('declaring', context=context, parameter_overrides=overrides))
        return declare_parameters(nodes[-1])

    yield begin
    for node in nodes:
        node.destroy_node()
    context.try_shutdown()


def test_defaults(declare: Callable[..., NodeSettings]) -> None:
    parameters = declare()
    assert parameters == NodeSettings()


def test_values_given_at_the_start(declare: Callable[..., NodeSettings]) -> None:
    parameters = declare(model='a.npz', graph=False, mask_background=255, sync_slop=0.01)
    assert parameters.model == 'a.npz'
    assert parameters.graph is False
    assert parameters.mask_background == 255
    assert parameters.sync_slop == 0.01


@pytest.mark.parametrize('value', ['true', True])
def test_choice_that_ros_reads_as_a_bool_is_a_text(
    declare: Callable[..., NodeSettings], value: object
) -> None:
    assert declare(rectified=value).rectified == 'true'


def test_integer_is_accepted_for_a_double(declare: Callable[..., NodeSettings]) -> None:
    parameters = declare(smoothing_cutoff=2, sync_slop=0, mask_background=2)
    assert (parameters.smoothing_cutoff, parameters.sync_slop) == (2.0, 0.0)
    assert type(parameters.smoothing_cutoff) is float
    assert type(parameters.mask_background) is int


@pytest.mark.parametrize(
    ('name', 'value', 'rule'),
    [
        ('sync_slop', 2, 'must be of type double, from 0.0 to 1.0'),
        ('sync_slop', '0', 'must be of type double, from 0.0 to 1.0'),
        ('sync_slop', True, 'must be of type double, from 0.0 to 1.0'),
        ('sync_slop', -0.1, 'from 0.0 to 1.0'),
        ('mask_background', 65536, 'from -1 to 65535'),
        ('mask_background', 'none', 'must be of type integer'),
        ('sync_queue', 0, 'from 1 to 1000'),
        ('minimum_confidence', 1.5, 'from 0.0 to 1.0'),
        ('reliability', 'certain', 'auto or best_effort or reliable'),
        ('segmentation', 'guess', 'auto or mask or people or background or nearest'),
        ('body_ids', 'names', 'auto or mask or tracked'),
        ('query_points', -1, 'from 0 to 10000'),
        ('rectified', 5, 'auto or true or false'),
        ('smoothing', 'a little', 'must be of type bool'),
        ('depth_transport', 'theora', 'raw or compressedDepth'),
        ('model', 5, 'must be of type string'),
        ('graph', 'yes', 'must be of type bool'),
    ],
)
def test_wrong_value_names_the_parameter_and_the_rule(
    declare: Callable[..., NodeSettings], name: str, value: object, rule: str
) -> None:
    with pytest.raises(InputError, match=name) as error:
        declare(**{name: value})
    assert rule in str(error.value)


def test_every_parameter_is_described_to_the_tools(
    spawn_node: Callable[..., Program], services: NodeServices
) -> None:
    spawn_node(autostart='false')
    for name, described in zip(SETTINGS, services.describe(*SETTINGS), strict=True):
        declared = SETTINGS[name]
        assert described.name == name
        assert described.description == declared.description
        assert described.read_only == (name == 'autostart'), name
        assert declared.change.value in described.additional_constraints
        for choice in declared.choices:
            assert choice in described.additional_constraints, name
        ranges = [*described.floating_point_range, *described.integer_range]
        assert [(each.from_value, each.to_value) for each in ranges] == (
            [] if declared.lowest is None else [(declared.lowest, declared.highest)]
        ), name


BAD_AT_ANY_TIME = [
    ('sync_slop', 2.0, 'sync_slop out of range'),
    ('sync_slop', float('nan'), 'sync_slop out of range'),
    ('minimum_confidence', -0.1, 'minimum_confidence out of range'),
    ('minimum_body_confidence', 1.1, 'minimum_body_confidence out of range'),
    ('minimum_stature', -0.1, 'minimum_stature out of range'),
    ('hidden_joints', 'none', 'low_confidence or nan'),
    ('marker_lifetime', 'long', 'Wrong parameter type'),
    ('smoothing', 1, 'Wrong parameter type'),
    ('smoothing_cutoff', 0.0, 'smoothing_cutoff out of range'),
    ('smoothing_beta', -1.0, 'smoothing_beta out of range'),
    ('query_points', 9, 'parameter query_points: 9 cannot be used; it must be 0 or from 10 to'),
    ('query_points', -1, 'query_points out of range'),
    ('maximum_bodies', 0, 'maximum_bodies out of range'),
    ('autostart', False, 'read-only'),
    ('no_such_parameter', 1, 'undeclared'),
]

GOOD_AT_ANY_TIME = {
    'query_points': 50,
    'maximum_bodies': 3,
    'sync_slop': 0.02,
    'smoothing': True,
    'temporal': False,
    'smoothing_cutoff': 2.0,
    'smoothing_beta': 0.1,
    'minimum_confidence': 0.3,
    'marker_lifetime': 2.0,
    'minimum_body_confidence': 0.4,
    'minimum_stature': 0.5,
    'hidden_joints': 'nan',
}

WHILE_UNCONFIGURED = {
    'model': '/somewhere/model.npz',
    'graph': False,
    'segmentation': 'nearest',
    'range_min': 0.8,
    'range_max': 3.0,
    'background_seconds': 1.0,
    'background_margin': 0.2,
    'minimum_depth': 0.2,
    'maximum_depth': 15.0,
    'rectified': 'true',
    'camera_roll': '90',
    'gravity_frame': 'base_link',
    'mask_background': 255,
    'depth_transport': 'compressedDepth',
    'mask_transport': 'compressed',
    'reliability': 'reliable',
    'sync_queue': 5,
    'body_ids': 'tracked',
    'publish_tf': True,
    'publish_ros4hri': True,
}


def test_every_parameter_is_tried_here() -> None:
    tried = {*GOOD_AT_ANY_TIME, *WHILE_UNCONFIGURED, 'autostart'}
    assert tried == set(SETTINGS)
    changes = {name: declared.change for name, declared in SETTINGS.items()}
    assert {name for name, change in changes.items() if change == Change.ANY_TIME} == set(
        GOOD_AT_ANY_TIME
    )
    assert all(value != SETTINGS[name].default for name, value in WHILE_UNCONFIGURED.items())


def test_what_is_refused_and_what_is_taken_while_the_node_runs(
    start_node: Callable[..., Program], services: NodeServices, small_model_file: Path
) -> None:
    node = start_node()
    for name, value in GOOD_AT_ANY_TIME.items():
        assert not services.set(name, value), name
        assert services.get(name) == value
    for name, bad, reason in BAD_AT_ANY_TIME:
        assert reason in services.set(name, bad), name
        assert services.get(name) == GOOD_AT_ANY_TIME.get(name, services.get(name))
    most = load_model(small_model_file).settings.points
    assert not services.set('query_points', most)
    assert f'from 10 to {most}' in services.set('query_points', most + 1)
    assert not services.set('query_points', 0)
    assert not services.set('smoothing_beta', 1)  # what people type
    assert services.get('smoothing_beta') == 1.0
    for name, other in WHILE_UNCONFIGURED.items():
        before = services.get(name)
        refused = services.set(name, other)
        assert f'parameter {name}: it can be set only while the node is unconfigured' in refused
        assert 'clean up the node first' in refused
        assert services.get(name) == before, name
    assert 'Traceback' not in node.output


def test_what_is_refused_and_what_is_taken_while_the_node_is_unconfigured(
    spawn_node: Callable[..., Program], services: NodeServices
) -> None:
    spawn_node(autostart='false')
    for name, value in {**WHILE_UNCONFIGURED, **GOOD_AT_ANY_TIME}.items():
        assert not services.set(name, value), name
        assert services.get(name) == value
    bad = [
        ('segmentation', 'guess', 'auto or mask or people or background or nearest'),
        ('depth_transport', 'theora', 'raw or compressedDepth'),
        ('mask_transport', 'theora', 'raw or compressed'),
        ('reliability', 'certain', 'auto or best_effort or reliable'),
        ('body_ids', 'names', 'auto or mask or tracked'),
        ('mask_background', 65536, 'mask_background out of range'),
        ('model', 5, 'Wrong parameter type'),
        ('autostart', True, 'read-only'),
    ]
    for name, value, reason in bad:
        before = services.get(name)
        assert reason in services.set(name, value), name
        assert services.get(name) == before


def test_what_does_not_go_together_is_told_when_the_node_is_configured(
    spawn_node: Callable[..., Program], services: NodeServices
) -> None:
    node = spawn_node(autostart='false', segmentation='nearest', range_min='3.0', range_max='2.0')
    assert not services.change('configure')
    assert node.prints('range_min')
    assert not services.set('range_max', 4.0)
    assert not services.set('query_points', 9999)  # no model is loaded yet that could say no
    assert not services.change('configure')
    assert node.prints('parameter query_points: 9999 cannot be used')
    assert 'it must be 0, or 10 or more' in services.set('query_points', 9)
    assert not services.set('query_points', 0)
    assert services.change('configure')
    assert 'Traceback' not in node.output


@pytest.fixture(scope='module')
def frames(tmp_path_factory: pytest.TempPathFactory) -> list[Frame]:
    return generate(tmp_path_factory.mktemp('frames'), frames=12)


class Conversation:
    """Frames are sent one by one, and each is answered before the next."""

    def __init__(self, camera: Camera, estimates: PublishedEstimates) -> None:
        self._camera, self._estimates = camera, estimates
        camera.wait_for_node()
        estimates.wait_for_node()

    def ask(self, frame: Frame) -> tuple[Skeletons, list[Marker]]:
        self._estimates.clear()
        self._camera.send(frame)
        assert self._estimates.wait_for(1)
        return self._estimates.skeletons[frame.stamp], self._estimates.markers[0].markers


def assert_equal(found: Skeletons, expected: Skeletons) -> None:
    for name in Skeletons._fields:
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), name)


def test_changes_take_effect_while_the_node_runs(
    start_node: Callable[..., Program],
    services: NodeServices,
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
    small_model_file: Path,
) -> None:
    start_node()
    talk = Conversation(camera, estimates)
    model = load_model(small_model_file)
    fewer = model._replace(settings=model.settings._replace(query_points=20))

    def plain(frame: Frame, model: Model = model) -> Skeletons:
        return Estimator(model).estimate(frame.depth, frame.labels, frame.camera)

    skeletons, markers = talk.ask(frames[0])
    assert_equal(skeletons, plain(frames[0]))
    assert {each.action for each in markers} == {Marker.ADD}
    assert {each.lifetime.nanosec for each in markers} == {500_000_000}

    assert not services.set('query_points', 20)
    skeletons, _ = talk.ask(frames[1])
    assert_equal(skeletons, plain(frames[1], fewer))
    assert not np.array_equal(skeletons.positions, plain(frames[1]).positions, equal_nan=True)
    assert not services.set('query_points', 0)
    assert_equal(talk.ask(frames[2])[0], plain(frames[2]))

    assert not services.set('marker_lifetime', 3)
    assert {each.lifetime.sec for each in talk.ask(frames[3])[1]} == {3}
    assert not services.set('minimum_confidence', 1.0)
    skeletons, markers = talk.ask(frames[4])
    assert_equal(skeletons, plain(frames[4]))
    assert Marker.ADD not in {each.action for each in markers}
    assert not services.set('minimum_confidence', 0.0)

    assert not services.set('smoothing', value=True)
    assert not services.set('smoothing_cutoff', 0.1)
    assert not services.set('smoothing_beta', 0.0)
    smooth = TemporalEstimator(
        Estimator(model),
        TemporalSettings(smoothing=True, smoothing_cutoff=0.1, smoothing_beta=0.0, temporal=False),
    )
    for frame in frames[5:8]:
        expected = smooth.estimate(frame.stamp, frame.depth, frame.labels, frame.camera)
        assert_equal(talk.ask(frame)[0], expected)
    assert not np.array_equal(expected.positions, plain(frame).positions, equal_nan=True)
    assert not services.set('smoothing', value=False)
    assert_equal(talk.ask(frames[8])[0], plain(frames[8]))

    assert not services.set('temporal', value=True)
    over_time = TemporalEstimator(Estimator(model), TemporalSettings())
    for frame in frames[9:12]:
        expected = over_time.estimate(frame.stamp, frame.depth, frame.labels, frame.camera)
        assert_equal(talk.ask(frame)[0], expected)
    assert not np.array_equal(expected.positions, plain(frame).positions, equal_nan=True)


def test_sync_slop_takes_effect_while_the_node_runs(
    start_node: Callable[..., Program],
    services: NodeServices,
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
) -> None:
    start_node()
    camera.wait_for_node()
    estimates.wait_for_node()

    def send_with_late_mask(frame: Frame) -> None:
        camera.send_depth(frame)
        camera.send_mask(frame._replace(stamp=frame.stamp + 5_000_000))

    send_with_late_mask(frames[0])
    camera.wait_until_taken()
    assert stays(lambda: not estimates.skeletons)
    assert not services.set('sync_slop', 0.01)
    for frame in frames[1:4]:
        send_with_late_mask(frame)
        assert wait_until(lambda stamp=frame.stamp: stamp in estimates.skeletons)


def test_parameters_of_an_unconfigured_node_take_effect_when_it_is_configured(
    spawn_node: Callable[..., Program],
    services: NodeServices,
    camera: Camera,
    estimates: PublishedEstimates,
    frames: list[Frame],
    small_model_file: Path,
) -> None:
    spawn_node(autostart='false', model='/nowhere/model.npz')
    assert not services.set('model', str(small_model_file))
    assert not services.set('graph', value=False)
    assert services.change('configure')
    assert services.change('activate')
    talk = Conversation(camera, estimates)
    alone = Estimator(load_model(small_model_file), graph=False)
    expected = alone.estimate(frames[0].depth, frames[0].labels, frames[0].camera)
    assert_equal(talk.ask(frames[0])[0], expected)


def test_all_values_of_a_configured_node_can_be_set_again(
    start_node: Callable[..., Program], services: NodeServices
) -> None:
    start_node(smoothing_cutoff=2, body_ids='tracked', rectified='true')
    names = services.parameter_names
    assert names > {*SETTINGS, 'joint_names', 'use_sim_time'}
    # So does `ros2 param load` with what `ros2 param dump` wrote.
    for name in names:
        assert not services.set(name, services.get(name)), name
    assert not services.set('range_min', services.get('range_min'))
    assert 'clean up the node first' in services.set('body_ids', 'mask')
    assert 'read-only' in services.set('autostart', value=False)
    # A bool is not the integer that equals it.
    assert 'Wrong parameter type' in services.set('smoothing', 0)


def test_parameters_that_the_node_does_not_have_are_named(
    spawn_node: Callable[..., Program], services: NodeServices
) -> None:
    node = spawn_node(autostart='false', smoothing_cutof='2.0', exposure='5', joint_names='[head]')
    assert services.state == 'unconfigured'
    found = [line.partition(']: ')[2] for line in node.output.splitlines() if 'WARN' in line]
    assert found == [
        'parameter exposure is not known and is ignored',
        'parameter smoothing_cutof is not known and is ignored; did you mean smoothing_cutoff?',
    ]


@pytest.mark.parametrize(
    ('words', 'complaint'),
    [
        (['-p', 'model:=/nowhere/m.npz'], '/nowhere/m.npz'),
        (['-p', 'sync_slop:=2.0'], 'parameter sync_slop'),
        (['-p', 'model'], 'arguments after --ros-args'),
    ],
)
def test_node_ends_with_2_and_one_line(
    start_program: Callable[..., Program], words: list[str], complaint: str
) -> None:
    node = start_program('-m', 'lsc_pose_ros.ros.node.main', '--ros-args', *words)
    assert node.exit_status() == 2
    ours = [line for line in node.output.splitlines() if line.startswith('pose_node: error:')]
    assert len(ours) == 1
    assert complaint in ours[0]
    assert 'Traceback' not in node.output


def test_node_that_gets_another_file_as_model(
    start_program: Callable[..., Program], tmp_path: Path
) -> None:
    path = tmp_path / 'not_a_model.npz'
    path.write_bytes(b'something else')
    node = start_program('-m', 'lsc_pose_ros.ros.node.main', '--ros-args', '-p', f'model:={path}')
    assert node.exit_status() == 2
    assert str(path) in node.output
    assert 'Traceback' not in node.output


@pytest.mark.skipif(
    importlib.util.find_spec('tf2_msgs') is not None, reason='tf2_msgs is installed'
)
def test_transforms_without_their_package(spawn_node: Callable[..., Program]) -> None:
    node = spawn_node(publish_tf='true')
    assert node.exit_status() == 2
    assert (
        'pose_node: error: parameter publish_tf: the package tf2_msgs is not installed'
        in node.output
    )
    assert 'Traceback' not in node.output


@pytest.mark.skipif(
    importlib.util.find_spec('hri_msgs') is not None, reason='hri_msgs is installed'
)
def test_ros4hri_without_its_package(spawn_node: Callable[..., Program]) -> None:
    node = spawn_node(publish_ros4hri='true')
    assert node.exit_status() == 2
    assert (
        'pose_node: error: parameter publish_ros4hri: the package hri_msgs is not installed'
        in node.output
    )
    assert 'Traceback' not in node.output


def test_without_ros_the_node_says_how_to_get_it(start_program: Callable[..., Program]) -> None:
    code = (
        'import sys; sys.modules["rclpy"] = None\n'
        'from lsc_pose_ros.ros.node.main import main; sys.exit(main([]))'
    )
    node = start_program('-c', code)
    assert node.exit_status() == 2
    assert "pip install '.[ros]' in a clone" in node.output
    assert 'Traceback' not in node.output
