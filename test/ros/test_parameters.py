"""The node's parameters."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import yaml

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from live_ros import Program
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources import resource
from lsc_pose_ros.ros.parameters import DECLARATIONS, Parameters, declare_parameters


@pytest.fixture
def declare() -> Iterator[Callable[..., Parameters]]:
    """Declare the parameters on a node that was started with some values."""
    context = Context()
    context.init([])
    nodes: list[Node] = []

    def begin(**values: object) -> Parameters:
        overrides = [Parameter(name, value=value) for name, value in values.items()]
        nodes.append(Node('declaring', context=context, parameter_overrides=overrides))
        return declare_parameters(nodes[-1])

    yield begin
    for node in nodes:
        node.destroy_node()
    context.try_shutdown()


def test_the_file_explains_every_parameter_with_its_default() -> None:
    path = resource('config', 'pose_node.yaml')
    values = yaml.safe_load(path.read_text())['/**']['ros__parameters']
    assert values == {name: declared.default for name, declared in DECLARATIONS.items()}
    text = path.read_text()
    for name, declared in DECLARATIONS.items():
        comment = text.partition(f'\n    {name}:')[0].rpartition('\n\n')[2]
        assert comment.count('#') > 0, name
        for choice in declared.choices:
            assert choice in comment, name
        if declared.highest is not None:
            assert str(declared.lowest) in comment, name
            assert str(declared.highest) in comment, name


def test_values_are_named_and_typed_as_declared() -> None:
    kinds = Parameters.__annotations__
    assert {name: type(declared.default) for name, declared in DECLARATIONS.items()} == kinds


def test_defaults(declare: Callable[..., Parameters]) -> None:
    parameters = declare()
    assert parameters._asdict() == {name: each.default for name, each in DECLARATIONS.items()}


def test_values_given_at_the_start(declare: Callable[..., Parameters]) -> None:
    parameters = declare(model='a.npz', graph=False, mask_background=255, sync_slop=0.01)
    assert parameters.model == 'a.npz'
    assert parameters.graph is False
    assert parameters.mask_background == 255
    assert parameters.sync_slop == 0.01


@pytest.mark.parametrize(
    ('name', 'value', 'rule'),
    [
        ('sync_slop', 0, 'written with a decimal point'),
        ('sync_slop', -0.1, 'from 0.0 to 1.0'),
        ('mask_background', 65536, 'from 0 to 65535'),
        ('mask_background', 'none', 'must be of type integer'),
        ('sync_queue', 0, 'from 1 to 1000'),
        ('minimum_confidence', 1.5, 'from 0.0 to 1.0'),
        ('reliability', 'certain', 'best_effort or reliable'),
        ('depth_transport', 'theora', 'raw or compressedDepth'),
        ('model', 5, 'must be of type string'),
        ('graph', 'yes', 'must be of type bool'),
    ],
)
def test_wrong_value_names_the_parameter_and_the_rule(
    declare: Callable[..., Parameters], name: str, value: object, rule: str
) -> None:
    with pytest.raises(InputError, match=name) as error:
        declare(**{name: value})
    assert rule in str(error.value)


def test_parameters_cannot_be_set_while_the_node_runs() -> None:
    context = Context()
    context.init([])
    node = Node('declaring', context=context)
    declare_parameters(node)
    results = node.set_parameters([Parameter('sync_slop', value=0.5)])
    assert not results[0].successful
    node.destroy_node()
    context.try_shutdown()


@pytest.mark.parametrize(
    ('words', 'complaint'),
    [
        (['-p', 'model:=/nowhere/m.npz'], '/nowhere/m.npz'),
        (['-p', 'sync_slop:=2.0'], 'parameter sync_slop'),
        (['-p', 'model'], 'arguments after --ros-args'),
    ],
)
def test_node_ends_with_2_and_one_line(
    start: Callable[..., Program], words: list[str], complaint: str
) -> None:
    node = start('-m', 'lsc_pose_ros.ros.main', '--ros-args', *words)
    assert node.ends() == 2
    ours = [line for line in node.output.splitlines() if line.startswith('pose_node: error:')]
    assert len(ours) == 1
    assert complaint in ours[0]
    assert 'Traceback' not in node.output


def test_node_that_gets_another_file_as_model(
    start: Callable[..., Program], tmp_path: Path
) -> None:
    path = tmp_path / 'not_a_model.npz'
    path.write_bytes(b'something else')
    node = start('-m', 'lsc_pose_ros.ros.main', '--ros-args', '-p', f'model:={path}')
    assert node.ends() == 2
    assert str(path) in node.output
    assert 'Traceback' not in node.output


def test_without_ros_the_node_says_how_to_get_it(start: Callable[..., Program]) -> None:
    code = (
        'import sys; sys.modules["rclpy"] = None\n'
        'from lsc_pose_ros.ros.main import main; sys.exit(main([]))'
    )
    node = start('-c', code)
    assert node.ends() == 2
    assert 'pip install lsc_pose_ros[ros]' in node.output
    assert 'Traceback' not in node.output
